"""Parts of shapes that the package does not know: convex, and most of them with more of their volume at one end."""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import dataclass

import numpy as np

from rendering.intervals import ball, dot, slabs, turned
from rendering.solids import Solid
from stereo_pick.core.arrays import Floats

_RIM = 64  # points on a round edge


@dataclass(frozen=True)
class OddSolid(Solid):
    """A solid the centre of whose volume need not be the middle of the box around it. It is given about that centre."""

    @property
    @abstractmethod
    def _middle_m(self) -> Floats:
        """The middle of the box around it (3,), from the centre of its volume, along its own axes."""

    @property
    def centre_m(self) -> Floats:
        return np.asarray(super().centre_m - self.axes @ self._middle_m)

    @property
    def top_m(self) -> Floats:
        return np.asarray(super().centre_m + (0.0, 0.0, self.height_m / 2))

    @property
    def radius_m(self) -> float:
        return super().radius_m + float(np.linalg.norm(self._middle_m))

    def corners_m(self) -> Floats:
        return super().corners_m() + self.axes @ self._middle_m


@dataclass(frozen=True)
class Cone(OddSolid):
    """A cone without its tip, or a cup: the first two sizes are its largest diameter; below, above: its diameters, as
    parts of that, not alike."""

    below: float = 1.0
    above: float = 0.7

    @property
    def yaw_period_rad(self) -> float:
        return np.pi if self.lying else 0.0

    @property
    def _middle_m(self) -> Floats:
        below, above = self.below, self.above
        share = (below**2 + 2 * below * above + 3 * above**2) / (4 * (below**2 + below * above + above**2))
        return np.array([0.0, 0.0, (0.5 - share) * self.size_m[2]])

    def hull_m(self) -> Floats:
        angle = np.linspace(0, 2 * np.pi, _RIM, endpoint=False)
        rim = np.stack([np.cos(angle), np.sin(angle), np.zeros(_RIM)], axis=1) * self.size_m[0] / 2
        end = np.array([0.0, 0.0, self.size_m[2] / 2])
        return self._placed(np.concatenate([rim * self.below - end, rim * self.above + end]) + self._middle_m)

    def _interval(self, start: Floats, ahead: Floats) -> tuple[Floats, Floats, Floats]:
        from_middle = start - self._middle_m
        narrowing = (self.below - self.above) * self.size_m[0] / 2 / self.size_m[2]
        radius = (self.below + self.above) * self.size_m[0] / 4 - narrowing * from_middle[:, 2]  # where the ray starts
        near, far = slabs(from_middle[:, 2:], ahead[:, 2:], np.array(self.size_m[2:]) / 2)
        side_near, side_far = _within_cone(from_middle, ahead, radius, narrowing)
        at = start + ahead * np.where(np.isfinite(side_near), side_near, 0)[:, None]
        outwards = at[:, :2] / np.maximum(np.linalg.norm(at[:, :2], axis=1, keepdims=True), 1e-12)
        side = np.c_[outwards, np.full(len(outwards), narrowing)] / np.hypot(1, narrowing)
        end = -np.sign(ahead) * (0.0, 0.0, 1.0)
        normal = np.where((side_near > near[:, 0])[:, None], side, end)
        return np.maximum(near[:, 0], side_near), np.minimum(far[:, 0], side_far), normal


@dataclass(frozen=True)
class Faceted(OddSolid):
    """A solid with flat faces only."""

    @property
    @abstractmethod
    def _faces(self) -> tuple[Floats, Floats]:
        """Normals (F, 3), outwards, and how far (F,) the faces are from the middle of the box around it."""

    def _interval(self, start: Floats, ahead: Floats) -> tuple[Floats, Floats, Floats]:
        normals, distance_m = self._faces
        climb = turned(ahead, normals.T)
        with np.errstate(divide="ignore", invalid="ignore"):
            at = (distance_m - turned(start - self._middle_m, normals.T)) / climb
        entering, leaving = np.where(climb < 0, at, -np.inf), np.where(climb > 0, at, np.inf)
        return entering.max(axis=1), leaving.min(axis=1), normals[entering.argmax(axis=1)]


@dataclass(frozen=True)
class Pyramid(Faceted):
    """A pyramid without its tip: a box whose top is `taper` times as long and wide as what it stands on."""

    taper: float = 0.6

    @property
    def _middle_m(self) -> Floats:
        share = (1 + 2 * self.taper + 3 * self.taper**2) / (4 * (1 + self.taper + self.taper**2))
        return np.array([0.0, 0.0, (0.5 - share) * self.size_m[2]])

    @property
    def _faces(self) -> tuple[Floats, Floats]:
        x, y, z = np.array(self.size_m) / 2
        sides = [
            np.array([sign * (axis == 0), sign * (axis == 1), (1 - self.taper) * half / (2 * z)])
            for axis, half in ((0, x), (1, y))
            for sign in (-1.0, 1.0)
        ]
        halfway = (1 + self.taper) / 2
        distance_m = [halfway * half / np.linalg.norm(side) for side, half in zip(sides, (x, x, y, y))]
        normals = [side / np.linalg.norm(side) for side in sides]
        return np.array([*normals, (0.0, 0.0, -1.0), (0.0, 0.0, 1.0)]), np.array([*distance_m, z, z])

    def hull_m(self) -> Floats:
        unit = np.stack(np.meshgrid(*[(-0.5, 0.5)] * 3), axis=-1).reshape(-1, 3)
        unit[unit[:, 2] > 0, :2] *= self.taper
        return self._placed(unit * self.size_m + self._middle_m)


@dataclass(frozen=True)
class Wedge(Faceted):
    """Half of a box that is cut along a diagonal: at one end of its first size it is as high as its third."""

    @property
    def _middle_m(self) -> Floats:
        return np.array([self.size_m[0] / 6, 0.0, self.size_m[2] / 6])

    @property
    def _faces(self) -> tuple[Floats, Floats]:
        x, y, z = np.array(self.size_m) / 2
        slope = np.array([z, 0.0, x]) / np.hypot(x, z)
        normals = np.array([slope, (-1.0, 0, 0), (0, -1.0, 0), (0, 1.0, 0), (0, 0, -1.0)])
        return normals, np.array([0.0, x, y, y, z])

    @property
    def yaw_period_rad(self) -> float:
        return 2 * np.pi

    def hull_m(self) -> Floats:
        x, y, z = np.array(self.size_m) / 2
        points = [(-x, side, -z) for side in (-y, y)] + [(x, side, -z) for side in (-y, y)]
        points += [(-x, side, z) for side in (-y, y)]
        return self._placed(np.array(points) + self._middle_m)


@dataclass(frozen=True)
class HalfRound(OddSolid):
    """Half a cylinder, on its flat side: own z is its axis, own x points up, the first size is half of the second. It
    must be lying."""

    @property
    def _middle_m(self) -> Floats:
        return np.array([self.size_m[0] / 2 - self._flat_m, 0.0, 0.0])

    @property
    def _flat_m(self) -> float:
        """How far the flat side is from the centre of its volume."""
        return 4 * self.size_m[0] / (3 * np.pi)

    def hull_m(self) -> Floats:
        angle = np.linspace(-np.pi / 2, np.pi / 2, _RIM + 1)
        rim = np.stack([np.cos(angle), np.sin(angle), np.zeros(_RIM + 1)], axis=1) * self.size_m[0] - (
            self._flat_m,
            0,
            0,
        )
        end = np.array([0, 0, self.size_m[2] / 2])
        return self._placed(np.concatenate([rim - end, rim + end]))

    def _interval(self, start: Floats, ahead: Floats) -> tuple[Floats, Floats, Floats]:
        from_axis = start + (self._flat_m, 0.0, 0.0)
        end_near, end_far = slabs(start[:, 2:], ahead[:, 2:], np.array(self.size_m[2:]) / 2)
        side_near, side_far = ball(from_axis[:, :2], ahead[:, :2], self.size_m[0])
        with np.errstate(divide="ignore"):
            flat = -from_axis[:, 0] / ahead[:, 0]
        flat_near, flat_far = np.where(ahead[:, 0] > 0, flat, -np.inf), np.where(ahead[:, 0] < 0, flat, np.inf)
        side = (from_axis + ahead * np.where(np.isfinite(side_near), side_near, 0)[:, None]) * (1, 1, 0)
        faces = np.stack([end_near[:, 0], side_near, flat_near])
        normals = np.stack(
            [-np.sign(ahead) * (0.0, 0.0, 1.0), side / self.size_m[0], np.tile((-1.0, 0.0, 0.0), (len(ahead), 1))]
        )
        first = faces.argmax(axis=0)
        far = np.minimum(np.minimum(end_far[:, 0], side_far), flat_far)
        return faces.max(axis=0), far, normals[first, np.arange(len(ahead))]


@dataclass(frozen=True)
class Egg(Solid):
    """An ellipsoid."""

    def hull_m(self) -> Floats:
        rising = np.linspace(-np.pi / 2, np.pi / 2, _RIM // 2 + 1)
        turn, climb = np.meshgrid(np.linspace(0, 2 * np.pi, _RIM, endpoint=False), rising)
        level = np.cos(climb)
        points = np.stack([level * np.cos(turn), level * np.sin(turn), np.sin(climb)], axis=-1).reshape(-1, 3)
        return self._placed(points * np.array(self.size_m) / 2)

    def _interval(self, start: Floats, ahead: Floats) -> tuple[Floats, Floats, Floats]:
        size = np.array(self.size_m)
        near, far = ball(start / size, ahead / size, 0.5)
        at = np.where(np.isfinite(near), near, 0)[:, None]
        normal = (start + ahead * at) / size**2
        return near, far, normal / np.linalg.norm(normal, axis=1, keepdims=True)


def _within_cone(start: Floats, ahead: Floats, radius: Floats, narrowing: float) -> tuple[Floats, Floats]:
    """From where to where each ray is within an endless cone about z, of this radius (N,) where it starts and so much
    less a metre up; past its tip there is none."""
    a = dot(ahead[:, :2], ahead[:, :2]) - (narrowing * ahead[:, 2]) ** 2
    b = dot(ahead[:, :2], start[:, :2]) + narrowing * ahead[:, 2] * radius
    c = dot(start[:, :2], start[:, :2]) - radius**2
    with np.errstate(divide="ignore", invalid="ignore"):
        root = np.sqrt(b * b - a * c)
        one, other = (-b - root) / a, (-b + root) / a
    low, high = np.fmin(one, other), np.fmax(one, other)
    missed = ~np.isfinite(low)
    steep, widening = a < 0, narrowing * ahead[:, 2] < 0  # a steep ray stays within the cone to one end
    near = np.where(steep, np.where(widening, high, -np.inf), low)
    far = np.where(steep, np.where(widening, np.inf, low), high)
    return np.where(missed & ~steep, np.inf, near), np.where(missed & ~steep, -np.inf, far)
