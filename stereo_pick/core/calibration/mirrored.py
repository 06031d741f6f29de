"""An image that its driver or a glass mirrors: each camera alone calibrates well, the two together never."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from stereo_pick.core.calibration.any_board import Board
from stereo_pick.core.calibration.boards import Chessboard
from stereo_pick.core.calibration.consensus import Consensus, agree
from stereo_pick.core.calibration.mono import MonoCalibration, calibrate_camera
from stereo_pick.core.calibration.views import BoardView
from stereo_pick.core.errors import CalibrationError


def agree_unless_mirrored(
    board: Board, views: Sequence[BoardView], left: MonoCalibration, right: MonoCalibration
) -> Consensus:
    """What most pairs agree on; raises CalibrationError, naming a mirrored image where they agree without it.

    A ChArUco board is not found in a mirrored image: its markers are others.
    """
    try:
        return agree(board, views, left, right)
    except CalibrationError:
        if isinstance(board, Chessboard) and _agree_mirrored(board, views, left):
            raise CalibrationError(
                "one of the two images is mirrored: the pairs agree on where the cameras stand only when the right one "
                "is flipped; switch the flip off in that camera's driver, or do not look through a glass"
            ) from None
        raise


def _agree_mirrored(board: Chessboard, views: Sequence[BoardView], left: MonoCalibration) -> bool:
    size_px = left.camera.frame_size
    flipped = [_flipped(view, size_px[0], board) for view in views]
    try:
        points = [view.points(board)[1] for view in flipped]
        right = calibrate_camera("right", [view.right_px for view in flipped], size_px, points)
        agree(board, flipped, left, right)
    except CalibrationError:
        return False
    return True


def _flipped(view: BoardView, width_px: int, board: Chessboard) -> BoardView:
    """The view with its right image flipped left to right, each row in the order that a detector would list there."""
    rows, columns = np.divmod(view.seen[1], board.columns)
    flipped_px = view.right_px * [-1, 1] + [width_px - 1, 0]
    return view.with_right(flipped_px, (rows + 1) * board.columns - 1 - columns)
