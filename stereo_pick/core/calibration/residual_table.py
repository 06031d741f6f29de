"""Residuals of each camera and axis (thesis table 3.2)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from stereo_pick.core.calibration.any_board import Board
from stereo_pick.core.calibration.refinement import StereoSolution


@dataclass(frozen=True)
class CameraResiduals:
    """Rms residuals of one camera's corners along x and y: in the image [px], and at the board's mean distance [m]."""

    x_px: float
    y_px: float
    x_m: float
    y_m: float
    distance_m: float


def residual_table(solution: StereoSolution, board: Board) -> tuple[CameraResiduals, CameraResiduals]:
    """The residuals of the left and the right camera."""
    left, right, right_T_left = solution.cameras
    centre = board.object_points().mean(axis=0)
    centres = np.array([pose.apply(centre) for pose in solution.poses])
    rows = list[CameraResiduals]()
    for side, (camera, xyz) in enumerate(((left, centres), (right, right_T_left.apply(centres)))):
        residuals_px = np.concatenate([view[side] for view in solution.residuals_px])
        x_px, y_px = np.sqrt(np.mean(residuals_px**2, axis=0)).tolist()
        distance_m = float(xyz[:, 2].mean())
        metres = distance_m / camera.K[0, 0], distance_m / camera.K[1, 1]
        rows.append(CameraResiduals(x_px, y_px, float(x_px * metres[0]), float(y_px * metres[1]), distance_m))
    return rows[0], rows[1]
