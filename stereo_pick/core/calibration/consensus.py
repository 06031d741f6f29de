"""Where the right camera stands, as most pairs have it: finds flipped boards and pairs that do not belong."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from stereo_pick.core.arrays import Floats, Ints
from stereo_pick.core.calibration.any_board import Board
from stereo_pick.core.calibration.mono import MonoCalibration
from stereo_pick.core.calibration.views import BoardView, RejectedCorner
from stereo_pick.core.camera import Camera
from stereo_pick.core.errors import CalibrationError
from stereo_pick.core.transform import Transform

_MAX_MEDIAN_GAP = 0.01  # of the image width
_MIN_GROSS_GAP = 0.005
_GROSS_TIMES_MEDIAN = 4.0


@dataclass(frozen=True)
class Consensus:
    """What most pairs agree on.

    views: the pairs, right corners in the left ones' order; gaps_px (V,): rms distance [px] of the
    right corners from where the left camera's board would be seen; gross (V,): the pair does not belong;
    turned (V, N): which of the board's corners in this order each of the detector's right corners is.
    """

    right_T_left: Transform
    views: tuple[BoardView, ...]
    gaps_px: Floats
    gross: tuple[bool, ...]
    turned: tuple[Ints, ...]

    def of_board(self, corners: Sequence[RejectedCorner]) -> list[RejectedCorner]:
        """Those corners that are of these views, with the numbers that the corners of these views have."""
        turned = {view.name: turned for view, turned in zip(self.views, self.turned)}
        of_these = [corner for corner in corners if corner.view in turned]
        return [
            replace(each, corner=int(turned[each.view][each.corner])) if each.side == "right" else each
            for each in of_these
        ]

    def as_found(self, views: Sequence[BoardView]) -> list[BoardView]:
        """These views with all the corners that were found in them; views: as they were found, and more of them."""
        found = {view.name: view for view in views}
        return [
            found[view.name].with_right(found[view.name].right_px, turned[found[view.name].seen[1]])
            for view, turned in zip(self.views, self.turned)
        ]


def agree(board: Board, views: Sequence[BoardView], left: MonoCalibration, right: MonoCalibration) -> Consensus:
    """Take each pair's own answer, in each order of its corners, and keep the one that suits most pairs.

    Raises CalibrationError where no answer suits them.
    """
    orders = board.orders()
    inverse = [np.argsort(order) for order in orders]
    choices = [[view.with_right(view.right_px, each[view.seen[1]]) for each in inverse] for view in views]
    answers = [
        pose @ board.turned(order) @ board_T_left
        for pose, board_T_left in zip(right.poses, (pose.inverse() for pose in left.poses))
        for order in orders
    ]
    gaps = [_gaps_px(answer, board, left.poses, right.camera, choices) for answer in answers]
    best = int(np.argmin([np.median(gap.min(axis=1)) for gap in gaps]))
    gaps_px = gaps[best].min(axis=1)
    median_px, width_px = float(np.median(gaps_px)), right.camera.width_px
    if not median_px <= _MAX_MEDIAN_GAP * width_px:
        raise CalibrationError(
            f"the pairs do not agree on where the cameras stand: {median_px:.1f} px apart at best; were left and right "
            "taken at the same moment, are they paired correctly, and did the cameras stay where they were?"
        )
    chosen = gaps[best].argmin(axis=1).tolist()
    return Consensus(
        answers[best],
        tuple(choice[k] for choice, k in zip(choices, chosen)),
        gaps_px,
        tuple(bool(gap > max(_MIN_GROSS_GAP * width_px, _GROSS_TIMES_MEDIAN * median_px)) for gap in gaps_px),
        tuple(inverse[k] for k in chosen),
    )


def _gaps_px(
    right_T_left: Transform, board: Board, poses: Sequence[Transform], right: Camera, choices: Sequence[list[BoardView]]
) -> Floats:
    """Rms distance (V, orders) [px] of the right corners from where the left camera's boards would be seen."""
    predicted = [[pose.apply(view.points(board)[1]) for view in choice] for pose, choice in zip(poses, choices)]
    points = [each for choice in predicted for each in choice]
    seen_px = [view.right_px for choice in choices for view in choice]
    counts = np.array([len(each) for each in points])
    with np.errstate(over="ignore"):  # a wrong answer may put points beside the camera
        gaps_px = np.concatenate(seen_px) - right.project(right_T_left.apply(np.concatenate(points)))
        sums = np.add.reduceat((gaps_px**2).sum(axis=1), np.cumsum(counts) - counts)
        return np.asarray(np.sqrt(sums / counts).reshape(len(choices), -1))
