"""How far a view's corners are from where the parameters put them, and how that changes with each parameter."""

from __future__ import annotations

import cv2
import numpy as np

from stereo_pick.core.arrays import Floats
from stereo_pick.core.calibration.parameters import COUNT, EXTRINSICS, LEFT, RIGHT, camera_matrix
from stereo_pick.core.calibration.views import BoardView


def view_residuals(own: Floats, points: Floats, view: BoardView) -> tuple[Floats, Floats]:
    """Residuals (4 N,) [px], left before right, and their derivatives (4 N, 30) by the view's parameters.

    own: the 24 shared parameters, then rvec and tvec of left_T_board; points: (N, 3) [m] in the board frame.
    """
    pose, extrinsics = own[COUNT:], own[EXTRINSICS]
    composed = cv2.composeRT(pose[:3], pose[3:], extrinsics[:3], extrinsics[3:])
    right_pose = np.concatenate(composed[:2]).ravel()
    by_pose, by_extrinsics = np.zeros((6, 6)), np.zeros((6, 6))
    by_pose[:3, :3], by_pose[:3, 3:], by_extrinsics[:3, :3], by_extrinsics[:3, 3:] = composed[2:6]
    by_pose[3:, :3], by_pose[3:, 3:], by_extrinsics[3:, :3], by_extrinsics[3:, 3:] = composed[6:]
    left_px, left_by_pose, left_by_camera = _project(points, pose, own[LEFT])
    right_px, right_by_pose, right_by_camera = _project(points, right_pose, own[RIGHT])
    half = 2 * len(points)
    jacobian = np.zeros((2 * half, COUNT + 6))
    jacobian[:half, LEFT], jacobian[:half, COUNT:] = left_by_camera, left_by_pose
    jacobian[half:, RIGHT], jacobian[half:, COUNT:] = right_by_camera, right_by_pose @ by_pose
    jacobian[half:, EXTRINSICS] = right_by_pose @ by_extrinsics
    return np.concatenate([left_px - view.left_px, right_px - view.right_px]).ravel(), jacobian


def _project(points: Floats, pose: Floats, camera: Floats) -> tuple[Floats, Floats, Floats]:
    """Pixels (N, 2) and their derivatives by the pose (2 N, 6) and by the camera's parameters (2 N, 9)."""
    pixels, jacobian = cv2.projectPoints(points, pose[:3], pose[3:], camera_matrix(camera), camera[4:])
    derivatives = np.asarray(jacobian, np.float64)
    return np.asarray(pixels, np.float64).reshape(-1, 2), derivatives[:, :6], derivatives[:, 6:]
