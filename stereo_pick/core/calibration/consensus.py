"""Where the right camera stands, as most pairs have it: finds flipped boards and pairs that do not belong."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from stereo_pick.core.arrays import Floats, Ints
from stereo_pick.core.calibration.any_board import Board
from stereo_pick.core.calibration.mono import MonoCalibration
from stereo_pick.core.calibration.views import BoardView
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
    right corners from where the left camera's board would be seen; gross (V,): the pair does not belong.
    """

    right_T_left: Transform
    views: tuple[BoardView, ...]
    gaps_px: Floats
    gross: tuple[bool, ...]


def agree(board: Board, views: Sequence[BoardView], left: MonoCalibration, right: MonoCalibration) -> Consensus:
    """Take each pair's own answer, in each order of its corners, and keep the one that suits most pairs.

    Raises CalibrationError where no answer suits them.
    """
    orders = board.orders()
    points = [pose.apply(view.points(board)[1]) for pose, view in zip(left.poses, views)]
    seen = [np.array([_ordered(view, order).right_px for order in orders]) for view in views]
    answers = [
        pose @ board.turned(order) @ board_T_left
        for pose, board_T_left in zip(right.poses, (pose.inverse() for pose in left.poses))
        for order in orders
    ]
    gaps = [_gaps_px(answer, points, right.camera, seen) for answer in answers]
    best = int(np.argmin([np.median(gap.min(axis=1)) for gap in gaps]))
    gaps_px = gaps[best].min(axis=1)
    median_px, width_px = float(np.median(gaps_px)), right.camera.width_px
    if not median_px <= _MAX_MEDIAN_GAP * width_px:
        raise CalibrationError(
            f"the pairs do not agree on where the cameras stand: {median_px:.1f} px apart at best; were left and right "
            "taken at the same moment, are they paired correctly, and did the cameras stay where they were?"
        )
    matched = zip(views, gaps[best].argmin(axis=1))
    return Consensus(
        answers[best],
        tuple(_ordered(view, orders[k]) for view, k in matched),
        gaps_px,
        tuple(bool(gap > max(_MIN_GROSS_GAP * width_px, _GROSS_TIMES_MEDIAN * median_px)) for gap in gaps_px),
    )


def _ordered(view: BoardView, order: Ints) -> BoardView:
    """The view with its right corners in another order; a board of which parts may be seen has one order only."""
    return view if view.right_seen is not None else BoardView(view.name, view.left_px, view.right_px[order])


def _gaps_px(right_T_left: Transform, points: Sequence[Floats], right: Camera, seen: Sequence[Floats]) -> Floats:
    """Rms distance (V, orders) [px] of the seen right corners from the projections of the left camera's points (N, 3).

    seen: each view's right corners (orders, N, 2) [px].
    """
    counts = np.array([len(each) for each in points])
    with np.errstate(over="ignore"):  # a wrong answer may put points beside the camera
        predicted = right.project(right_T_left.apply(np.concatenate(points)))
        squares = ((np.concatenate(seen, axis=1) - predicted) ** 2).sum(axis=2)
        sums = np.add.reduceat(squares, np.cumsum(counts) - counts, axis=1)
        return np.asarray(np.sqrt(sums / counts).T)
