"""The parts: convex solids and a tube, where rays meet them, and what is exactly true of each."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from rendering.intervals import ball, slabs, turned
from stereo_pick.core.arrays import Bools, Floats

_RIM = 64  # points on a round edge
_UP = np.array([0.0, 0.0, 1.0])


class Hit(NamedTuple):
    """How far (N,) along its ray each ray meets a part, inf where it does not; normal (N, 3); is it an inner wall?"""

    at: Floats
    normal: Floats
    inside: Bools


@dataclass(frozen=True)
class Solid(ABC):
    """A part that stands on the table at (x, y) [m] of the table's frame, whose z axis points up.

    size_m: along the part's own axes; lying: its own z axis lies along the yaw direction and its x axis points up;
    texture, gloss: 0 for none, 1 for much; base_m: height of what it stands on; tilt_rad: it is turned so far about its
    own y axis, which is level, around its centre.
    """

    x_m: float
    y_m: float
    size_m: tuple[float, float, float]
    yaw_rad: float = 0.0
    albedo: float = 0.85
    texture: float = 0.0
    gloss: float = 0.0
    lying: bool = False
    base_m: float = 0.0
    tilt_rad: float = 0.0

    @property
    def height_m(self) -> float:
        return self.size_m[0] if self.lying else self.size_m[2]

    @property
    def extent_m(self) -> tuple[float, float, float]:
        """Along the yaw direction, across it, and up."""
        x, y, z = self.size_m
        return (z, y, x) if self.lying else (x, y, z)

    @property
    def centre_m(self) -> Floats:
        """The centre of its volume."""
        return np.array([self.x_m, self.y_m, self.base_m + self.height_m / 2])

    @property
    def top_m(self) -> Floats:
        """The centre of its top face, or the highest point of a round one."""
        return self.centre_m + _UP * self.height_m / 2

    @property
    def axes(self) -> Floats:
        """The part's own axes, as columns, in the table's frame."""
        c, s = np.cos(self.yaw_rad), np.sin(self.yaw_rad)
        level = np.array([[0, s, c], [0, -c, s], [1, 0, 0]] if self.lying else [[c, -s, 0], [s, c, 0], [0, 0, 1]])
        if not self.tilt_rad:
            return level
        c, s = np.cos(self.tilt_rad), np.sin(self.tilt_rad)
        return np.asarray(level @ np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]]))

    @property
    def yaw_period_rad(self) -> float:
        """By how much it must turn about the table's normal to look as before; 0 where any turn will do."""
        return np.pi

    @property
    def radius_m(self) -> float:
        """Of a ball around its centre that holds it."""
        return float(np.linalg.norm(self.size_m)) / 2

    def hit(self, origin: Floats, rays: Floats) -> Hit:
        """Where N rays (N, 3) from one point (3,) or from N points (N, 3) of the table's frame meet the part."""
        start, ahead = turned(np.atleast_2d(origin - self.centre_m), self.axes), turned(rays, self.axes)
        at, normal, inside = self._first(start, ahead)
        return Hit(at, turned(normal, self.axes.T), inside)

    def blocks(self, points: Floats, rays: Floats) -> Bools:
        """Whether something of the part lies between each point (N, 3) and that point plus its ray (N, 3)."""
        start, ahead = turned(points - self.centre_m, self.axes), turned(rays, self.axes)
        near, far, _ = self._interval(start, ahead)
        return (near < far) & (far > 0) & (near < 1)

    def corners_m(self) -> Floats:
        """The eight corners of the box around it."""
        unit = np.stack(np.meshgrid(*[(-0.5, 0.5)] * 3), axis=-1).reshape(-1, 3)
        return self._placed(unit * self.size_m)

    def hull_m(self) -> Floats:
        """Points (N, 3) of its surface whose convex hull is its own."""
        return self.corners_m()

    def _placed(self, points: Floats) -> Floats:
        return points @ self.axes.T + self.centre_m

    def _first(self, start: Floats, ahead: Floats) -> tuple[Floats, Floats, Bools]:
        near, far, normal = self._interval(start, ahead)
        return np.where((near < far) & (near > 0), near, np.inf), normal, np.zeros(len(near), bool)

    @abstractmethod
    def _interval(self, start: Floats, ahead: Floats) -> tuple[Floats, Floats, Floats]: ...


class Box(Solid):
    @property
    def yaw_period_rad(self) -> float:
        length, width, _ = self.extent_m
        return np.pi / 2 if length == width else np.pi

    def _interval(self, start: Floats, ahead: Floats) -> tuple[Floats, Floats, Floats]:
        near, far = slabs(start, ahead, np.array(self.size_m) / 2)
        axis = near.argmax(axis=1)
        normal = -np.sign(ahead) * (np.arange(3) == axis[:, None])
        return near.max(axis=1), far.min(axis=1), normal


class Cylinder(Solid):
    """Its own z is its axis; the first two sizes are its diameter."""

    @property
    def yaw_period_rad(self) -> float:
        return np.pi if self.lying else 0.0

    def hull_m(self) -> Floats:
        angle = np.linspace(0, 2 * np.pi, _RIM, endpoint=False)
        rim = np.stack([np.cos(angle), np.sin(angle), np.ones(_RIM)], axis=1) / 2
        return self._placed(np.concatenate([rim, rim * (1, 1, -1)]) * self.size_m)

    def _interval(self, start: Floats, ahead: Floats) -> tuple[Floats, Floats, Floats]:
        near, far = slabs(start[:, 2:], ahead[:, 2:], np.array(self.size_m[2:]) / 2)
        side_near, side_far = ball(start[:, :2], ahead[:, :2], self.size_m[0] / 2)
        side = (start + ahead * np.where(np.isfinite(side_near), side_near, 0)[:, None]) * (1, 1, 0)
        side /= self.size_m[0] / 2
        end = -np.sign(ahead) * (0.0, 0.0, 1.0)
        normal = np.where((side_near > near[:, 0])[:, None], side, end)
        return np.maximum(near[:, 0], side_near), np.minimum(far[:, 0], side_far), normal


@dataclass(frozen=True)
class Tube(Cylinder):
    """A cylinder with a bore of `bore` times its diameter. It throws the shadow of a full one."""

    bore: float = 0.8

    def _first(self, start: Floats, ahead: Floats) -> tuple[Floats, Floats, Bools]:
        near, far, normal = self._interval(start, ahead)
        radius = self.bore * self.size_m[0] / 2
        bore_near, bore_far = ball(start[:, :2], ahead[:, :2], radius)
        through_end = (near < far) & (near > 0) & (near >= bore_near) & (near < bore_far)
        at_wall = np.where(np.isfinite(bore_far), bore_far, 0)
        wall = -(start + ahead * at_wall[:, None]) * (1, 1, 0) / radius
        at = np.where(through_end, np.where(bore_far < far, at_wall, np.inf), near)
        at = np.where((near < far) & (near > 0), at, np.inf)
        return at, np.where(through_end[:, None], wall, normal), through_end & np.isfinite(at)

    def openness(self, points: Floats) -> Floats:
        """How much of the room (N,) points of the inner wall see through both ends, as if each stood on the axis."""
        along = turned(points - self.centre_m, self.axes)[:, 2]
        radius = self.bore * self.size_m[0] / 2
        ends = np.abs(self.size_m[2] / 2 + np.outer((-1, 1), along))
        return np.asarray((1 - ends / np.hypot(ends, radius)).sum(axis=0) / 2)

    def light_enters(self, points: Floats, rays: Floats) -> Bools:
        """Whether rays (N, 3) from points (N, 3) of the inner wall leave through an end."""
        start, ahead = turned(points - self.centre_m, self.axes), turned(rays, self.axes)
        _, wall = ball(start[:, :2], ahead[:, :2], self.bore * self.size_m[0] / 2)
        _, end = slabs(start[:, 2:], ahead[:, 2:], np.array(self.size_m[2:]) / 2)
        return np.asarray(end[:, 0] < wall)


class HexPrism(Solid):
    """Its own z is its axis; the first size is across its flats, the second should be that times 2/√3."""

    @property
    def yaw_period_rad(self) -> float:
        return np.pi if self.lying else np.pi / 3

    def hull_m(self) -> Floats:
        angle = np.pi / 6 + np.arange(6) * np.pi / 3
        rim = np.stack([np.cos(angle), np.sin(angle)], axis=1) * self.size_m[0] / np.sqrt(3)
        return self._placed(np.concatenate([np.c_[rim, np.full(6, end * self.size_m[2] / 2)] for end in (-1, 1)]))

    def _interval(self, start: Floats, ahead: Floats) -> tuple[Floats, Floats, Floats]:
        angle = np.arange(3) * np.pi / 3
        normals = np.concatenate([np.stack([np.cos(angle), np.sin(angle), np.zeros(3)], axis=1), _UP[None]])
        half = np.array([self.size_m[0]] * 3 + [self.size_m[2]]) / 2
        climb = turned(ahead, normals.T)
        near, far = slabs(turned(start, normals.T), climb, half)
        axis = near.argmax(axis=1)
        facing = -np.sign(np.take_along_axis(climb, axis[:, None], axis=1)) * normals[axis]
        return near.max(axis=1), far.min(axis=1), facing


class Sphere(Solid):
    """All three sizes are its diameter."""

    @property
    def yaw_period_rad(self) -> float:
        return 0.0

    @property
    def radius_m(self) -> float:
        return self.size_m[0] / 2

    def hull_m(self) -> Floats:
        rising = np.linspace(-np.pi / 2, np.pi / 2, _RIM // 2 + 1)
        turn, climb = np.meshgrid(np.linspace(0, 2 * np.pi, _RIM, endpoint=False), rising)
        level = np.cos(climb)
        points = np.stack([level * np.cos(turn), level * np.sin(turn), np.sin(climb)], axis=-1).reshape(-1, 3)
        return self._placed(points * self.size_m[0] / 2)

    def _interval(self, start: Floats, ahead: Floats) -> tuple[Floats, Floats, Floats]:
        near, far = ball(start, ahead, self.size_m[0] / 2)
        at = np.where(np.isfinite(near), near, 0)[:, None]
        return near, far, (start + ahead * at) / (self.size_m[0] / 2)


def hex_prism_size(across_flats_m: float, height_m: float) -> tuple[float, float, float]:
    """The `size_m` of a regular one."""
    return across_flats_m, across_flats_m * 2 / np.sqrt(3), height_m


def balls(*places: tuple[float, float, float], albedo: float = 0.85, texture: float = 0.0) -> tuple[Solid, ...]:
    """Spheres from x, y and diameter [m]."""
    return tuple(Sphere(x, y, (size, size, size), albedo=albedo, texture=texture) for x, y, size in places)
