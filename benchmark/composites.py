"""Parts of shapes that the package does not know, each made of solids that it does: what is true of the whole."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from parts import Random, hex_prism_size, yaw
from rendering import Box, Cylinder, HexPrism, Solid, Sphere

from stereo_pick.core.arrays import Floats


@dataclass(frozen=True)
class Composite:
    """pieces: solids about the origin of the table's frame; volumes: how much of each is within no other, in one unit,
    and centres_m: where that is (N, 3)."""

    pieces: tuple[Solid, ...]
    volumes: tuple[float, ...]
    centres_m: Floats

    @property
    def centre_m(self) -> Floats:
        """The centre of its volume (3,), about the origin."""
        return np.average(self.centres_m, axis=0, weights=self.volumes)

    @property
    def bound(self) -> Cylinder:
        """What holds all of it."""
        hulls = np.concatenate([piece.hull_m() for piece in self.pieces])
        radius, height = float(np.linalg.norm(hulls[:, :2], axis=1).max()), float(hulls[:, 2].max())
        return Cylinder(0, 0, (2 * radius, 2 * radius, height))

    def placed(self, x_m: float, y_m: float) -> tuple[Solid, ...]:
        """Its pieces, so far from the origin."""
        return tuple(replace(piece, x_m=piece.x_m + x_m, y_m=piece.y_m + y_m) for piece in self.pieces)


def bottle(random: Random, albedo: float) -> Composite:
    """A body and a neck."""
    body, neck = float(random.uniform(0.036, 0.046)), float(random.uniform(0.35, 0.55))
    return _stacked(
        Cylinder(0, 0, (body, body, float(random.uniform(0.03, 0.05))), albedo=albedo),
        Cylinder(0, 0, (body * neck, body * neck, float(random.uniform(0.012, 0.025))), albedo=albedo),
    )


def step(random: Random, albedo: float) -> Composite:
    """A turned part of two diameters."""
    thick = float(random.uniform(0.04, 0.05))
    thin = thick * float(random.uniform(0.45, 0.75))
    return _stacked(
        Cylinder(0, 0, (thick, thick, float(random.uniform(0.012, 0.03))), albedo=albedo),
        Cylinder(0, 0, (thin, thin, float(random.uniform(0.012, 0.03))), albedo=albedo),
    )


def bolt(random: Random, albedo: float) -> Composite:
    """On its head."""
    head = hex_prism_size(random.uniform(0.034, 0.044), random.uniform(0.012, 0.018))
    shank = head[1] * float(random.uniform(0.45, 0.6))
    return _stacked(
        HexPrism(0, 0, head, yaw(random), albedo),
        Cylinder(0, 0, (shank, shank, float(random.uniform(0.025, 0.04))), albedo=albedo),
    )


def capsule(random: Random, albedo: float) -> Composite:
    """A cylinder with a half ball on top."""
    thick, height = float(random.uniform(0.036, 0.046)), float(random.uniform(0.02, 0.035))
    body = Cylinder(0, 0, (thick, thick, height), albedo=albedo)
    dome = Sphere(0, 0, (thick,) * 3, albedo=albedo, base_m=height - thick / 2)
    centre = np.array([0.0, 0.0, height + 3 / 16 * thick])
    return Composite((body, dome), (height / 4, thick / 12), np.array([body.centre_m, centre]))


def bracket(random: Random, albedo: float) -> Composite:
    """An angle: a foot and a wall."""
    long, wide, high = (float(random.uniform(*each)) for each in ((0.035, 0.055), (0.03, 0.045), (0.035, 0.055)))
    thick = float(random.uniform(0.006, 0.015))
    return _beside(
        random, albedo, ((0, 0), (long, wide, thick)), ((-(long + thick) / 2, 0), (thick, wide, high))
    )  # fmt: skip


def tee(random: Random, albedo: float) -> Composite:
    """A T, lying."""
    bar, stem, high = (float(random.uniform(*each)) for each in ((0.045, 0.065), (0.025, 0.045), (0.02, 0.035)))
    thick = float(random.uniform(0.014, 0.02))
    return _beside(
        random, albedo, ((0, 0), (thick, bar, high)), (((thick + stem) / 2, 0), (stem, thick, high))
    )  # fmt: skip


def ell(random: Random, albedo: float) -> Composite:
    """An L, lying."""
    bar, stem, high = (float(random.uniform(*each)) for each in ((0.045, 0.065), (0.025, 0.045), (0.02, 0.035)))
    thick = float(random.uniform(0.014, 0.02))
    aside = (bar - thick) / 2
    return _beside(
        random, albedo, ((0, 0), (thick, bar, high)), (((thick + stem) / 2, aside), (stem, thick, high))
    )  # fmt: skip


COMPOSITES: dict[str, Callable[[Random, float], Composite]] = {
    each.__name__: each for each in (bottle, step, bolt, capsule, bracket, tee, ell)
}


def _stacked(lower: Solid, upper: Solid) -> Composite:
    return _whole(lower, replace(upper, base_m=lower.height_m))


def _beside(random: Random, albedo: float, *boxes: tuple[tuple[float, float], tuple[float, float, float]]) -> Composite:
    """Boxes, each with its place and its size, all turned alike about their middle."""
    turn = yaw(random)
    across = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    middle = np.mean([place for place, _ in boxes], axis=0)
    places = [across @ (np.array(place) - middle) for place, _ in boxes]
    return _whole(*(Box(float(x), float(y), size, turn, albedo) for (x, y), (_, size) in zip(places, boxes)))


def _whole(*pieces: Solid) -> Composite:
    return Composite(pieces, tuple(_volume(each) for each in pieces), np.array([each.centre_m for each in pieces]))


def _volume(solid: Solid) -> float:
    x, y, z = solid.size_m
    if isinstance(solid, Cylinder):
        return np.pi / 4 * x * y * z
    if isinstance(solid, HexPrism):
        return float(np.sqrt(3) / 2 * min(x, y) ** 2 * z)
    return x * y * z
