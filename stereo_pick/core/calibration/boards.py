"""Calibration boards: what is known of them before any image is taken."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from stereo_pick.core.arrays import Floats, Ints, frozen
from stereo_pick.core.errors import ParameterError
from stereo_pick.core.transform import Transform

_TEXT = re.compile(r"(?:chessboard\s*:)?\s*(\d+)\s*[x×*]\s*(\d+)\s*", re.IGNORECASE)


def check_square(square_m: float) -> None:
    """Raise ParameterError where no board has squares of this side [m]."""
    check_metres("square", square_m, 1.0, "measure the side of one square")


def check_metres(name: str, length_m: float, largest_m: float, remedy: str) -> None:
    """Raise ParameterError for a length that was measured by hand and is none, or is one in millimetres."""
    if not (math.isfinite(length_m) and length_m > 0):
        raise ParameterError(f"{name} = {length_m:g} m must be positive: {remedy}")
    if length_m > largest_m:
        raise ParameterError(
            f"{name} = {length_m:g} m is larger than {largest_m:g} m, so it is probably in millimetres: "
            f"give metres, {length_m / 1000:g}"
        )


@lru_cache(maxsize=64)  # a calibration asks for those of its board thousands of times
def grid_points(columns: int, rows: int, spacing_m: float) -> Floats:
    """Points (columns * rows, 3) [m] of a grid, row by row, the first in the origin; read-only."""
    y, x = np.mgrid[:rows, :columns]
    return frozen(np.asarray(np.c_[x.ravel(), y.ravel(), np.zeros(columns * rows)] * spacing_m, np.float64))


@dataclass(frozen=True)
class Chessboard:
    """A chessboard of `columns` by `rows` INNER corners (where four squares meet) and `square_m` [m] a square.

    Board frame: origin in the first corner, x along a row, y down the columns, z into the board.
    Raises ParameterError where the numbers are no chessboard's.
    """

    columns: int
    rows: int
    square_m: float

    def __post_init__(self) -> None:
        if min(self.columns, self.rows) < 3:
            raise ParameterError(
                f"a board of {self.columns}x{self.rows} inner corners is too small: at least 3x3 are needed "
                "(a corner is where four squares meet; the board's rim has none)"
            )
        check_square(self.square_m)

    def __str__(self) -> str:
        return f"{self.columns}x{self.rows}"

    @staticmethod
    def parse(text: str, square_m: float) -> Chessboard:
        """Read "9x6" or "chessboard:9x6": inner corners along a row and down a column.

        Raises ParameterError on any other text.
        """
        match = _TEXT.fullmatch(text.strip())
        if match is None:
            raise ParameterError(
                f"board {text!r} is not understood: write the numbers of inner corners like 9x6 or chessboard:9x6"
            )
        return Chessboard(int(match[1]), int(match[2]), square_m)

    @property
    def title(self) -> str:
        """What messages call this board."""
        return f"chessboard of {self} inner corners"

    @property
    def advice(self) -> str:
        """What to do where it is not found."""
        return "count the corners where four squares meet, and show the whole board, near enough and lit evenly"

    @property
    def needs_all_corners(self) -> bool:
        """True: nothing tells the corners of a part of a chessboard apart."""
        return True

    @property
    def grid(self) -> tuple[int, int]:
        """How many inner corners are in a row, and in a column."""
        return self.columns, self.rows

    @property
    def corner_count(self) -> int:
        """Number of inner corners."""
        return self.columns * self.rows

    def object_points(self) -> Floats:
        """The corners (N, 3) [m] in the board frame, row by row."""
        return grid_points(self.columns, self.rows, self.square_m)

    def orders(self) -> tuple[Ints, ...]:
        """The orders (N,) in which a detector may list the corners of one view; the first is 0, 1, 2, ...

        Turned by half, a board looks the same (its colours too, where columns + rows is even);
        turned by a quarter, a square one.
        """
        grid = np.arange(self.corner_count).reshape(self.rows, self.columns)
        turns = range(4) if self.rows == self.columns else (0, 2)
        return tuple(np.rot90(grid, turn).ravel().astype(np.int64) for turn in turns)

    def turned(self, order: Ints) -> Transform:
        """The turn of the board onto itself that takes object point i to object point `order[i]`."""
        points = self.object_points()[order]
        x = (points[1] - points[0]) / self.square_m
        y = (points[self.columns] - points[0]) / self.square_m
        return Transform(np.c_[x, y, np.cross(x, y)], points[0])
