"""The pairs that do not belong to the others, found one by one and named."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from stereo_pick.core.calibration.any_board import Board
from stereo_pick.core.calibration.consensus import Consensus
from stereo_pick.core.calibration.mono import MonoCalibration
from stereo_pick.core.calibration.refinement import StereoSolution, refine
from stereo_pick.core.calibration.views import RejectedView, check_enough, outlier_limit_px


def without_gross(consensus: Consensus, rejected: Sequence[RejectedView]) -> tuple[list[int], list[RejectedView]]:
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


def refine_without_outliers(
    board: Board,
    consensus: Consensus,
    used: list[int],
    rejected: Sequence[RejectedView],
    left: MonoCalibration,
    right: MonoCalibration,
) -> tuple[StereoSolution, list[int], list[RejectedView]]:
    """Refine, leaving out the worst view as long as it is an outlier."""
    used, out, out_px = list(used), list(rejected), list[float]()
    cameras = left.camera, right.camera, consensus.right_T_left
    while True:
        check_enough([consensus.views[i] for i in used], out, board)
        views = [consensus.views[i] for i in used]
        solution = refine(board, views, cameras, [left.poses[i] for i in used])
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
