"""Where the search for a solid begins: for a given orientation, centre and sizes follow from the outlines directly."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache

import cv2
import numpy as np

from stereo_pick.core.arrays import Floats, Ints, frozen
from stereo_pick.core.shapes.kinds import BOX, HEX_PRISM, Kind, dot
from stereo_pick.core.shapes.refinement import firmly_on
from stereo_pick.core.shapes.sight import Sight
from stereo_pick.core.shapes.solids import Solids
from stereo_pick.core.shapes.table import Table

_DIRECTIONS = 24
_BOX_STEPS = (-0.4, -0.24, -0.08, 0.08, 0.24, 0.4)
_LYING = 12
_HEX_TURNS = 3  # about its axis
_YAWS: dict[Kind, tuple[float, int]] = {BOX: (np.pi / 2, 8), HEX_PRISM: (np.pi / 3, 5)}  # period, steps
_ON_ITS_SIDE = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])  # third axis along x, second up
_LEAST_SIZE = 0.1  # of the object's radius
_LOOSE = 0.03  # weight of the guess that all half sizes are alike, against the outlines


def starts(sight: Sight, kind: Kind, keep: int) -> tuple[Ints, Solids]:
    """The `keep` most promising solids of each object: their objects (S,), ascending, and they.

    The residuals along the outlines' own normals are linear in centre and half sizes, so each orientation of a grid
    costs one small linear system and no iteration. On a table, solids stand or lie.
    """
    rotations, turns = orientations(kind, sight.table)
    solids, misfit = _solved(sight, kind, rotations)
    best = np.argsort(misfit, axis=1)[:, :keep]
    chosen = (best + len(rotations) * np.arange(len(best))[:, None]).ravel()
    likely = replace(solids.only(chosen), turns=turns[best.ravel()])
    objects = np.repeat(np.arange(len(best)), best.shape[1])
    return objects, sight.table.put_down(likely) if sight.table else likely


def _solved(sight: Sight, kind: Kind, rotations: Floats) -> tuple[Solids, Floats]:
    """Solids that cannot turn with the centres and half sizes that fit best, one of each of G orientations for every
    one of O objects, and their mean misfits (O, G) [px]."""
    count, grid = len(sight.points), len(rotations)
    first = Solids(
        kind,
        np.repeat(sight.centre_m, grid, axis=0),
        np.tile(rotations, (count, 1, 1)),
        np.repeat(np.repeat(sight.radius_m, grid)[:, None], kind.sizes, axis=1),
        np.empty((count * grid, 3, 0)),
    )
    linear, residual = _linear(sight, kind, rotations)
    weight = sight.weight.reshape(count, 1, -1)
    weighted = (linear * weight[..., None]).transpose(0, 1, 3, 2)
    normal, pull = (
        (weighted @ each).reshape(count * grid, linear.shape[3], -1) for each in (linear, residual[..., None])
    )
    diagonal = np.einsum("sii->si", normal)  # a view
    diagonal += diagonal * np.repeat([0.0, _LOOSE**2], [3, kind.sizes]) + 1e-9
    if sight.table:
        stiff, pulled = firmly_on(sight.table, first, sight.focal_px)
        normal, pull = normal + stiff, pull + pulled
    step = -np.linalg.solve(normal, pull)[..., 0]
    least_m = _LEAST_SIZE * np.repeat(sight.radius_m, grid)
    half_m = np.maximum(first.half_m + step[:, 3:], least_m[:, None])
    step[:, 3:] = half_m - first.half_m
    left = residual + (linear @ step.reshape(count, grid, -1, 1))[..., 0]
    solids = replace(first, centre_m=first.centre_m + step[:, :3], half_m=half_m)
    return solids, (weight * np.abs(left)).sum(axis=2) / weight.sum(axis=2)


def _linear(sight: Sight, kind: Kind, rotations: Floats) -> tuple[Floats, Floats]:
    """What `residuals` has for the outlines' own normals, but turns: how far (O, G, 2N, 3 + sizes) [px/m] a centre and
    half sizes move the silhouette, and how far (O, G, 2N) [px] it lies off where they are as large as they look."""
    planes, radius_m = sight.planes, sight.radius_m[:, None, None]
    scale = (sight.focal_px / sight.centre_m[:, 2])[:, None, None]
    own = planes[:, None] @ rotations
    half_m = np.repeat(np.repeat(sight.radius_m, len(rotations))[:, None], kind.sizes, axis=1)
    touched = kind.touch(own.reshape(len(half_m), -1, 3), half_m).reshape(own.shape)
    linear = np.empty((*own.shape[:3], 3 + kind.sizes))
    linear[..., :3] = planes[:, None]
    linear[..., 3:] = (touched * own) @ (kind.shares / radius_m)[:, None]
    linear *= scale[..., None]
    to_centre = sight.centre_m[:, None, None] - sight.eyes_m[:, None]
    past_centre = dot(planes.reshape(len(planes), 2, -1, 3), to_centre).reshape(len(planes), 1, -1)
    return linear, scale * (past_centre + dot(touched, own))


def orientations(kind: Kind, table: Table | None, finer: int = 1) -> tuple[Floats, Floats]:
    """Orientations (G, 3, 3) to begin at, and the axes (G, 3, Q) about which each may be turned from there.

    About the normal of the table, where there is one; a solid that looks the same from all sides need not be turned.
    finer: so many times as many on a table.
    """
    if table is None or not kind.turns:
        rotations = _free_orientations(kind)
        return rotations, np.broadcast_to(np.eye(3)[:, list(kind.turns)], (len(rotations), 3, len(kind.turns)))
    upright = _frame(table.normal)
    period, steps = _YAWS.get(kind, (0.0, 1))
    standing = turned(period, steps * finer if period else 1)
    lying = np.empty((0, 3, 3)) if kind is BOX else turned(np.pi, _LYING * finer) @ _ON_ITS_SIDE
    rotations = upright @ np.concatenate([standing, lying])
    return rotations, (rotations.transpose(0, 2, 1) @ upright[:, 2])[..., None]


@lru_cache(maxsize=8)
def _free_orientations(kind: Kind) -> Floats:
    """A grid (G, 3, 3) over all that differ: a box turned by 90 degrees is a box again, a cylinder by 180 degrees, a
    hexagonal prism by 60 degrees about its axis."""
    if kind.sizes == 1:
        return _read_only(np.eye(3)[None])
    if kind is not BOX:
        steps = np.arange(_DIRECTIONS) + 0.5
        z, turn = 1 - steps / _DIRECTIONS, np.pi * (1 + 5**0.5) * steps  # Fibonacci's spiral
        across = np.sqrt(1 - z * z)
        frames = np.stack([_frame(np.array(a)) for a in zip(across * np.cos(turn), across * np.sin(turn), z)])
        turns = turned(np.pi / 3, _HEX_TURNS if kind is HEX_PRISM else 1)
        return _read_only((frames[:, None] @ turns).reshape(-1, 3, 3))
    vectors = np.stack(np.meshgrid(_BOX_STEPS, _BOX_STEPS, _BOX_STEPS), axis=-1).reshape(-1, 3)
    angle = np.linalg.norm(vectors, axis=1, keepdims=True)  # tan of half the angle of the turn
    return _read_only(np.stack([cv2.Rodrigues(v)[0] for v in vectors / angle * 2 * np.arctan(angle)]))


def _frame(axis: Floats) -> Floats:
    """A rotation (3, 3) whose third column is this axis."""
    z = axis / np.linalg.norm(axis)
    x = np.cross(np.eye(3)[np.abs(z).argmin()], z)
    x /= np.linalg.norm(x)
    return np.stack([x, np.cross(z, x), z], axis=1)


def turned(period: float, count: int) -> Floats:
    """Turns (count, 3, 3) about the third axis, evenly spread over a period [rad]."""
    angle = np.arange(count) * (period / count)
    c, s, none, one = np.cos(angle), np.sin(angle), np.zeros(count), np.ones(count)
    return np.array([[c, -s, none], [s, c, none], [none, none, one]]).transpose(2, 0, 1)


def _read_only(rotations: Floats) -> Floats:
    frozen(rotations)
    return rotations
