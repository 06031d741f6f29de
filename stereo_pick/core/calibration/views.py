"""Views of a board: the corners that both cameras found, and the pairs that were left out."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from stereo_pick.core.arrays import Floats, Ints, floats, frozen
from stereo_pick.core.calibration.any_board import Board
from stereo_pick.core.errors import ArrayError, CalibrationError

MIN_VIEWS = 3
_TIMES_MEDIAN = 3.0
_MIN_OUTLIER_PX = 0.1  # what a detector gets wrong on a good image; never an outlier


@dataclass(frozen=True)
class BoardView:
    """One stereo pair's corners: left_px and right_px (N, 2) [px] in the raw images.

    seen (N,): which of the board's corners these are, ascending; None: all, in the board's order.
    Raises ArrayError on another shape or values that are not finite.
    """

    name: str
    left_px: Floats
    right_px: Floats
    seen: Ints | None = None

    def __post_init__(self) -> None:
        count = None if self.seen is None else len(self.seen)
        for field in ("left_px", "right_px"):
            object.__setattr__(self, field, floats(f"{self.name}: {field}", getattr(self, field), count, 2))
        if self.seen is not None:
            object.__setattr__(self, "seen", ascending(f"{self.name}: seen", self.seen))

    def points(self, board: Board) -> Floats:
        """The seen corners (N, 3) [m] in the board frame."""
        points = board.object_points()
        return points if self.seen is None else points[self.seen]


def ascending(name: str, indices: Ints) -> Ints:
    """A read-only copy of the indices; raises ArrayError where they do not grow from 0 or more."""
    copy = np.array(indices, np.int64)
    if copy.ndim != 1 or (np.diff(copy, prepend=-1) <= 0).any():
        raise ArrayError(f"{name} = {copy.tolist()} must be ascending indices of corners")
    frozen(copy)
    return copy


@dataclass(frozen=True)
class RejectedView:
    """A stereo pair that was left out, and why."""

    name: str
    reason: str


@dataclass(frozen=True)
class Detections:
    """What one detector found in a recording of images of size_px (width, height)."""

    detector: str
    size_px: tuple[int, int]
    views: tuple[BoardView, ...]
    rejected: tuple[RejectedView, ...]


def check_views(views: Sequence[BoardView], board: Board) -> None:
    """Raise CalibrationError where a view has another number of corners than the board, or some that it has not."""
    for view in views:
        if view.seen is None:
            _check_all(view, board)
        elif board.needs_all_corners or (view.seen >= board.corner_count).any():
            raise CalibrationError(f"{view.name}: corners {view.seen.tolist()} are no part of a {board} board")


def _check_all(view: BoardView, board: Board) -> None:
    for side, corners in (("left", view.left_px), ("right", view.right_px)):
        if len(corners) != board.corner_count:
            raise CalibrationError(
                f"{view.name}: {len(corners)} corners in the {side} image, but a {board} board has {board.corner_count}"
            )


def check_enough(views: Sequence[BoardView], rejected: Sequence[RejectedView], board: Board) -> None:
    """Raise CalibrationError, saying what became of the others, where fewer than MIN_VIEWS pairs are left."""
    if len(views) >= MIN_VIEWS:
        return
    reasons = "; ".join(f"{view.name}: {view.reason}" for view in rejected[:5])
    more = f"; and {len(rejected) - 5} more" if len(rejected) > 5 else ""
    shown = "the whole board" if board.needs_all_corners else "the board"
    raise CalibrationError(
        f"{len(views)} usable pairs of the {board} board are too few: at least {MIN_VIEWS} are needed, 15 are good; "
        f"take more pairs with {shown} in both images{f' ({reasons}{more})' if reasons else ''}"
    )


def outlier_limit_px(errors_px: Floats, rejected_px: Sequence[float]) -> float:
    """The error [px] above which a view does not belong to the others: three times the median.

    Views rejected before stay in the median: it would sink with each, and reject ever better views.
    """
    return max(_TIMES_MEDIAN * float(np.median([*errors_px, *rejected_px])), _MIN_OUTLIER_PX)
