"""Both cameras, where they stand and all board poses, refined together (bundle adjustment).

`cv2.stereoCalibrate` minimises the same sum, but where it ends depends on OpenCV's version: on one
real recording 4.6 ends at 0.537 px and 4.14, after the same 100 iterations, at 0.631 px and 13 mm
away. This one ends at the minimum, and its normal matrix says how sure the result is.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np

from stereo_pick.core.arrays import Floats
from stereo_pick.core.calibration.any_board import Board
from stereo_pick.core.calibration.mono import MonoCalibration, transform
from stereo_pick.core.calibration.views import BoardView
from stereo_pick.core.camera import Camera
from stereo_pick.core.errors import CalibrationError
from stereo_pick.core.transform import Transform

# Parameters: fx fy cx cy k1 k2 p1 p2 of left and of right, rvec and tvec of right_T_left, of each left_T_board.
_LEFT, _RIGHT, _EXTRINSICS, _SHIFT, _FIRST_POSE = slice(0, 8), slice(8, 16), slice(16, 22), slice(19, 22), 22
_MAX_STEPS = 200
_MIN_DAMPING, _MAX_DAMPING = 1e-12, 1e10
_EPS = 1e-12


@dataclass(frozen=True)
class StereoSolution:
    """Cameras and `right_T_left` [m] where the sum of the squared errors is least.

    errors_px (V, 2): rms distance [px] of each view's left and right corners; baseline_sigma_m:
    standard deviation of the baseline [m] that the corners' scatter explains.
    """

    left: Camera
    right: Camera
    right_T_left: Transform
    errors_px: Floats
    baseline_sigma_m: float

    @property
    def rms_px(self) -> float:
        """Rms distance [px] in both cameras, over views of one weight each."""
        return float(np.sqrt(np.mean(self.errors_px**2)))


@dataclass(frozen=True)
class _Linearised:
    """The sum of squares at some parameters: errors (V, 2) [px], half its gradient and half its Hessian."""

    cost: float
    errors_px: Floats
    gradient: Floats
    normal: Floats


def refine(
    board: Board,
    views: Sequence[BoardView],
    left: MonoCalibration,
    right: MonoCalibration,
    right_T_left: Transform,
) -> StereoSolution:
    """Refine what each camera alone and `right_T_left` say of the views; `left.poses` belong to `views`.

    Raises CalibrationError where the views leave a parameter open.
    """
    points = [view.points(board) for view in views]
    start = [_intrinsics(left.camera), _intrinsics(right.camera), _vector(right_T_left), *map(_vector, left.poses)]
    undetermined = CalibrationError(
        f"the {len(views)} views do not determine the cameras: tilt the board to all sides by up to 45 degrees"
    )
    try:
        parameters, end = _minimise(np.concatenate(start), points, views)
        covariance = np.linalg.inv(end.normal)
    except np.linalg.LinAlgError:
        raise undetermined from None
    rvec, shift = parameters[_EXTRINSICS][:3], parameters[_SHIFT]
    freedom = 4 * sum(map(len, points)) - len(parameters)
    along = shift / max(float(np.linalg.norm(shift)), 1e-12)
    variance = end.cost / freedom * float(along @ covariance[_SHIFT, _SHIFT] @ along)
    if not variance >= 0:
        raise undetermined
    return StereoSolution(
        _camera(left.camera, parameters[_LEFT]),
        _camera(right.camera, parameters[_RIGHT]),
        transform(rvec, shift),
        end.errors_px,
        float(np.sqrt(variance)),
    )


def _minimise(parameters: Floats, points: Sequence[Floats], views: Sequence[BoardView]) -> tuple[Floats, _Linearised]:
    """Levenberg and Marquardt: damped Gauss-Newton steps until the sum of squares stays."""
    here, damping = _linearise(parameters, points, views), 1e-3
    for _ in range(_MAX_STEPS):
        damped = here.normal + damping * np.diag(np.diag(here.normal))
        step = np.linalg.solve(damped, -here.gradient)
        there = _linearise(parameters + step, points, views)
        gain = here.cost - there.cost
        if gain >= 0:
            parameters, here, damping = parameters + step, there, max(damping / 10, _MIN_DAMPING)
            if gain <= _EPS * here.cost:
                break
        else:
            damping *= 10
            if damping > _MAX_DAMPING:
                break
    return parameters, here


def _linearise(parameters: Floats, points: Sequence[Floats], views: Sequence[BoardView]) -> _Linearised:
    """Sum the views' normal equations; a view touches the shared parameters and its own pose only."""
    size = len(parameters)
    normal, gradient, errors = np.zeros((size, size)), np.zeros(size), np.zeros((len(views), 2))
    cost = 0.0
    for i, view in enumerate(views):
        own = np.r_[0:_FIRST_POSE, _FIRST_POSE + 6 * i : _FIRST_POSE + 6 * (i + 1)]
        residuals, jacobian = _view_residuals(parameters[own], points[i], view)
        normal[np.ix_(own, own)] += jacobian.T @ jacobian
        gradient[own] += jacobian.T @ residuals
        errors[i] = np.sqrt((residuals.reshape(2, -1) ** 2).sum(axis=1) / len(points[i]))
        cost += float(residuals @ residuals)
    return _Linearised(cost, errors, gradient, normal)


def _view_residuals(own: Floats, points: Floats, view: BoardView) -> tuple[Floats, Floats]:
    """Residuals (4 N,) [px], left before right, and their derivatives (4 N, 28) by the view's parameters."""
    pose = own[_FIRST_POSE:]
    composed = cv2.composeRT(pose[:3], pose[3:], own[16:19], own[_SHIFT])
    right_pose = np.concatenate(composed[:2]).ravel()
    by_pose = np.block([[composed[2], composed[3]], [composed[6], composed[7]]])
    by_extrinsics = np.block([[composed[4], composed[5]], [composed[8], composed[9]]])
    left_px, left_by_pose, left_by_camera = _project(points, pose, own[_LEFT])
    right_px, right_by_pose, right_by_camera = _project(points, right_pose, own[_RIGHT])
    zero8, zero6 = np.zeros_like(left_by_camera), np.zeros_like(left_by_pose)
    jacobian = np.block(
        [
            [left_by_camera, zero8, zero6, left_by_pose],
            [zero8, right_by_camera, right_by_pose @ by_extrinsics, right_by_pose @ by_pose],
        ]
    )
    return np.concatenate([left_px - view.left_px, right_px - view.right_px]).ravel(), jacobian


def _project(points: Floats, pose: Floats, intrinsics: Floats) -> tuple[Floats, Floats, Floats]:
    """Pixels (N, 2) and their derivatives by the pose (2 N, 6) and by the intrinsics (2 N, 8)."""
    pixels, jacobian = cv2.projectPoints(points, pose[:3], pose[3:], _matrix(intrinsics), intrinsics[4:])
    derivatives = np.asarray(jacobian, np.float64)
    return np.asarray(pixels, np.float64).reshape(-1, 2), derivatives[:, :6], derivatives[:, 6:]


def _vector(pose: Transform) -> Floats:
    return np.concatenate([cv2.Rodrigues(pose.rotation)[0].ravel(), pose.translation])


def _intrinsics(camera: Camera) -> Floats:
    return np.concatenate([camera.K[[0, 1, 0, 1], [0, 1, 2, 2]], camera.D[:4]])


def _matrix(intrinsics: Floats) -> Floats:
    fx, fy, cx, cy = intrinsics[:4]
    return np.array([[fx, 0, cx], [0, fy, cy], [0, 0, 1]])


def _camera(camera: Camera, intrinsics: Floats) -> Camera:
    D = np.append(intrinsics[4:], 0.0)
    return Camera(camera.name, camera.width_px, camera.height_px, _matrix(intrinsics), D, np.eye(3), np.eye(3, 4))
