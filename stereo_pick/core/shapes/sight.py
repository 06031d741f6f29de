"""The outlines of all objects of a scene as arrays, and what solids make of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from stereo_pick.core.arrays import Floats, Ints
from stereo_pick.core.camera import Camera
from stereo_pick.core.rig import StereoRig
from stereo_pick.core.shapes.kinds import dot
from stereo_pick.core.shapes.outline import Outline
from stereo_pick.core.shapes.table import Table


@dataclass(frozen=True, eq=False)
class Sight:
    """O objects seen in two views by N points each; the first axis is the object's, the second the view's.

    points, normals: (O, 2, N, 2), normalized coordinates of the rectified views; weight: (O, 2, N), of the points that
    are the object's edge; inner: (O, 2, N), 1 where something else ends what is seen of the object, so that it reaches
    at least there; smooth: (O, 2, N), 0 at corners; eyes_m: (2, 3), the cameras' places in the rectified left frame;
    focal_px; centre_m (O, 3) and radius_m (O,): roughly; table: what they all stand on, if that is known.
    """

    points: Floats
    normals: Floats
    weight: Floats
    inner: Floats
    smooth: Floats
    eyes_m: Floats
    focal_px: float
    centre_m: Floats
    radius_m: Floats
    table: Table | None = None

    @staticmethod
    def of(pairs: Sequence[tuple[Outline, Outline]], rig: StereoRig, table: Table | None = None) -> Sight:
        """The outlines (left, right) of at least one object; all of as many points."""
        points_px, normals, weight, corner = (
            np.array([[getattr(side, name) for side in pair] for pair in pairs])
            for name in ("points_px", "normals", "weight", "corner")
        )
        return Sight.of_points(points_px, normals, weight, 1 - corner, rig, table)

    @staticmethod
    def of_points(
        points_px: Floats, normals: Floats, weight: Floats, smooth: Floats, rig: StereoRig, table: Table | None = None
    ) -> Sight:
        """Of points (O, 2, N, 2) [px] and what belongs to them."""
        points = np.stack([normalized(points_px[:, i], lens) for i, lens in enumerate((rig.left, rig.right))], axis=1)
        low, high = points.min(axis=2), points.max(axis=2)
        middle, half = (low + high) / 2, (high - low) / 2
        depth = rig.baseline_m / np.maximum(middle[:, 0, 0] - middle[:, 1, 0], 1e-6)
        x, y = middle[:, 0, 0] * depth, middle[..., 1].mean(axis=1) * depth
        radius = half.mean(axis=(1, 2)) * depth
        centre = np.stack([x, y, depth], axis=1)
        return Sight(points, normals, weight, 1 - weight, smooth, rig.eyes_m, rig.focal_px, centre, radius, table)

    @cached_property
    def rays(self) -> Floats:
        """Those (O, 2, N, 3) through the points."""
        return np.concatenate([self.points, np.ones((*self.points.shape[:3], 1))], axis=3)

    @cached_property
    def planes(self) -> Floats:
        """Those (O, 2N, 3) through the cameras and the outlines: see `tangent_planes`."""
        return tangent_planes(self.points, self.normals).reshape(len(self.points), -1, 3)

    def only(self, objects: Ints) -> Sight:
        """The same of these objects alone."""
        return replace(self._of(objects), centre_m=self.centre_m[objects], radius_m=self.radius_m[objects])

    def coarse(self) -> Sight:
        """Every second point, for a first look."""
        return self._of(np.s_[:, :, ::2])

    def without_corners(self) -> Sight:
        """The same with corners given no weight."""
        return replace(self, weight=self.weight * self.smooth)

    def _of(self, which: Any) -> Sight:
        return replace(
            self,
            points=self.points[which],
            normals=self.normals[which],
            weight=self.weight[which],
            inner=self.inner[which],
            smooth=self.smooth[which],
        )


def tangent_planes(points: Floats, normals: Floats) -> Floats:
    """Normals (..., 3) of the planes through the camera and the lines through image points (..., 2)."""
    return np.concatenate([normals, -dot(points, normals)[..., None]], axis=-1)


def turning(points: Floats) -> tuple[Floats, Floats]:
    """How normalized image points (..., 2) move, per radian (..., 2), as a turn of their camera about its x axis, and
    one about its z axis, is undone."""
    x, y = points[..., 0], points[..., 1]
    return np.stack([-x * y, -(1 + y * y)], axis=-1), np.stack([-y, x], axis=-1)


def normalized(points_px: Floats, camera: Camera) -> Floats:
    """Points (..., 2) of a rectified view as directions (..., 2), the third component of which is 1."""
    return np.asarray((points_px - camera.P[:2, 2]) / camera.P[[0, 1], [0, 1]])


def in_pixels(points: Floats, camera: Camera) -> Floats:
    """Directions (..., 2), as of `normalized`, as points (..., 2) of a rectified view [px]."""
    return np.asarray(points * camera.P[[0, 1], [0, 1]] + camera.P[:2, 2])


def seen_px(points_m: Floats, camera: Camera) -> Floats:
    """Where (..., 2) a rectified view shows points (..., 3) [m], rectified left frame."""
    seen = points_m @ camera.P[:, :3].T + camera.P[:, 3]
    return np.asarray(seen[..., :2] / seen[..., 2:])
