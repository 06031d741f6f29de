"""Simulated views of a board whose truth is known."""

from __future__ import annotations

import cv2
import numpy as np

from stereo_pick.core.calibration.boards import Chessboard
from stereo_pick.core.calibration.views import BoardView
from stereo_pick.core.camera import Camera
from stereo_pick.core.rig import StereoRig
from stereo_pick.core.transform import Transform

BOARD = Chessboard(8, 6, 0.025)
SIZE_PX = (640, 480)
USUAL_D = ((-0.27, 0.11, 0.001, -0.002, 0.0), (-0.25, 0.08, -0.001, 0.001, 0.0))


def rotation(*rvec: float) -> np.ndarray:
    return cv2.Rodrigues(np.array(rvec))[0]


def rig_with(left_D: tuple[float, ...], right_D: tuple[float, ...]) -> StereoRig:
    """A verged rig with these distortion coefficients."""
    eye, P = np.eye(3), np.eye(3, 4)
    left = Camera("left", *SIZE_PX, [[810, 0, 331], [0, 815, 236], [0, 0, 1]], left_D, eye, P)
    right = Camera("right", *SIZE_PX, [[795, 0, 312], [0, 799, 247], [0, 0, 1]], right_D, eye, P)
    return StereoRig.from_extrinsics(left, right, Transform(rotation(0.02, 0.2, -0.03), [-0.118, 0.003, 0.017]))


RIG = rig_with(*USUAL_D)


def make_views(count: int = 12, noise_px: float = 0.0, seed: int = 0, rig: StereoRig = RIG) -> list[BoardView]:
    """Views of a board held about 0.6 m away, tilted by up to 35 degrees."""
    rng = np.random.default_rng(seed)
    views = []
    for i in range(count):
        R = rotation(*rng.uniform(-0.6, 0.6, 2), rng.uniform(-0.3, 0.3))
        centre = np.array([0.0, 0.0, 0.6]) + rng.uniform(-1, 1, 3) * [0.06, 0.05, 0.12]
        points = (BOARD.object_points() - BOARD.object_points().mean(axis=0)) @ R.T + centre
        left_px, right_px = (
            pixels + rng.normal(0, noise_px, pixels.shape) if noise_px else pixels for pixels in rig.project(points)
        )
        views.append(BoardView(f"pair{i}", left_px, right_px))
    return views


def triangulated(rig: StereoRig, left_px: np.ndarray, right_px: np.ndarray) -> np.ndarray:
    """Least squares of where the two rays meet, by each camera's undistorted coordinates."""
    pose = rig.right_T_left
    points = []
    for (x, y), (u, v) in zip(rig.left.normalized(left_px), rig.right.normalized(right_px)):
        rays = np.c_[[x, y, 1], -pose.rotation.T @ [u, v, 1]]
        near, far = np.linalg.lstsq(rays, -pose.rotation.T @ pose.translation, rcond=None)[0]
        points.append((rays[:, 0] * near + pose.inverse().apply(far * np.array([u, v, 1]))) / 2)
    return np.array(points)
