"""What a calibration found: the rig, the evidence for it, and how sure its numbers are."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from stereo_pick.core.arrays import Floats
from stereo_pick.core.calibration.any_board import Board
from stereo_pick.core.calibration.coverage import Coverage, coverage
from stereo_pick.core.calibration.held_out import HeldOut, cross_validate
from stereo_pick.core.calibration.refinement import StereoSolution
from stereo_pick.core.calibration.residual_table import CameraResiduals, residual_table
from stereo_pick.core.calibration.uncertainty import CalibrationUncertainty
from stereo_pick.core.calibration.views import BoardView, RejectedCorner, RejectedView
from stereo_pick.core.rig import StereoRig

FEW_VIEWS = 8


@dataclass(frozen=True)
class UsedView:
    """A stereo pair that was used, and the rms distances [px] of its corners in the result."""

    name: str
    left_px: float
    right_px: float


@dataclass(frozen=True)
class PointSigma:
    """Standard deviations [m] of a triangulated point at a depth [m], from the calibration alone; left frame."""

    depth_m: float
    x_m: float
    y_m: float
    z_m: float


@dataclass(frozen=True, eq=False)
class CalibrationResult:
    """A calibrated rig and how it came about.

    solution: the joint refinement of `views`, the pairs used, whose right corners are in the left ones' order;
    rms_left_px, rms_right_px: rms distance [px] of the corners with each camera calibrated alone;
    rejected_corners: what was left out of the pairs used; found: these pairs with all corners that were found.
    """

    rig: StereoRig
    board: Board
    solution: StereoSolution
    views: tuple[BoardView, ...]
    rms_left_px: float
    rms_right_px: float
    rejected: tuple[RejectedView, ...]
    rejected_corners: tuple[RejectedCorner, ...]
    found: tuple[BoardView, ...]
    detector: str

    @property
    def rms_px(self) -> float:
        """Rms distance [px] of all corners in one rig; much more than alone: the pairs do not fit together."""
        return self.solution.rms_px

    @property
    def baseline_sigma_m(self) -> float:
        """Standard deviation of the baseline [m] that the corners' scatter explains."""
        return self.solution.baseline_sigma_m

    @property
    def used(self) -> tuple[UsedView, ...]:
        """The pairs used and how well each fits."""
        errors_px = self.solution.errors_px.tolist()
        return tuple(UsedView(view.name, left, right) for view, (left, right) in zip(self.views, errors_px))

    @property
    def residuals(self) -> tuple[CameraResiduals, CameraResiduals]:
        """Residuals of the left and the right camera by axis (thesis table 3.2)."""
        return residual_table(self.solution, self.board)

    @property
    def uncertainty(self) -> CalibrationUncertainty:
        """How sure each number is, and what is triangulated with them."""
        return CalibrationUncertainty(self.solution.size_px, self.solution.parameters, self.solution.covariance)

    @cached_property
    def held_out(self) -> HeldOut | None:
        """Errors of views that took no part; None where there are too few to leave any out."""
        return cross_validate(self.board, self.views, self.solution)

    @property
    def coverage(self) -> Coverage:
        """Which part of the images and which tilts the views cover."""
        return coverage(self.views, self.solution, self._centre_m)

    @property
    def point_sigmas(self) -> tuple[PointSigma, ...]:
        """What the calibration leaves uncertain of a point, near, between and far, where the boards were seen."""
        centres = np.array([pose.apply(self._centre_m) for pose in self.solution.poses])
        near, far = centres[:, 2].min(), centres[:, 2].max()
        rows = list[PointSigma]()
        for depth_m in (near, (near + far) / 2, far):
            covariance = self.uncertainty.point_covariance(centres / centres[:, 2:] * depth_m)
            x, y, z = np.sqrt(np.diagonal(covariance, axis1=1, axis2=2).mean(axis=0)).tolist()
            rows.append(PointSigma(float(depth_m), x, y, z))
        return tuple(rows)

    @property
    def _centre_m(self) -> Floats:
        return np.asarray(self.board.object_points().mean(axis=0))

    @property
    def rotation_deg(self) -> float:
        """Angle [deg] between the two raw cameras."""
        cosine = (np.trace(self.rig.right_T_left.rotation) - 1) / 2
        return math.degrees(math.acos(float(np.clip(cosine, -1, 1))))

    @property
    def warnings(self) -> tuple[str, ...]:
        """What the user should know although the calibration holds."""
        if len(self.views) >= FEW_VIEWS:
            return ()
        return (
            f"only {len(self.views)} views: take {FEW_VIEWS} or more, tilted to all sides, for a result to rely on",
        )
