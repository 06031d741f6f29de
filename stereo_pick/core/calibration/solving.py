"""Stereo calibration from views of a board: two cameras, where they stand, and what to think of it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from stereo_pick.core.arrays import Floats
from stereo_pick.core.calibration.any_board import Board
from stereo_pick.core.calibration.consensus import Consensus, agree
from stereo_pick.core.calibration.mono import MonoCalibration, calibrate_cameras
from stereo_pick.core.calibration.refinement import StereoSolution, refine
from stereo_pick.core.calibration.views import (
    BoardView,
    Detections,
    RejectedView,
    check_enough,
    check_views,
    outlier_limit_px,
)
from stereo_pick.core.errors import CalibrationError
from stereo_pick.core.rig import MIN_BASELINE_M, StereoRig

FEW_VIEWS = 8
_MAX_RMS = 0.003  # of the image width
_MAX_BASELINE_SIGMA = 0.03  # of the baseline
_ZERO_SIGMAS, _ZERO_OF_DISTANCE = 5.0, 0.01  # a baseline below both is none


@dataclass(frozen=True)
class UsedView:
    """A stereo pair that was used, and the rms distances [px] of its corners in the result."""

    name: str
    left_px: float
    right_px: float


@dataclass(frozen=True)
class CalibrationResult:
    """A calibrated rig and how it came about.

    rms_left_px, rms_right_px: rms distance [px] of the corners with each camera calibrated alone;
    rms_px: of both together, as one rig; much more than alone means that the pairs do not fit together.
    baseline_sigma_m: standard deviation of the baseline [m] that the corners' scatter explains.
    """

    rig: StereoRig
    rms_left_px: float
    rms_right_px: float
    rms_px: float
    baseline_sigma_m: float
    used: tuple[UsedView, ...]
    rejected: tuple[RejectedView, ...]
    detector: str

    @property
    def rotation_deg(self) -> float:
        """Angle [deg] between the two raw cameras."""
        cosine = (np.trace(self.rig.right_T_left.rotation) - 1) / 2
        return math.degrees(math.acos(float(np.clip(cosine, -1, 1))))

    @property
    def warnings(self) -> tuple[str, ...]:
        """What the user should know although the calibration holds."""
        if len(self.used) >= FEW_VIEWS:
            return ()
        return (f"only {len(self.used)} views: take {FEW_VIEWS} or more, tilted to all sides, for a result to rely on",)


def calibrate(
    views: Sequence[BoardView],
    size_px: tuple[int, int],
    board: Board,
    detector: str = "given corners",
    rejected: Sequence[RejectedView] = (),
) -> CalibrationResult:
    """Calibrate a stereo rig; leaves out the views that do not belong, and says which and why.

    size_px: width and height of the raw images; rejected: pairs that were left out before, for the result.
    Raises CalibrationError where no rig can be trusted: fewer than three usable pairs, both images
    from one place, left and right swapped, pairs that do not belong together.
    """
    check_views(views, board)
    left, right, kept, rejected = calibrate_cameras(views, size_px, board, rejected)
    consensus = agree(board, kept, left, right)
    used, rejected = _without_gross(consensus, rejected)
    solution, used, rejected = _refine_without_outliers(board, consensus, used, rejected, left, right)
    _check(solution, left.only(used))
    errors = solution.errors_px
    return CalibrationResult(
        rig=StereoRig.from_extrinsics(solution.left, solution.right, solution.right_T_left),
        rms_left_px=_rms(left.errors_px[used]),
        rms_right_px=_rms(right.errors_px[used]),
        rms_px=_rms(errors),
        baseline_sigma_m=solution.baseline_sigma_m,
        used=tuple(
            UsedView(kept[i].name, float(left_px), float(right_px)) for i, (left_px, right_px) in zip(used, errors)
        ),
        rejected=tuple(rejected),
        detector=detector,
    )


def calibrate_best(recordings: Sequence[Detections], board: Board) -> CalibrationResult:
    """Calibrate from what each detector found in one recording, and keep the surest result.

    That is the one whose baseline has the least standard deviation, which weighs the rms per corner
    against the number of views used and what they say. Raises CalibrationError as `calibrate` does
    where no detector's corners give a rig; the error is that of the detector that found most.
    """
    results, failures = list[CalibrationResult](), list[tuple[int, CalibrationError]]()
    for found in recordings:
        try:
            results.append(calibrate(found.views, found.size_px, board, found.detector, found.rejected))
        except CalibrationError as error:
            failures.append((len(found.views), error))
    if not results:
        raise max(failures, key=lambda failure: failure[0])[1]
    return min(results, key=lambda result: result.baseline_sigma_m)


def _without_gross(consensus: Consensus, rejected: Sequence[RejectedView]) -> tuple[list[int], list[RejectedView]]:
    """Indices of the views that agree with most; the others join the rejected."""
    used, out = list[int](), list(rejected)
    for i, (view, gap_px, gross) in enumerate(zip(consensus.views, consensus.gaps_px, consensus.gross)):
        if gross:
            reason = (
                f"left and right show the board {gap_px:.1f} px apart, the other pairs by "
                f"{np.median(consensus.gaps_px):.2f} px: not taken at the same moment"
            )
            out.append(RejectedView(view.name, reason))
        else:
            used.append(i)
    return used, out


def _refine_without_outliers(
    board: Board,
    consensus: Consensus,
    used: list[int],
    rejected: Sequence[RejectedView],
    left: MonoCalibration,
    right: MonoCalibration,
) -> tuple[StereoSolution, list[int], list[RejectedView]]:
    """Refine, leaving out the worst view as long as it is an outlier."""
    used, out, out_px = list(used), list(rejected), list[float]()
    while True:
        check_enough([consensus.views[i] for i in used], out, board)
        views = [consensus.views[i] for i in used]
        solution = refine(board, views, left.only(used), right.only(used), consensus.right_T_left)
        errors = np.sqrt(np.mean(solution.errors_px**2, axis=1))
        worst = int(errors.argmax())
        if errors[worst] <= outlier_limit_px(errors, out_px):
            return solution, used, out
        reason = (
            f"left and right do not fit together: {errors[worst]:.2f} px, the other views {np.median(errors):.2f} px: "
            "not taken at the same moment, or blurred"
        )
        out.append(RejectedView(views[worst].name, reason))
        out_px.append(float(errors[worst]))
        del used[worst]


def _check(solution: StereoSolution, left: MonoCalibration) -> None:
    """Raise CalibrationError where the solution is no rig, however small its rms."""
    limit_px = _MAX_RMS * left.camera.width_px
    if not solution.rms_px <= limit_px:
        raise CalibrationError(
            f"stereo rms = {solution.rms_px:.2f} px is above {limit_px:.2f} px: the corners do not fit one rig; is the "
            "board flat, has it these numbers of inner corners, and were left and right taken at the same moment?"
        )
    baseline_m, sigma_m = float(np.linalg.norm(solution.right_T_left.translation)), solution.baseline_sigma_m
    value = f"baseline = {baseline_m * 1000:.2f} mm (standard deviation {sigma_m * 1000:.2f} mm)"
    distance_m = float(np.median([np.linalg.norm(pose.translation) for pose in left.poses]))
    unclear_m = min(_ZERO_SIGMAS * sigma_m, _ZERO_OF_DISTANCE * distance_m)
    if baseline_m < max(MIN_BASELINE_M, unclear_m):
        raise CalibrationError(
            f"{value} is zero although the stereo rms is {solution.rms_px:.2f} px: both cameras see from the same "
            "place; are the left and the right images from one camera? Record each from its own"
        )
    if sigma_m > _MAX_BASELINE_SIGMA * baseline_m:
        raise CalibrationError(
            f"{value} is too uncertain: the {len(left.poses)} views are too much alike; take more, with the board "
            "tilted to all sides by up to 45 degrees"
        )


def _rms(values: Floats) -> float:
    return float(np.sqrt(np.mean(values**2)))
