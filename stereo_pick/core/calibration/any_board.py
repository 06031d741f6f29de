"""The boards there are, and the reading of their names.

What they have in common: `square_m` [m], the `grid` of the corners, their `corner_count` and `object_points()` (N, 3)
[m], the `orders()` in which a detector may list the corners with the turn of the board `turned(order)` that belongs to
each, whether a view `needs_all_corners`, and for messages `str()`, `title` and `advice`.
"""

from __future__ import annotations

from typing import TypeAlias

from stereo_pick.core.calibration.boards import Chessboard
from stereo_pick.core.calibration.charuco import CharucoBoard
from stereo_pick.core.errors import ParameterError

Board: TypeAlias = "Chessboard | CharucoBoard"


def parse_board(text: str, square_m: float) -> Board:
    """Read "chessboard:9x6", "9x6" (inner corners) or "charuco:11x8:0.75:5X5_100" (squares, marker, dictionary).

    square_m: side of one square [m]. Raises ParameterError, showing the right form, on any other text.
    """
    kind = text.partition(":")[0].strip().lower() if ":" in text else "chessboard"
    if kind == "charuco":
        return CharucoBoard.parse(text, square_m)
    if kind == "chessboard":
        return Chessboard.parse(text, square_m)
    raise ParameterError(
        f"board {text!r} is not understood: there are chessboard:9x6 (inner corners) "
        "and charuco:11x8:0.75:5X5_100 (squares, marker side in squares, dictionary)"
    )
