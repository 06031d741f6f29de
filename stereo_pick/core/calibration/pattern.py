"""What is black on a calibration board."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import groupby

import numpy as np

from stereo_pick.core.arrays import Floats
from stereo_pick.core.calibration.any_board import Board
from stereo_pick.core.calibration.aruco import marker_is_black
from stereo_pick.core.calibration.boards import Chessboard
from stereo_pick.core.calibration.charuco import CharucoBoard

Rectangle = tuple[float, float, float, float]


def size_squares(board: Board) -> tuple[int, int]:
    """How many squares the board has along a row and down a column; a chessboard is named by its inner corners."""
    return (board.columns + 1, board.rows + 1) if isinstance(board, Chessboard) else (board.columns, board.rows)


def black_rectangles(board: Board) -> Floats:
    """The board's black parts (N, 4): x, y, width, height in squares from its upper left corner, y down.

    Raises CalibrationError for a ChArUco board where OpenCV has no aruco module.
    """
    columns, rows = size_squares(board)
    cells = [(x, y) for y in range(rows) for x in range(columns)]
    rectangles: list[Rectangle] = [(x, y, 1, 1) for x, y in cells if (x + y) % 2 == 0]
    if isinstance(board, CharucoBoard):
        white = [(x, y) for x, y in cells if (x + y) % 2]
        for marker_id, (x, y) in enumerate(white):
            rectangles.extend(_marker(board, marker_id, x, y))
    return np.array(rectangles, np.float64)


def _marker(board: CharucoBoard, marker_id: int, x: int, y: int) -> Iterator[Rectangle]:
    """A marker's black cells in the middle of the square at x, y; neighbours in a row become one."""
    black = marker_is_black(board, marker_id)
    side, gap = board.marker_ratio / len(black), (1 - board.marker_ratio) / 2
    for row, cells in enumerate(black):
        for is_black, run in groupby(range(len(cells)), key=lambda column: bool(cells[column])):
            if is_black:
                columns = list(run)
                yield x + gap + columns[0] * side, y + gap + row * side, len(columns) * side, side
