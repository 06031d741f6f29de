"""Views of a board: the corners that both cameras found, and the pairs that were left out."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from stereo_pick.core.arrays import Bools, Floats, Ints, floats, frozen
from stereo_pick.core.calibration.any_board import Board
from stereo_pick.core.errors import ArrayError, CalibrationError

MIN_VIEWS = 3
FINEST_PX = 1e-3  # no corner is found better
MAD_TO_SIGMA = 1.4826  # of normal errors: standard deviation by median absolute deviation
_WORTHLESS = 3.0  # times the usual error: a ninth of the usual weight
_BEYOND_DOUBT = 5.0  # standard deviations


@dataclass(frozen=True)
class BoardView:
    """One stereo pair's corners: left_px (N, 2) and right_px (M, 2) [px] in the raw images.

    left_seen (N,), right_seen (M,): which of the board's corners these are, ascending; None: all, in the board's order.
    Raises ArrayError on another shape or values that are not finite.
    """

    name: str
    left_px: Floats
    right_px: Floats
    left_seen: Ints | None = None
    right_seen: Ints | None = None

    def __post_init__(self) -> None:
        for side in ("left", "right"):
            self._check(f"{side}_px", f"{side}_seen")

    def _check(self, px: str, seen: str) -> None:
        indices, count = getattr(self, seen), None
        if indices is not None:
            object.__setattr__(self, seen, ascending(f"{self.name}: {seen}", indices))
            count = len(indices)
        object.__setattr__(self, px, floats(f"{self.name}: {px}", getattr(self, px), count, 2))

    @property
    def corners_px(self) -> tuple[Floats, Floats]:
        """The corners in the left image and in the right one."""
        return self.left_px, self.right_px

    @property
    def seen(self) -> tuple[Ints, Ints]:
        """Which of the board's corners the left image shows, and which the right one."""
        left = np.arange(len(self.left_px)) if self.left_seen is None else self.left_seen
        right = np.arange(len(self.right_px)) if self.right_seen is None else self.right_seen
        return left, right

    def points(self, board: Board) -> tuple[Floats, Floats]:
        """The corners (N, 3) and (M, 3) [m] in the board frame that the left image shows, and the right one."""
        points, (left, right) = board.object_points(), self.seen
        return points[left], points[right]

    def in_both(self) -> BoardView:
        """The view with only the corners that both images show."""
        seen, in_left, in_right = np.intersect1d(*self.seen, assume_unique=True, return_indices=True)
        return BoardView(self.name, self.left_px[in_left], self.right_px[in_right], seen, seen)

    def with_right(self, right_px: Floats, right_seen: Ints) -> BoardView:
        """The view with other right corners (M, 2) [px]; right_seen (M,): which of the board's they are, unsorted."""
        order = np.argsort(right_seen)
        return BoardView(self.name, self.left_px, right_px[order], self.left_seen, right_seen[order])

    def keep(self, left: Bools, right: Bools) -> BoardView:
        """The view with only these of its left corners (N,) and of its right ones (M,)."""
        left_seen, right_seen = self.seen
        return BoardView(self.name, self.left_px[left], self.right_px[right], left_seen[left], right_seen[right])


def ascending(name: str, indices: Ints) -> Ints:
    """A read-only copy of the indices; raises ArrayError where they do not grow from 0 or more."""
    copy = np.array(indices, np.int64)
    if copy.ndim != 1 or (copy[:1] < 0).any() or (copy[1:] <= copy[:-1]).any():
        raise ArrayError(f"{name} = {copy.tolist()} must be ascending indices of corners")
    frozen(copy)
    return copy


@dataclass(frozen=True)
class RejectedView:
    """A stereo pair that was left out, and why."""

    name: str
    reason: str


@dataclass(frozen=True)
class RejectedCorner:
    """A corner that was left out of one image, `left` or `right`, of a view that stays.

    corner: which of the board's `object_points()` it is; residual_px: how far [px] it is from where the view's other
    corners put it.
    """

    view: str
    side: str
    corner: int
    residual_px: float

    def describe(self, board: Board) -> str:
        """What to tell people; rows and columns are counted from 1."""
        row, column = divmod(self.corner, board.grid[0])
        return (
            f"{self.view}: {self.side} corner in row {row + 1}, column {column + 1} is {self.residual_px:.2f} px from "
            "where the others put it"
        )


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
        for side, corners_px, seen in zip(("left", "right"), view.corners_px, (view.left_seen, view.right_seen)):
            if seen is None and len(corners_px) != board.corner_count:
                raise CalibrationError(
                    f"{view.name}: {len(corners_px)} corners in the {side} image, but a {board} board has "
                    f"{board.corner_count}"
                )
            if seen is not None and (board.needs_all_corners or (seen >= board.corner_count).any()):
                raise CalibrationError(f"{view.name}: corners {seen.tolist()} are no part of a {board} board")


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
    """The error [px] above which a view does not belong to the others.

    It must be three times the usual one, and beyond what the others differ from each other by: five standard
    deviations of the errors' logarithms. Both are by medians, in which the views rejected before stay: the limit would
    sink with each, and reject ever better views.
    """
    logs = np.log(np.maximum([*errors_px, *rejected_px], FINEST_PX))
    usual = np.median(logs)
    spread = MAD_TO_SIGMA * np.median(np.abs(logs - usual))
    return float(np.exp(usual + max(np.log(_WORTHLESS), _BEYOND_DOUBT * spread)))
