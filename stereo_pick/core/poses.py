"""Object poses: what the manipulator's controller is told."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from stereo_pick.core.arrays import Floats, floats
from stereo_pick.core.correspondence import Correspondences
from stereo_pick.core.hand_eye.rotations import to_quaternion
from stereo_pick.core.refusal import Refusal
from stereo_pick.core.rig import StereoRig
from stereo_pick.core.triangulation import Points


@dataclass(frozen=True, eq=False)
class ObjectPoses:
    """N objects in the left camera's own optical frame (x right, y down, z forward), left to right.

    xyz: (N, 3) [m], where the two rays of the method's image points meet: with `feature` those through the centroids
    of the two outlines, for a compact part close to the centre of its volume; with `ssd` a point of the visible
    surface; yaw_rad: (N,), direction of the
    object's length, turned from x towards y about z; size_m: (N, 2), length and width of its outline as the left
    camera sees it; covariance: (N, 3, 3) [m²]; ray_gap: (N,) [m]; left_px, right_px: (N, 2) in the raw images [px].
    covariance_of: whose uncertainty the covariance contains. `positioning` may move xyz and covariance to the frame
    `frame_id` (else empty), into which frame_R_camera (3, 3) turns from the left optical one; yaw_rad stays.
    """

    stamp_ns: int
    xyz: Floats
    yaw_rad: Floats
    size_m: Floats
    covariance: Floats
    ray_gap: Floats
    left_px: Floats
    right_px: Floats
    refused: tuple[Refusal, ...] = ()
    covariance_of: tuple[str, ...] = ("image",)
    frame_id: str = ""
    frame_R_camera: Floats = field(default_factory=lambda: np.eye(3))

    def __post_init__(self) -> None:
        count = len(self.xyz)
        shapes: dict[str, tuple[int, ...]] = {
            "xyz": (count, 3), "yaw_rad": (count,), "size_m": (count, 2), "covariance": (count, 3, 3),
            "ray_gap": (count,), "left_px": (count, 2), "right_px": (count, 2),
        }  # fmt: skip
        for name, shape in shapes.items():
            object.__setattr__(self, name, floats(name, np.reshape(getattr(self, name), shape), *shape))
        object.__setattr__(self, "frame_R_camera", floats("frame_R_camera", self.frame_R_camera, 3, 3))

    def __len__(self) -> int:
        return len(self.xyz)

    def quaternions(self) -> Floats:
        """Orientations (N, 4) as x, y, z, w: the turn by yaw_rad about the camera's z, then that into the frame."""
        x, y, z, w = to_quaternion(self.frame_R_camera)
        sine, cosine = np.sin(self.yaw_rad / 2), np.cos(self.yaw_rad / 2)
        return np.stack(
            [x * cosine + y * sine, y * cosine - x * sine, z * cosine + w * sine, w * cosine - z * sine], axis=1
        )

    @property
    def heading_rad(self) -> Floats:
        """Direction (N,) of the objects' length about the z axis of the frame; yaw_rad in the camera's own."""
        length = np.stack([np.cos(self.yaw_rad), np.sin(self.yaw_rad)], axis=1) @ self.frame_R_camera[:, :2].T
        return np.asarray(np.arctan2(length[:, 1], length[:, 0]))


def estimate_poses(points: Points, correspondences: Correspondences, rig: StereoRig, stamp_ns: int) -> ObjectPoses:
    """Put position, direction and size together for every triangulated object."""
    row = points.row
    left_px, right_px = correspondences.left_px[row], correspondences.right_px[row]
    depth_m = points.xyz @ rig.left.R[2]
    angle = correspondences.direction_rad[row]
    length_axis = np.stack([np.cos(angle), np.sin(angle), np.zeros(len(row))], axis=1) @ rig.left.R
    return ObjectPoses(
        stamp_ns=stamp_ns,
        xyz=points.xyz,
        yaw_rad=np.arctan2(length_axis[:, 1], length_axis[:, 0]),
        size_m=correspondences.size_px[row] * depth_m[:, None] / rig.focal_px,
        covariance=points.covariance,
        ray_gap=points.ray_gap,
        left_px=rig.left.unrectified(left_px),
        right_px=rig.right.unrectified(right_px),
        refused=points.refused,
    )
