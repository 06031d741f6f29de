"""Rigs for the tests: the thesis's own, typical ones and random ones."""

from __future__ import annotations

from collections.abc import Sequence

import cv2
import numpy as np
from hypothesis import strategies as st

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


def _typical(right_T_left: Transform) -> StereoRig:
    D = (-0.15, 0.08, 0.001, -0.0005, 0.0)
    return StereoRig.from_extrinsics(
        camera("left", 880.0, (321.0, 236.0), D), camera("right", (905.0, 900.0), (315.0, 243.0), D), right_T_left
    )


def typical_rigs() -> dict[str, StereoRig]:
    """One rig of every kind that users build; all see what lies 0.9 m before the left camera."""
    aim = (0.0, 0.0, 0.9)
    return {
        "parallel": _typical(Transform(np.eye(3), np.array([-0.08, 0, 0]))),
        "verged": _typical(looking_at((0.28, 0.0, 0.0), aim)),  # by 17 degrees
        "rolled": _typical(looking_at((0.15, 0.01, -0.02), aim, roll_deg=10)),
        "vertical": _typical(looking_at((0.0, -0.2, 0.0), aim)),
        "thesis": StereoRig.from_extrinsics(*thesis_cameras()),
    }


RIGS = typical_rigs()


@st.composite
def random_rigs(draw: st.DrawFn, distorted: bool = True) -> StereoRig:
    """Rigs of 5 to 40 cm baseline, to the side or up to 45 degrees above or below, that look at a point before them."""
    focal_px = draw(st.floats(600, 1300))
    direction = np.deg2rad(draw(st.floats(-45, 45)))
    baseline_m = draw(st.floats(0.05, 0.4))
    centre = baseline_m * np.array([np.cos(direction), np.sin(direction), draw(st.floats(-0.2, 0.2))])
    target = (draw(st.floats(-0.1, 0.1)), draw(st.floats(-0.1, 0.1)), draw(st.floats(0.8, 4.0)))
    D = (draw(st.floats(-0.25, 0.1)), draw(st.floats(0, 0.05)), 0.001, -0.001, 0.0) if distorted else (0.0,) * 5
    left, right = camera("left", focal_px, (310.0, 245.0), D), camera("right", focal_px * 1.02, D=D)
    return StereoRig.from_extrinsics(left, right, looking_at(centre, target, draw(st.floats(-10, 10))))
