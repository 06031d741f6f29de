"""Looking for a board in pairs that come one after the other, out of a recording or live."""

from __future__ import annotations

from dataclasses import dataclass, field

from stereo_pick.core.arrays import Image
from stereo_pick.core.calibration.any_board import Board
from stereo_pick.core.calibration.detection import BoardImages, check_size
from stereo_pick.core.calibration.detectors import board_view, may_show, seekers
from stereo_pick.core.calibration.selection import Candidate, Selection, sharpness
from stereo_pick.core.calibration.views import BoardView
from stereo_pick.core.errors import CalibrationError

_MIN_INTERVAL_NS = 100_000_000  # views closer in time are alike


@dataclass
class Pace:
    """Which pairs are worth a look by their time: those 0.1 s after the last one, or more."""

    _last_ns: int | None = None

    def takes(self, stamp_ns: int) -> bool:
        """Whether to look at the pair of this stamp; a stamp of long before begins anew."""
        if self._last_ns is not None and abs(stamp_ns - self._last_ns) < _MIN_INTERVAL_NS:
            return False
        self._last_ns = stamp_ns
        return True


@dataclass(eq=False)
class Collector:
    """Keeps, of the pairs that it is shown, the images of the views that are worth calibrating from.

    looked_at, shown: how many pairs it was shown, and how many of them showed the board in both images.
    """

    board: Board
    looked_at: int = 0
    shown: int = 0
    _first: BoardImages | None = None
    _selection: Selection = field(init=False)

    def __post_init__(self) -> None:
        self._selection = Selection(self.board)

    def look(self, pair: BoardImages) -> BoardView | None:
        """The board as this pair shows it, or None; raises CalibrationError on images of another size than those that
        showed it before."""
        check_size(pair, self._first or pair)
        self.looked_at += 1
        view = first_view(pair, self.board)
        if view is not None:
            self.shown += 1
            self._first = self._first or pair
            worse = min(sharpness(pair.left, view.left_px), sharpness(pair.right, view.right_px))
            self._selection.add(Candidate(self.looked_at, pair, view, worse))
        return view

    @property
    def views(self) -> tuple[BoardView, ...]:
        """What was kept so far."""
        return tuple(candidate.view for candidate in self._selection.chosen())

    def images(self) -> tuple[BoardImages, ...]:
        """The pairs to calibrate from; raises CalibrationError where none showed the board."""
        chosen = self._selection.chosen()
        if not chosen:
            raise CalibrationError(not_found(self.board, self.looked_at))
        return tuple(candidate.images for candidate in chosen)


def not_found(board: Board, pairs: int) -> str:
    """What to say where none of so many pairs showed the board."""
    return f"no {board.title} found in both images of any of {pairs} pairs: {board.advice}"


def timed_pair(time_s: float, left: Image, right: Image) -> BoardImages:
    """Grey images (H, W) that were taken `time_s` after the first ones, and are named by that."""
    at = f"at {time_s:.2f} s"
    return BoardImages(f"pair {at}", f"left {at}", f"right {at}", left, right)


def first_view(pair: BoardImages, board: Board) -> BoardView | None:
    """The board as the first detector sees it that finds it in both images."""
    if not (may_show(pair.left, board) and may_show(pair.right, board)):
        return None
    for find in seekers(board):
        left = find(pair.left)
        right = None if left is None else find(pair.right)
        if left is None or right is None:
            continue
        view = board_view(pair.name, left, right, board)
        if isinstance(view, BoardView):
            return view
    return None
