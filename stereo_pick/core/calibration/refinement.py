"""Both cameras, where they stand and all board poses, refined together (bundle adjustment).

`cv2.stereoCalibrate` minimises the same sum, but where it ends depends on OpenCV's version: on one
real recording 4.6 ends at 0.537 px and 4.14, after the same 100 iterations, at 0.631 px and 13 mm
away. This one ends at the minimum, and its normal matrix says how sure the result is.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from stereo_pick.core.arrays import Floats, Ints, floats
from stereo_pick.core.calibration.any_board import Board
from stereo_pick.core.calibration.parameters import (
    COUNT,
    TRANSLATION,
    USUAL,
    DistortionModel,
    cameras_of,
    pose_vector,
    rig_vector,
    transform,
)
from stereo_pick.core.calibration.residuals import view_residuals
from stereo_pick.core.calibration.views import FINEST_PX, BoardView
from stereo_pick.core.camera import Camera
from stereo_pick.core.errors import CalibrationError
from stereo_pick.core.transform import Transform

Points = tuple[Floats, Floats]

_MAX_STEPS = 200
_MIN_DAMPING, _MAX_DAMPING = 1e-12, 1e10
_EPS = 1e-12


@dataclass(frozen=True, eq=False)
class StereoSolution:
    """Where the sum of the squared errors is least.

    model: the distortion coefficients estimated; parameters (24,) and covariance (24, 24) in the order of
    `parameters.NAMES`, those that are not estimated with zeros; poses: left_T_board of each view; residuals_px:
    projected minus seen, of each view's left (N, 2) and right corners (M, 2) [px];
    sigma_px: standard deviation [px] of a corner's coordinate, from the residuals.
    """

    model: DistortionModel
    size_px: tuple[int, int]
    parameters: Floats
    covariance: Floats
    poses: tuple[Transform, ...]
    residuals_px: tuple[tuple[Floats, Floats], ...]
    sigma_px: float

    def __post_init__(self) -> None:
        for name, shape in (("parameters", (COUNT,)), ("covariance", (COUNT, COUNT))):
            object.__setattr__(self, name, floats(name, getattr(self, name), *shape))
        residuals_px = tuple(
            (floats("residuals_px", left, None, 2), floats("residuals_px", right, None, 2))
            for left, right in self.residuals_px
        )
        object.__setattr__(self, "residuals_px", residuals_px)

    @property
    def cameras(self) -> tuple[Camera, Camera, Transform]:
        """Left, right (not rectified) and right_T_left [m]."""
        return cameras_of(self.parameters, self.size_px)

    @property
    def errors_px(self) -> Floats:
        """Rms distance (V, 2) [px] of each view's left and right corners."""
        squares = [[(side**2).sum(axis=1).mean() for side in view] for view in self.residuals_px]
        return np.asarray(np.sqrt(squares))

    @property
    def rms_px(self) -> float:
        """Rms distance [px] over all corners of both cameras."""
        return float(np.sqrt(2 * np.mean(self.coordinates_px**2)))

    @property
    def coordinates_px(self) -> Floats:
        """The residuals of all corners' coordinates (R,) [px], one after the other."""
        return np.concatenate([side.ravel() for view in self.residuals_px for side in view])

    def criterion(self, price: float) -> float:
        """An information criterion, the corners' noise taken from the residuals; the least is best.

        Two models of the same views differ by what the coefficients explain, less `price` for each of them.
        """
        residuals_px = self.coordinates_px
        variance = max(float(np.mean(residuals_px**2)), FINEST_PX**2)
        return float(residuals_px.size * np.log(variance) + 2 * self.model.coefficients * price)

    @property
    def baseline_sigma_m(self) -> float:
        """Standard deviation [m] of the distance between the cameras."""
        shift = self.parameters[TRANSLATION]
        along = shift / max(float(np.linalg.norm(shift)), 1e-12)
        return float(np.sqrt(along @ self.covariance[TRANSLATION, TRANSLATION] @ along))


@dataclass(frozen=True)
class _Linearised:
    """The sum of squares at some parameters, half its gradient and half its Hessian; each view's residuals [px]."""

    residuals_px: tuple[Floats, ...]
    gradient: Floats
    normal: Floats

    @property
    def cost(self) -> float:
        return float(sum(residuals @ residuals for residuals in self.residuals_px))

    @property
    def count(self) -> int:
        return sum(map(len, self.residuals_px))


def refine(
    board: Board,
    views: Sequence[BoardView],
    cameras: tuple[Camera, Camera, Transform],
    poses: Sequence[Transform],
    model: DistortionModel = USUAL,
) -> StereoSolution:
    """Refine left, right, right_T_left and the views' left_T_board together, beginning from those given.

    Raises CalibrationError where the views leave a parameter open.
    """
    points = [view.points(board) for view in views]
    shared = np.where(model.free, rig_vector(*cameras), 0.0)
    start = np.concatenate([shared, *map(pose_vector, poses)])
    free = np.flatnonzero(np.append(model.free, np.ones(len(start) - COUNT, np.bool_)))
    try:
        parameters, end = _minimise(start, free, points, views)
        inverse = np.linalg.inv(end.normal)
    except np.linalg.LinAlgError:
        raise _undetermined(views) from None
    if not (np.isfinite(inverse).all() and (np.diag(inverse) >= 0).all()):
        raise _undetermined(views)
    variance = end.cost / (end.count - len(free))
    estimated = np.flatnonzero(model.free)
    covariance = np.zeros((COUNT, COUNT))
    covariance[np.ix_(estimated, estimated)] = inverse[: len(estimated), : len(estimated)] * variance
    return StereoSolution(
        model,
        cameras[0].frame_size,
        parameters[:COUNT],
        covariance,
        tuple(transform(pose[:3], pose[3:]) for pose in parameters[COUNT:].reshape(-1, 6)),
        tuple(_by_side(residuals, view) for residuals, view in zip(end.residuals_px, views)),
        float(np.sqrt(variance)),
    )


def _by_side(residuals_px: Floats, view: BoardView) -> tuple[Floats, Floats]:
    corners_px = residuals_px.reshape(-1, 2)
    return corners_px[: len(view.left_px)], corners_px[len(view.left_px) :]


def _undetermined(views: Sequence[BoardView]) -> CalibrationError:
    return CalibrationError(
        f"the {len(views)} views do not determine the cameras: tilt the board to all sides by up to 45 degrees"
    )


def _minimise(
    parameters: Floats, free: Ints, points: Sequence[Points], views: Sequence[BoardView]
) -> tuple[Floats, _Linearised]:
    """Levenberg and Marquardt over the free ones: damped Gauss-Newton steps until the sum of squares stays."""
    here, damping = _linearise(parameters, free, points, views), 1e-3
    for _ in range(_MAX_STEPS):
        damped = here.normal + damping * np.diag(np.diag(here.normal))
        moved = parameters.copy()
        moved[free] -= np.linalg.solve(damped, here.gradient)
        there = _linearise(moved, free, points, views)
        gain = here.cost - there.cost
        if gain >= 0:
            parameters, here, damping = moved, there, max(damping / 10, _MIN_DAMPING)
            if gain <= _EPS * here.cost:
                break
        else:
            damping *= 10
            if damping > _MAX_DAMPING:
                break
    return parameters, here


def _linearise(parameters: Floats, free: Ints, points: Sequence[Points], views: Sequence[BoardView]) -> _Linearised:
    """Sum the views' normal equations; a view touches the shared parameters and its own pose only."""
    size = len(parameters)
    normal, gradient, all_px = np.zeros((size, size)), np.zeros(size), list[Floats]()
    shared = slice(COUNT)
    for i, view in enumerate(views):
        pose = slice(COUNT + 6 * i, COUNT + 6 * (i + 1))
        own = np.concatenate([parameters[shared], parameters[pose]])
        residuals_px, jacobian = view_residuals(own, points[i], view)
        products, by_residuals = jacobian.T @ jacobian, jacobian.T @ residuals_px
        normal[shared, shared] += products[:COUNT, :COUNT]
        normal[shared, pose], normal[pose, shared] = products[:COUNT, COUNT:], products[COUNT:, :COUNT]
        normal[pose, pose], gradient[pose] = products[COUNT:, COUNT:], by_residuals[COUNT:]
        gradient[shared] += by_residuals[:COUNT]
        all_px.append(residuals_px)
    return _Linearised(tuple(all_px), gradient[free], normal[np.ix_(free, free)])
