"""ChArUco boards: chessboards whose white squares hold markers, so that every corner has a name."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass

import numpy as np

from stereo_pick.core.arrays import Floats, Ints
from stereo_pick.core.calibration.boards import check_square, grid_points
from stereo_pick.core.errors import ParameterError
from stereo_pick.core.transform import Transform

# Dictionary -> how many markers it has; OpenCV's names without DICT_.
DICTIONARIES = {f"{bits}X{bits}_{count}": count for bits in (4, 5, 6, 7) for count in (50, 100, 250, 1000)} | {
    "ARUCO_ORIGINAL": 1024,
    "APRILTAG_16h5": 30,
    "APRILTAG_25h9": 35,
    "APRILTAG_36h10": 2320,
    "APRILTAG_36h11": 587,
}
_BY_UPPER_CASE = {name.upper(): name for name in DICTIONARIES}
_TEXT = re.compile(
    r"charuco\s*:\s*(\d+)\s*[x×*]\s*(\d+)\s*:\s*(\d*\.?\d+)\s*(mm)?\s*:\s*(?:DICT_)?(\w+)\s*", re.IGNORECASE
)
_FORM = (
    "write charuco:11x8:0.75:5X5_100, that is the numbers of squares, the side of a marker "
    "(in squares, or like 22mm) and the dictionary of the markers"
)
_MIN_RATIO, _MAX_RATIO = 0.3, 0.95
_MIN_CORNERS = 6


@dataclass(frozen=True)
class CharucoBoard:
    """A ChArUco board of `columns` by `rows` SQUARES of `square_m` [m], as OpenCV counts them.

    marker_ratio: side of a marker in squares; dictionary: OpenCV's name without DICT_. The upper
    left square is black. Board frame: origin in the first inner corner, x along a row, y down the
    columns, z into the board. Raises ParameterError where the numbers are no board's.
    """

    columns: int
    rows: int
    square_m: float
    marker_ratio: float
    dictionary: str

    def __post_init__(self) -> None:
        check_square(self.square_m)
        if min(self.columns, self.rows) < 3 or self.corner_count < _MIN_CORNERS:
            raise ParameterError(
                f"a ChArUco board of {self.columns}x{self.rows} squares is too small: at least 4x3 are needed"
            )
        if not (math.isfinite(self.marker_ratio) and _MIN_RATIO <= self.marker_ratio <= _MAX_RATIO):
            raise ParameterError(
                f"a marker's side of {self.marker_ratio:g} squares is outside {_MIN_RATIO:g} .. {_MAX_RATIO:g}: "
                "give it in squares like 0.75, or with its unit like 22mm"
            )
        self._check_dictionary()

    def _check_dictionary(self) -> None:
        count = DICTIONARIES.get(self.dictionary)
        if count is None:
            raise ParameterError(f"there is no dictionary {self.dictionary!r}: choose from {', '.join(DICTIONARIES)}")
        if self.marker_count > count:
            raise ParameterError(
                f"a board of {self.columns}x{self.rows} squares holds {self.marker_count} markers, but the dictionary "
                f"{self.dictionary} has {count}: take a larger one"
            )

    def __str__(self) -> str:
        return f"charuco:{self.columns}x{self.rows}:{self.marker_ratio:g}:{self.dictionary}"

    @staticmethod
    def parse(text: str, square_m: float) -> CharucoBoard:
        """Read "charuco:11x8:0.75:5X5_100" or "charuco:11x8:22mm:DICT_5X5_100".

        Raises ParameterError, showing the right form, on any other text.
        """
        match = _TEXT.fullmatch(text.strip())
        if match is None:
            raise ParameterError(f"board {text!r} is not understood: {_FORM}")
        check_square(square_m)
        side = float(match[3])
        ratio = side / 1000 / square_m if match[4] else side
        name = _BY_UPPER_CASE.get(match[5].upper(), match[5])
        return CharucoBoard(int(match[1]), int(match[2]), square_m, ratio, name)

    @property
    def title(self) -> str:
        """What messages call this board."""
        return (
            f"ChArUco board of {self.columns}x{self.rows} squares "
            f"(markers of {self.marker_ratio:g} squares from {self.dictionary})"
        )

    @property
    def advice(self) -> str:
        """What to do where it is not found."""
        return "count the squares, name the dictionary that the markers are from, and show a good part of the board"

    @property
    def needs_all_corners(self) -> bool:
        """False: the markers tell which corners are seen."""
        return False

    @property
    def grid(self) -> tuple[int, int]:
        """How many inner corners are in a row, and in a column."""
        return self.columns - 1, self.rows - 1

    @property
    def corner_count(self) -> int:
        """Number of inner corners."""
        return (self.columns - 1) * (self.rows - 1)

    @property
    def marker_count(self) -> int:
        """Number of white squares, each with a marker."""
        return self.columns * self.rows // 2

    def object_points(self) -> Floats:
        """The corners (N, 3) [m] in the board frame, row by row: in the order of OpenCV's corner ids."""
        return grid_points(self.columns - 1, self.rows - 1, self.square_m)

    def orders(self) -> tuple[Ints, ...]:
        """The one order (N,) of the corners: the markers leave no doubt."""
        return (np.arange(self.corner_count, dtype=np.int64),)

    def turned(self, order: Ints) -> Transform:
        """The turn of the board that belongs to its one order: none."""
        return Transform.identity()

    def spans_plane(self, seen: Ints) -> bool:
        """Whether these corners (N,) determine a pose: at least six, not all but one on one line."""
        rows, columns = np.divmod(seen, self.columns - 1)
        lines = (np.bincount(rows, minlength=1), np.bincount(columns, minlength=1))
        return len(seen) >= _MIN_CORNERS and any(int((counts >= 2).sum()) >= 2 for counts in lines)
