"""Puts parts on a table so that both cameras see them as a family of scenes wants it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

import cv2
import numpy as np
from rendering import Solid

from stereo_pick.core.arrays import Floats
from stereo_pick.core.rig import StereoRig
from stereo_pick.core.transform import Transform

Outlines = tuple[Floats, Floats]
_TRIES = 400
_BISECTIONS = 24


class NoRoomError(Exception):
    """The part fits nowhere."""


@dataclass
class Table:
    """A table before a rig, and the parts that stand on it so far."""

    rig: StereoRig
    left_T_table: Transform
    random: np.random.Generator
    reach_m: float = 0.24
    margin_px: float = 8.0
    parts: list[Solid] = field(default_factory=list)

    def add(self, part: Solid, gap_px: float = 6.0) -> Solid:
        """Put the part where it is whole in both images and this far from all others; raises NoRoomError."""
        for _ in range(_TRIES):
            placed = replace(part, **self.somewhere())
            if self.whole(placed) and self.apart(placed, gap_px):
                self.parts.append(placed)
                return placed
        raise NoRoomError

    def somewhere(self) -> dict[str, float]:
        x_m, y_m = self.random.uniform(-self.reach_m, self.reach_m, 2)
        return {"x_m": float(x_m), "y_m": float(y_m)}

    def whole(self, part: Solid) -> bool:
        """Whether both images show all of it."""
        return all(
            (outline > self.margin_px).all() and (outline < np.array(camera.frame_size) - self.margin_px).all()
            for outline, camera in zip(self.outlines(part), (self.rig.left, self.rig.right))
        )

    def apart(self, part: Solid, gap_px: float) -> bool:
        """Whether it keeps this distance to all others in both images."""
        return all(min(self.gaps_px(part, other)) >= gap_px for other in self.parts)

    def outlines(self, part: Solid) -> Outlines:
        """Convex hulls (N, 2) of the part in the raw left and right images."""
        left, right = self.rig.project(self.left_T_table.apply(part.hull_m()))
        return hull(left), hull(right)

    def gaps_px(self, one: Solid, other: Solid) -> tuple[float, float]:
        """Distance of two parts in the left and in the right image, negative where they overlap."""
        left, right = (gap(a, b) for a, b in zip(self.outlines(one), self.outlines(other)))
        return left, right

    def beside(self, part: Solid, other: Solid, direction_rad: float, wanted: Callable[[Solid], float]) -> Solid:
        """The part moved from another one in a direction until `wanted`, which grows on the way, becomes zero."""
        near, far = 0.0, 0.3
        for _ in range(_BISECTIONS):
            middle = (near + far) / 2
            if wanted(shifted(part, other, direction_rad, middle)) < 0:
                near = middle
            else:
                far = middle
        return shifted(part, other, direction_rad, far)


def shifted(part: Solid, other: Solid, direction_rad: float, distance_m: float) -> Solid:
    """The part at a distance from another."""
    return replace(
        part,
        x_m=other.x_m + distance_m * float(np.cos(direction_rad)),
        y_m=other.y_m + distance_m * float(np.sin(direction_rad)),
    )


def footprint_gap_m(one: Solid, other: Solid) -> float:
    """Distance of two parts seen from above."""
    return gap(*(hull(part.hull_m()[:, :2] * 1000) for part in (one, other))) / 1000


def hull(points: Floats) -> Floats:
    """The convex hull (N, 2) of points (M, 2)."""
    return np.asarray(cv2.convexHull(points.astype(np.float32)).reshape(-1, 2), np.float64)


def gap(one: Floats, other: Floats) -> float:
    """Distance of two convex polygons, negative where they overlap."""
    shared, _ = cv2.intersectConvexConvex(one.astype(np.float32), other.astype(np.float32))
    if shared > 0:
        return -float(np.sqrt(shared))
    return min(_outside(one, other), _outside(other, one))


def overlap(one: Floats, other: Floats) -> float:
    """The share of a convex polygon that another one covers."""
    shared, _ = cv2.intersectConvexConvex(one.astype(np.float32), other.astype(np.float32))
    return float(shared) / float(cv2.contourArea(one.astype(np.float32)))


def _outside(polygon: Floats, points: Sequence[Floats] | Floats) -> float:
    contour = polygon.astype(np.float32).reshape(-1, 1, 2)
    return min(-cv2.pointPolygonTest(contour, (float(x), float(y)), True) for x, y in points)
