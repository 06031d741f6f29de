"""Stereo calibration from views of a board: two cameras, where they stand, and what to think of it."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from stereo_pick.core.arrays import Floats
from stereo_pick.core.calibration.any_board import Board
from stereo_pick.core.calibration.distortion import supported
from stereo_pick.core.calibration.held_out import check_in_common, typical_epipolar_px
from stereo_pick.core.calibration.mirrored import agree_unless_mirrored
from stereo_pick.core.calibration.mono import MonoCalibration, calibrate_cameras
from stereo_pick.core.calibration.outliers import refine_without_outliers, without_gross
from stereo_pick.core.calibration.parameters import TRANSLATION
from stereo_pick.core.calibration.refinement import StereoSolution, refine
from stereo_pick.core.calibration.result import CalibrationResult
from stereo_pick.core.calibration.views import BoardView, Detections, RejectedView, check_views
from stereo_pick.core.errors import CalibrationError
from stereo_pick.core.rig import MIN_BASELINE_M, StereoRig

_MAX_RMS = 0.003  # of the image width
_MAX_BASELINE_SIGMA = 0.03  # of the baseline
_ZERO_SIGMAS, _ZERO_OF_DISTANCE = 5.0, 0.01  # a baseline below both is none


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
    left, right, kept, rejected, corners = calibrate_cameras(views, size_px, board, rejected)
    consensus = agree_unless_mirrored(board, kept, left, right)
    found = consensus.as_found(views)
    used, rejected = without_gross(consensus, rejected)
    usual, used, rejected = refine_without_outliers(board, consensus, used, rejected, left, right)
    left, right, pairs = left.only(used), right.only(used), [consensus.views[i] for i in used]
    check_in_common(pairs, board)
    solution = supported(usual, lambda model: refine(board, pairs, usual.cameras, usual.poses, model))
    _check(solution, left)
    names = {view.name for view in pairs}
    return CalibrationResult(
        rig=StereoRig.from_extrinsics(*solution.cameras),
        board=board,
        solution=solution,
        views=tuple(pairs),
        rms_left_px=_rms(left.errors_px),
        rms_right_px=_rms(right.errors_px),
        rejected=tuple(rejected),
        rejected_corners=tuple(corner for corner in consensus.of_board(corners) if corner.view in names),
        found=tuple(found[i] for i in used),
        detector=detector,
    )


def calibrate_best(recordings: Sequence[Detections], board: Board) -> CalibrationResult:
    """Calibrate from what each detector found in one recording, and keep the surest result.

    That is the one whose corners the calibration predicts best in views that took no part, weighed by the number of
    views; a later detector must be better than those before it by what so many views can tell. Raises CalibrationError
    as `calibrate` does where no detector's corners give a rig; the error is that of the detector that found most.
    """
    results, failures = list[CalibrationResult](), list[tuple[int, CalibrationError]]()
    for found in recordings:
        try:
            results.append(calibrate(found.views, found.size_px, board, found.detector, found.rejected))
        except CalibrationError as error:
            failures.append((len(found.views), error))
    if not results:
        raise max(failures, key=lambda failure: failure[0])[1]
    best = results[0]
    for result in results[1:]:
        # An rms of V independent errors is sure to one part in the root of 2 V, and a view's errors are one error.
        if _unsureness_px(result) < (1 - 1 / math.sqrt(2 * len(result.views))) * _unsureness_px(best):
            best = result
    return best


def _unsureness_px(result: CalibrationResult) -> float:
    """What the errors of single views leave in the mean of them all [px].

    On all corners that were found: a detector is not better for corners that had to be left out.
    """
    error_px = typical_epipolar_px(result.board, result.views, result.solution, result.found)
    return (error_px or result.rms_px) / math.sqrt(len(result.views))


def _check(solution: StereoSolution, left: MonoCalibration) -> None:
    """Raise CalibrationError where the solution is no rig, however small its rms."""
    limit_px = _MAX_RMS * left.camera.width_px
    if not solution.rms_px <= limit_px:
        raise CalibrationError(
            f"stereo rms = {solution.rms_px:.2f} px is above {limit_px:.2f} px: the corners do not fit one rig; is the "
            "board flat, is it the one named, and were left and right taken at the same moment?"
        )
    baseline_m, sigma_m = float(np.linalg.norm(solution.parameters[TRANSLATION])), solution.baseline_sigma_m
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
