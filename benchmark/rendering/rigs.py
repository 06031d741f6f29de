"""Rigs that scenes are rendered with, and tables before them."""

from __future__ import annotations

from collections.abc import Sequence

import cv2
import numpy as np

from stereo_pick.core.arrays import Floats
from stereo_pick.core.camera import Camera
from stereo_pick.core.rig import StereoRig
from stereo_pick.core.transform import Transform

SIZE_PX = (640, 480)


def camera(
    name: str = "left",
    focal_px: float | tuple[float, float] = 900.0,
    centre_px: tuple[float, float] = (319.5, 239.5),
    D: Sequence[float] = (0.0,) * 5,
    model: str = "plumb_bob",
    size_px: tuple[int, int] = SIZE_PX,
) -> Camera:
    """A camera that has not been rectified yet."""
    fx, fy = focal_px if isinstance(focal_px, tuple) else (focal_px, focal_px)
    K = np.array([[fx, 0, centre_px[0]], [0, fy, centre_px[1]], [0, 0, 1]])
    P = np.c_[K, np.zeros(3)]
    return Camera(name, *size_px, K, np.array(D), np.eye(3), P, model)


def rotation(rvec_rad: Sequence[float] | Floats) -> Floats:
    """The rotation (3, 3) of an axis times an angle."""
    return np.asarray(cv2.Rodrigues(np.array(rvec_rad, np.float64))[0])


def thesis_cameras() -> tuple[Camera, Camera, Transform]:
    """Chapter 3.4's calibration, with `X_R = R X_L + T`."""
    left = camera("left", (1126.16240, 1129.79384), (298.95439, 260.18405), (-0.26468, 2.07282, 0.0089, 0.00173, 0.0))
    right = camera("right", (1121.12572, 1125.23248), (328.41312, 266.00955), (-0.18696, 0.75452, 0.00292, 0.00774, 0))
    shift = np.array([-205.77721, 10.81310, 42.23043]) / 1000
    return left, right, Transform(rotation((0.08355, 0.29692, -0.00108)), shift)


def looking_at(centre_m: Sequence[float], target_m: Sequence[float], roll_deg: float = 0.0) -> Transform:
    """`right_T_left` of a right camera at `centre_m` that looks at `target_m`, both in the left frame."""
    z = np.subtract(target_m, centre_m)
    z = z / np.linalg.norm(z)
    x = np.cross((0.0, 1.0, 0.0), z)
    x /= np.linalg.norm(x)
    upright = np.stack([x, np.cross(z, x), z], axis=1)
    left_T_right = Transform(upright @ rotation((0, 0, np.deg2rad(roll_deg))), np.array(centre_m, np.float64))
    return left_T_right.inverse()


def _wide() -> StereoRig:
    D = (-0.27, 0.09, 0.0006, -0.0004, 0.0)
    left, right = camera("left", 640.0, (322.0, 237.0), D), camera("right", (652.0, 650.0), (316.5, 242.0), D)
    return StereoRig.from_extrinsics(left, right, Transform(np.eye(3), np.array([-0.12, 0.0, 0.0])))


def _hd() -> StereoRig:
    D, size = (-0.08, 0.05, 0.0004, -0.0007, 0.0), (1280, 720)
    left = camera("left", (1340.0, 1338.0), (644.0, 355.0), D, size_px=size)
    right = camera("right", (1352.0, 1351.0), (631.0, 364.0), D, size_px=size)
    return StereoRig.from_extrinsics(left, right, looking_at((0.2, 0.006, 0.01), (0.0, 0.0, 1.1), roll_deg=1.5))


BENCH_RIGS = {"thesis": StereoRig.from_extrinsics(*thesis_cameras()), "wide": _wide(), "hd": _hd()}
"""The thesis's verged rig, a parallel one with 120 mm baseline and wide distorted lenses, and a 1280 x 720 one."""

DISTANCES_M = {"thesis": (0.86, 0.96), "wide": (0.55, 0.65), "hd": (0.85, 1.0)}
"""Of the table's origin from the left camera."""


def table_before(rig: StereoRig, distance_m: float, elevation_deg: float, turn_deg: float = 0.0) -> Transform:
    """`left_T_table` of a table whose origin both cameras see equally far from their image centres.

    elevation_deg: of the left camera above the table, seen from the origin; turn_deg: of the table about its normal.
    """
    ray = np.array([0.0, 0.0, 1.0])
    for _ in range(5):
        left, right = rig.project(ray[None] * distance_m)
        off_centre = [
            (px[0] - (c.width_px / 2, c.height_px / 2)) / c.K[0, 0]
            for px, c in zip((left, right), (rig.left, rig.right))
        ]
        ray[:2] -= (off_centre[0] + off_centre[1]) / 2
    z = -ray / np.linalg.norm(ray)  # towards the camera
    across = np.cross((0.0, 1.0, 0.0), z)
    across /= np.linalg.norm(across)
    facing = np.stack([-across, np.cross(z, -across), z], axis=1)
    tilted = facing @ rotation((np.deg2rad(elevation_deg - 90), 0, 0)) @ rotation((0, 0, np.deg2rad(turn_deg)))
    return Transform(tilted, ray * distance_m / np.linalg.norm(ray))
