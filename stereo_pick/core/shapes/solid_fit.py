"""A solid that explains an object's two outlines."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import cv2
import numpy as np

from stereo_pick.core.arrays import Floats, floats
from stereo_pick.core.camera import Camera
from stereo_pick.core.errors import ArrayError
from stereo_pick.core.rig import StereoRig
from stereo_pick.core.shapes.kinds import KINDS, SPHERE, Round
from stereo_pick.core.shapes.predicted import silhouettes
from stereo_pick.core.shapes.solid_angle import centroid_px
from stereo_pick.core.shapes.solids import Solids

_POINTS = 96


@dataclass(frozen=True, eq=False)
class SolidFit:
    """A sphere, cylinder, box or hexagonal prism in the rectified left frame.

    kind: a name of `kinds.KINDS`; centre_m: (3,); rotation: (3, 3), its columns are the solid's axes, a cylinder's and
    a hexagonal prism's own the third, and the latter's corners lie on the first; size_m: (3,), along these axes;
    residual_px: robust root mean square distance of the outlines from its silhouettes; covariance: (3, 3) [m²], of the
    centre, and about that of the triangulated solid-angle centroids moved by `perspective_shift_px`.
    """

    kind: str
    centre_m: Floats
    rotation: Floats
    size_m: Floats
    residual_px: float
    covariance: Floats

    def __post_init__(self) -> None:
        if self.kind not in KINDS:
            raise ArrayError(f"kind is {self.kind!r}, must be one of {', '.join(KINDS)}")
        for name, shape in (("centre_m", (3,)), ("rotation", (3, 3)), ("size_m", (3,)), ("covariance", (3, 3))):
            object.__setattr__(self, name, floats(name, getattr(self, name), *shape))

    @cached_property
    def solid(self) -> Solids:
        """The solid as one that can be seen and measured."""
        kind = KINDS[self.kind]
        half_m = np.array([[(self.size_m / kind.spans)[kind.axes.index(i)] / 2 for i in range(kind.sizes)]])
        return Solids(kind, self.centre_m[None], self.rotation[None], half_m, np.zeros((1, 3, 0)))

    @property
    def flatness(self) -> float:
        """Its least size as a part of its greatest."""
        return float(self.size_m.min() / self.size_m.max())

    def reach_m(self, direction: Floats) -> float:
        """How far the solid reaches from its centre in a direction (3,), a unit vector of the rectified left frame."""
        solid, own = self.solid, direction @ self.rotation
        return float(solid.kind.touch(own[None, None], solid.half_m)[0, 0] @ own)

    def overlaps(self, other: SolidFit) -> bool:
        """Whether the centre of one of the two lies within the other's sides."""
        return self.contains_centre_of(other) or other.contains_centre_of(self)

    def contains_centre_of(self, other: SolidFit) -> bool:
        """Whether the other's centre lies within its own sides."""
        return bool((np.abs((other.centre_m - self.centre_m) @ self.rotation) < self.size_m / 2).all())

    def centre_px(self, camera: Camera) -> Floats:
        """Where the centre (2,) [px] appears in a rectified camera."""
        projected = camera.P @ np.append(self.centre_m, 1.0)
        return np.asarray(projected[:2] / projected[2])

    @cached_property
    def _silhouettes(self) -> dict[StereoRig, Floats]:
        return {}

    def silhouettes(self, rig: StereoRig) -> Floats:
        """Its outlines (2, M, 2), normalized, in both views of its rig, as `predicted.silhouettes` has them."""
        if rig not in self._silhouettes:
            self._silhouettes[rig] = silhouettes(self.solid, rig.eyes_m)[0]
        return self._silhouettes[rig]

    @cached_property
    def _silhouettes_px(self) -> dict[Camera, Floats]:
        return {}

    def silhouette_px(self, camera: Camera) -> Floats:
        """Its outline (M, 2) [px] in a rectified camera of its rig, a convex polygon."""
        if camera not in self._silhouettes_px:
            self._silhouettes_px[camera] = self._silhouette_px(camera)
        return self._silhouettes_px[camera]

    def _silhouette_px(self, camera: Camera) -> Floats:
        focal, middle = camera.P[[0, 1], [0, 1]], camera.P[:2, 2]
        eye = np.array([[-camera.P[0, 3] / focal[0], -camera.P[1, 3] / focal[1], 0.0]])
        solid = self.solid
        if isinstance(solid.kind, Round):
            points = solid.kind.horizon(((eye - self.centre_m) @ self.rotation)[None], solid.half_m, _POINTS)[0, 0]
        else:
            points = solid.kind.corners_m(solid.half_m)[0]
        seen = self.centre_m - eye + points @ self.rotation.T
        image = seen[:, :2] / seen[:, 2:] * focal
        around = image - image.mean(axis=0)
        hull = cv2.convexHull(around.astype(np.float32), returnPoints=False)[:, 0]
        return np.asarray(image[hull] + middle)

    def perspective_shift_px(self, camera: Camera) -> Floats:
        """What to add (2,) [px] to the solid-angle centroid of its outline to come to the image of its centre."""
        if self.kind == SPHERE.name:
            return np.zeros(2)
        return np.asarray(self.centre_px(camera) - centroid_px(self.silhouette_px(camera), camera))
