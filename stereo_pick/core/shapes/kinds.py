"""The kinds of solid, each by its support function: how far it reaches in a direction.

A plane through a camera touches a convex solid exactly if the solid's support in the direction of the plane's normal
ends on the plane. So an outline's tangents need no projected model: the support of these solids is linear in their
half sizes, and its derivative is the point that touches.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from functools import cached_property

import numpy as np

from stereo_pick.core.arrays import Floats, Ints

_TINY = 1e-12
_ROOT3 = np.sqrt(3.0)
_ENDS = np.array([1.0, -1.0])  # of what reaches along the third axis


def dot(a: Floats, b: Floats) -> Floats:
    """Scalar products over the last axis."""
    if a.shape[-1] == 2:  # several times as fast for many
        return np.asarray(a[..., 0] * b[..., 0] + a[..., 1] * b[..., 1])
    return np.asarray(np.einsum("...i,...i->...", a, b))


def cross(a: Floats, b: Floats) -> Floats:
    """What np.cross gives for vectors (..., 3), several times as fast."""
    a0, a1, a2 = a[..., 0], a[..., 1], a[..., 2]
    b0, b1, b2 = b[..., 0], b[..., 1], b[..., 2]
    product = np.empty_like(a)
    product[..., 0], product[..., 1], product[..., 2] = a1 * b2 - a2 * b1, a2 * b0 - a0 * b2, a0 * b1 - a1 * b0
    return product


class Convex(ABC):
    """A family of convex solids, symmetric about their centre. Directions (S, N, 3) are in the solids' own axes."""

    name: str
    sizes: int  # how many half sizes describe it
    turns: tuple[int, ...]  # the axes about which a turn changes it
    axes: tuple[int, int, int]  # which half size belongs to which axis

    @cached_property
    def shares(self) -> Floats:
        """Which half size each axis has: (3, sizes), ones and zeros."""
        return np.eye(self.sizes)[list(self.axes)]

    @property
    def spans(self) -> Floats:
        """How far the kind reaches along each axis (3,), in units of the half size that belongs to it."""
        return np.ones(3)

    @abstractmethod
    def touch(self, directions: Floats, half_m: Floats) -> Floats:
        """The points (S, N, 3) [m] of the solids that lie furthest in each direction; half sizes (S, sizes) [m]."""


class Round(Convex):
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
        ends = directions.copy()
        ends[..., 2] = np.copysign(half_m[:, 1:], directions[..., 2])
        return self.onto(ends, half_m)

    def onto(self, points: Floats, half_m: Floats) -> Floats:
        """Along the radius."""
        across = points[..., :2]
        moved = points.copy()
        moved[..., :2] *= (half_m[:, :1] / (np.sqrt(dot(across, across)) + _TINY))[..., None]
        return moved

    def horizon(self, eyes_m: Floats, half_m: Floats, count: int) -> Floats:
        """An arc of each rim: the one away from the eye where it sees that end's face, else the one towards it.

        An eye that looks along the axis sees one rim only.
        """
        radius, half_length = half_m[:, None, :1], half_m[:, None, 1:]
        x, y, z = eyes_m[..., :1], eyes_m[..., 1:2], eyes_m[..., 2:]
        off_axis = np.sqrt(x * x + y * y)
        facing, width = np.arctan2(y, x), np.arccos(np.minimum(radius / (off_axis + _TINY), 1.0))
        sees = z * _ENDS > half_length  # of either end its face
        middle, reach = np.where(sees, facing + np.pi, facing), np.where(sees, width - np.pi, width) * _ENDS
        heights_m = np.where((off_axis > radius) | sees, _ENDS, -_ENDS) * half_length
        return _arcs(middle, reach, radius, heights_m, count)


def _arcs(middle: Floats, reach: Floats, radius_m: Floats, heights_m: Floats, count: int) -> Floats:
    """Points (S, E, count, 3) [m] on an arc of each of the two rims (S, E, 2), which reaches from its middle [rad] so
    far [rad] to both sides."""
    angle = middle[..., None] + reach[..., None] * np.linspace(-1, 1, count // 2)
    points = np.empty((*angle.shape, 3))
    points[..., 0] = radius_m[..., None] * np.cos(angle)
    points[..., 1] = radius_m[..., None] * np.sin(angle)
    points[..., 2] = heights_m[..., None]
    return points.reshape(*middle.shape[:2], count, 3)


class Tube(Cylinder):
    """A cylinder of which only the side is seen: it is open, or its ends look like the table. What is seen of it is
    not convex: an end that faces the camera looks like a bite."""

    name = "tube"

    def horizon(self, eyes_m: Floats, half_m: Floats, count: int) -> Floats:
        """The arc of each rim on the eye's side; an eye that is no further from the axis than that sees no side."""
        radius, half_length = half_m[:, None, :1], half_m[:, None, 1:]
        x, y = eyes_m[..., :1], eyes_m[..., 1:2]
        width = np.arccos(np.minimum(radius / (np.sqrt(x * x + y * y) + _TINY), 1.0))
        facing = np.repeat(np.arctan2(y, x), 2, axis=2)
        return _arcs(facing, width * _ENDS, radius, np.broadcast_to(_ENDS * half_length, facing.shape), count)


class Prism(Convex):
    """A polygon that reaches along the third axis: all its faces are flat.

    corners: (C, 3), those of the prism whose half sizes are 1; edges: (2, E), the corners that each joins; beside:
    (2, E, 3), the outward normals of the two faces that meet there.
    """

    corners: Floats
    edges: Ints
    beside: Floats

    def __init__(self, polygon: Floats) -> None:
        count = len(polygon)
        self.corners = np.concatenate([np.c_[polygon, np.full(count, end)] for end in (-1.0, 1.0)])
        this = np.arange(count)
        after = np.roll(this, -1)
        self.edges = np.array([[*this, *(this + count), *this], [*after, *(after + count), *(this + count)]])
        side = np.c_[polygon + polygon[after], np.zeros(count)]
        side /= np.linalg.norm(side, axis=1, keepdims=True)
        low, high = (np.tile([0.0, 0.0, end], (count, 1)) for end in (-1.0, 1.0))
        self.beside = np.array([[*low, *high, *side[this - 1]], [*side, *side, *side]])

    @property
    def spans(self) -> Floats:
        """To its furthest corners."""
        return np.asarray(self.corners.max(axis=0))

    @cached_property
    def normals(self) -> Floats:
        """Of its faces, outwards: (F, 3)."""
        return np.asarray(np.unique(self.beside.reshape(-1, 3).round(9), axis=0))

    def corners_m(self, half_m: Floats) -> Floats:
        """Corners (S, C, 3) [m] of prisms with half sizes (S, sizes) [m]."""
        return self.corners * half_m[:, None, self.axes]


class Box(Prism):
    """Half sizes: along its three axes."""

    name, sizes, turns, axes = "box", 3, (0, 1, 2), (0, 1, 2)

    def __init__(self) -> None:
        super().__init__(np.array([(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)]))

    def touch(self, directions: Floats, half_m: Floats) -> Floats:
        """A corner."""
        return np.copysign(half_m[:, None], directions)


class HexPrism(Prism):
    """A regular one, as nuts and the heads of bolts. Half sizes: across two flats, and along the third axis.

    Corners lie on the first axis, the second is across flats.
    """

    name, sizes, turns, axes = "hexprism", 2, (0, 1, 2), (0, 0, 1)

    def __init__(self) -> None:
        angle = np.arange(6) * (np.pi / 3)
        super().__init__(np.stack([np.cos(angle), np.sin(angle)], axis=1) * 2 / _ROOT3)

    def touch(self, directions: Floats, half_m: Floats) -> Floats:
        """A corner."""
        beside = np.abs(directions[..., 1]) * _ROOT3 > np.abs(directions[..., 0])
        corner = np.stack([(2 - beside) / _ROOT3, beside.astype(float), np.ones(beside.shape)], axis=-1)
        return np.asarray(np.copysign(corner, directions) * half_m[:, None, self.axes])


Kind = Round | Prism
SPHERE, CYLINDER, BOX, HEX_PRISM, TUBE = Sphere(), Cylinder(), Box(), HexPrism(), Tube()
KINDS: dict[str, Kind] = {kind.name: kind for kind in (SPHERE, CYLINDER, BOX, HEX_PRISM)}
