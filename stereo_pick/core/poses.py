"""Object poses: what the manipulator's controller is told."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from stereo_pick.core.arrays import Floats, floats, frozen
from stereo_pick.core.confidence import within
from stereo_pick.core.correspondence import Correspondences
from stereo_pick.core.hand_eye.rotations import to_quaternion
from stereo_pick.core.refusal import Refusal
from stereo_pick.core.rig import StereoRig
from stereo_pick.core.triangulation import Points


@dataclass(frozen=True, eq=False)
class ObjectPoses:
    """N objects in the left camera's own optical frame (x right, y down, z forward), left to right.

    xyz: (N, 3) [m], where the two rays of the method's image points meet: with `feature` those through the centroids
    of the two outlines, moved to the centre of the volume where a solid explains both; with `ssd` a point of the
    visible surface. rotation: (N, 3, 3), its columns are the directions of an object's length, of its width, and down
    into the table; size_m: (N, 3), length, width and height; kinds: N of `extent.KINDS`. Where no solid explains an
    object, length and width are those of its outline as the left camera sees it, and the height is 0.
    covariance: (N, 3, 3) [m²]; ray_gap: (N,) [m]; left_px, right_px: (N, 2) in the raw images [px].
    tolerance_m: how far off a position may be for the pick to succeed; min_confidence: the least with which one is to
    be published, once its covariance is whole. covariance_of: whose uncertainty the covariance contains. `positioning`
    may move xyz and covariance to the frame `frame_id` (else empty), into which frame_R_camera
    (3, 3) turns from the left optical one; rotation stays.
    """

    stamp_ns: int
    xyz: Floats
    rotation: Floats
    size_m: Floats
    kinds: tuple[str, ...]
    covariance: Floats
    ray_gap: Floats
    left_px: Floats
    right_px: Floats
    tolerance_m: float
    min_confidence: float = 0.0
    refused: tuple[Refusal, ...] = ()
    covariance_of: tuple[str, ...] = ("image",)
    frame_id: str = ""
    frame_R_camera: Floats = field(default_factory=lambda: np.eye(3))

    def __post_init__(self) -> None:
        count = len(self.xyz)
        shapes: dict[str, tuple[int, ...]] = {
            "xyz": (count, 3), "rotation": (count, 3, 3), "size_m": (count, 3), "covariance": (count, 3, 3),
            "ray_gap": (count,), "left_px": (count, 2), "right_px": (count, 2),
        }  # fmt: skip
        for name, shape in shapes.items():
            object.__setattr__(self, name, floats(name, np.reshape(getattr(self, name), shape), *shape))
        object.__setattr__(self, "frame_R_camera", floats("frame_R_camera", self.frame_R_camera, 3, 3))

    def __len__(self) -> int:
        return len(self.xyz)

    @cached_property
    def confidence(self) -> Floats:
        """The probability (N,), by the covariance, that a position is off by no more than tolerance_m."""
        return frozen(within(self.covariance, self.tolerance_m))

    def confident(self, rig: StereoRig) -> ObjectPoses:
        """Those of at least min_confidence; the others are refused. rig: it located them."""
        enough = self.confidence >= self.min_confidence
        if enough.all():
            return self
        unsure, kept = np.flatnonzero(~enough), np.flatnonzero(enough)
        left_px, right_px = rig.left.rectified(self.left_px[unsure]), rig.right.rectified(self.right_px[unsure])
        details = [f"{self.confidence[i]:.3f} to be within {self.tolerance_m * 1000:g} mm" for i in unsure]
        refused = [Refusal("low_confidence", *each) for each in zip(left_px, right_px, details)]
        of_each = ("xyz", "rotation", "size_m", "covariance", "ray_gap", "left_px", "right_px")
        return replace(
            self,
            **{name: getattr(self, name)[kept] for name in of_each},
            kinds=tuple(self.kinds[i] for i in kept),
            refused=(*self.refused, *refused),
        )

    def quaternions(self) -> Floats:
        """Orientations (N, 4) as x, y, z, w, in the frame."""
        turned = [to_quaternion(self.frame_R_camera @ rotation) for rotation in self.rotation]
        return np.array(turned, np.float64).reshape(-1, 4)

    @property
    def heading_rad(self) -> Floats:
        """Direction (N,) of the objects' length about the z axis of the frame."""
        length = self.rotation[:, :, 0] @ self.frame_R_camera.T
        return np.asarray(np.arctan2(length[:, 1], length[:, 0]))


def estimate_poses(points: Points, correspondences: Correspondences, rig: StereoRig, stamp_ns: int) -> ObjectPoses:
    """Put position, direction and size together for every triangulated object."""
    row = points.row
    left_px, right_px = correspondences.left_px[row], correspondences.right_px[row]
    extents = [correspondences.extents[i] for i in row]
    flat_m = correspondences.size_px[row] * (points.xyz @ rig.left.R[2])[:, None] / rig.focal_px
    flat = [_about_view(angle) for angle in correspondences.direction_rad[row]]
    return ObjectPoses(
        stamp_ns=stamp_ns,
        xyz=points.xyz,
        rotation=np.array([rig.left.R.T @ (e.rotation if e else r) for e, r in zip(extents, flat)]),
        size_m=np.array([e.size_m if e else (*size, 0.0) for e, size in zip(extents, flat_m)]),
        kinds=tuple(e.kind if e else "" for e in extents),
        covariance=points.covariance,
        ray_gap=points.ray_gap,
        left_px=rig.left.unrectified(left_px),
        right_px=rig.right.unrectified(right_px),
        tolerance_m=points.tolerance_m,
        min_confidence=points.min_confidence,
        refused=points.refused,
    )


def _about_view(angle_rad: float) -> Floats:
    """The turn (3, 3) of x towards y by an angle."""
    c, s = np.cos(angle_rad), np.sin(angle_rad)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
