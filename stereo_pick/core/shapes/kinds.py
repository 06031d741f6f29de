"""The kinds of solid, each by its support function: how far it reaches in a direction.

A plane through a camera touches a convex solid exactly if the solid's support in the direction of the plane's normal
ends on the plane. So an outline's tangents need no projected model: the support of these solids is linear in their
half sizes, and its derivative is the point that touches.
"""

from __future__ import annotations

from abc import ABC, abstractmethod

import numpy as np

from stereo_pick.core.arrays import Floats

BOX_CORNERS = np.stack(np.meshgrid(*[(-1.0, 1.0)] * 3), axis=-1).reshape(-1, 3)
"""Of the box (8, 3) whose half sizes are 1."""

_TINY = 1e-12


def dot(a: Floats, b: Floats) -> Floats:
    """Scalar products over the last axis."""
    return np.asarray(np.einsum("...i,...i->...", a, b))


class Kind(ABC):
    """A family of convex solids, symmetric about their centre. Directions (S, N, 3) are in the solids' own axes."""

    name: str
    sizes: int  # how many half sizes describe it
    turns: tuple[int, ...]  # the axes about which a turn changes it
    axes: tuple[int, int, int]  # which half size belongs to which axis

    @property
    def shares(self) -> Floats:
        """Which half size each axis has: (3, sizes), ones and zeros."""
        return np.eye(self.sizes)[list(self.axes)]

    @abstractmethod
    def touch(self, directions: Floats, half_m: Floats) -> Floats:
        """The points (S, N, 3) [m] of the solids that lie furthest in each direction; half sizes (S, sizes) [m]."""


class Round(Kind):
    """A kind whose silhouettes have no corners."""

    @abstractmethod
    def horizon(self, eyes_m: Floats, half_m: Floats, count: int) -> Floats:
        """Points (S, E, count, 3) [m] around what eyes (S, E, 3) see of the solids, in order; count is even."""

    @abstractmethod
    def onto(self, points: Floats, half_m: Floats) -> Floats:
        """Points (S, N, 3) [m] moved to the curved surface."""


class Sphere(Round):
    """Half size: the radius."""

    name, sizes, turns, axes = "sphere", 1, (), (0, 0, 0)

    def touch(self, directions: Floats, half_m: Floats) -> Floats:
        """Straight from the centre."""
        return self.onto(directions, half_m)

    def onto(self, points: Floats, half_m: Floats) -> Floats:
        """Along the radius."""
        return points * (half_m / (np.sqrt(dot(points, points)) + _TINY))[..., None]

    def horizon(self, eyes_m: Floats, half_m: Floats, count: int) -> Floats:
        """A circle, the nearer the smaller."""
        distance = np.sqrt(dot(eyes_m, eyes_m))[..., None]
        ahead = eyes_m / distance
        radius = half_m[:, None]
        sine = np.minimum(radius / distance, 0.99)
        side = np.cross(ahead, np.eye(3)[np.abs(ahead).argmin(axis=2)])
        side *= (radius * np.sqrt(1 - sine * sine)) / np.sqrt(dot(side, side))[..., None]
        angle = np.linspace(0, 2 * np.pi, count, endpoint=False)[:, None]
        ring = np.cos(angle) * side[:, :, None] + np.sin(angle) * np.cross(ahead, side)[:, :, None]
        return np.asarray(ring + (radius * sine * ahead)[:, :, None])


class Cylinder(Round):
    """Half sizes: the radius, and half the length along the third axis."""

    name, sizes, turns, axes = "cylinder", 2, (0, 1), (0, 0, 1)

    def touch(self, directions: Floats, half_m: Floats) -> Floats:
        """On the rim of one of the two ends."""
        x, y, z = directions[..., 0], directions[..., 1], directions[..., 2]
        return self.onto(np.stack([x, y, np.copysign(half_m[:, 1:], z)], axis=2), half_m)

    def onto(self, points: Floats, half_m: Floats) -> Floats:
        """Along the radius."""
        stretch = half_m[:, :1] / (np.sqrt(dot(points[..., :2], points[..., :2])) + _TINY)
        return points * np.stack([stretch, stretch, np.ones_like(stretch)], axis=2)

    def horizon(self, eyes_m: Floats, half_m: Floats, count: int) -> Floats:
        """An arc of each rim: the one away from the eye where it sees that end's face, else the one towards it.

        An eye that looks along the axis sees one rim only.
        """
        radius, half_length = half_m[:, None, :1], half_m[:, None, 1:]
        x, y, z = eyes_m[..., :1], eyes_m[..., 1:2], eyes_m[..., 2:]
        off_axis = np.sqrt(x * x + y * y)
        facing, width = np.arctan2(y, x), np.arccos(np.minimum(radius / (off_axis + _TINY), 1.0))
        along = np.linspace(-1, 1, count // 2)
        arcs = []
        for end in (1.0, -1.0):
            sees = end * z > half_length
            middle = facing + np.where(sees, np.pi, 0.0)
            angle = middle + np.where(sees, np.pi - width, width) * along * np.where(sees, -end, end)
            height = np.where((off_axis > radius) | sees, end, -end) * half_length
            arcs.append(np.stack([radius * np.cos(angle), radius * np.sin(angle), height + 0 * angle], axis=3))
        return np.concatenate(arcs, axis=2)


class Box(Kind):
    """Half sizes: along its three axes."""

    name, sizes, turns, axes = "box", 3, (0, 1, 2), (0, 1, 2)

    def touch(self, directions: Floats, half_m: Floats) -> Floats:
        """A corner."""
        return np.copysign(half_m[:, None], directions)


SPHERE, CYLINDER, BOX = Sphere(), Cylinder(), Box()
KINDS: dict[str, Kind] = {kind.name: kind for kind in (SPHERE, CYLINDER, BOX)}
