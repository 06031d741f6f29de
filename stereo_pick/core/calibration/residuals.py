"""How far a view's corners are from where the parameters put them, and how that changes with each parameter."""

from __future__ import annotations

import cv2
import numpy as np

from stereo_pick.core.arrays import Floats
from stereo_pick.core.calibration.parameters import COUNT, EXTRINSICS, LEFT, RIGHT, camera_matrix
from stereo_pick.core.calibration.views import BoardView


def view_residuals(own: Floats, points: tuple[Floats, Floats], view: BoardView) -> tuple[Floats, Floats]:
    """Residuals (2 N + 2 M,) [px], left before right, and their derivatives (2 N + 2 M, 30) by the view's parameters.

    own: the 24 shared parameters, then rvec and tvec of left_T_board; points: what the left image shows (N, 3) and
    what the right one shows (M, 3) [m] in the board frame.
    """
    pose, extrinsics = own[COUNT:], own[EXTRINSICS]
    composed = cv2.composeRT(pose[:3], pose[3:], extrinsics[:3], extrinsics[3:])
    right_pose = np.concatenate(composed[:2]).ravel()
    by_pose, by_extrinsics = np.zeros((6, 6)), np.zeros((6, 6))
    by_pose[:3, :3], by_pose[:3, 3:], by_extrinsics[:3, :3], by_extrinsics[:3, 3:] = composed[2:6]
    by_pose[3:, :3], by_pose[3:, 3:], by_extrinsics[3:, :3], by_extrinsics[3:, 3:] = composed[6:]
    left_px, left_by_pose, left_by_camera = _project(points[0], pose, own[LEFT])
    right_px, right_by_pose, right_by_camera = _project(points[1], right_pose, own[RIGHT])
    of_left = 2 * len(points[0])
    jacobian = np.zeros((of_left + 2 * len(points[1]), COUNT + 6))
    jacobian[:of_left, LEFT], jacobian[:of_left, COUNT:] = left_by_camera, left_by_pose
    jacobian[of_left:, RIGHT], jacobian[of_left:, COUNT:] = right_by_camera, right_by_pose @ by_pose
    jacobian[of_left:, EXTRINSICS] = right_by_pose @ by_extrinsics
    return np.concatenate([left_px - view.left_px, right_px - view.right_px]).ravel(), jacobian


def _project(points: Floats, pose: Floats, camera: Floats) -> tuple[Floats, Floats, Floats]:
    """Pixels (N, 2) and their derivatives by the pose (2 N, 6) and by the camera's parameters (2 N, 9)."""
    pixels, jacobian = cv2.projectPoints(points, pose[:3], pose[3:], camera_matrix(camera), camera[4:])
    derivatives = np.asarray(jacobian, np.float64)
    return np.asarray(pixels, np.float64).reshape(-1, 2), derivatives[:, :6], derivatives[:, 6:]
