"""What finds the corners of a board in an image: chessboards whole, ChArUco boards in part."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import cv2
import numpy as np

from stereo_pick.core.arrays import Floats, Image, Ints, floats
from stereo_pick.core.calibration.any_board import Board
from stereo_pick.core.calibration.aruco import LEGACY, charuco_corners
from stereo_pick.core.calibration.boards import Chessboard
from stereo_pick.core.calibration.charuco import CharucoBoard
from stereo_pick.core.calibration.corners import DETECTORS, SEEKING, Detector
from stereo_pick.core.calibration.views import BoardView, RejectedView, ascending


@dataclass(frozen=True)
class SeenCorners:
    """Corners px (N, 2) [px] in one image; seen (N,): which of the board's they are, ascending.

    Raises ArrayError on other shapes, values that are not finite or indices that do not grow.
    """

    px: Floats
    seen: Ints

    def __post_init__(self) -> None:
        object.__setattr__(self, "seen", ascending("seen", self.seen))
        object.__setattr__(self, "px", floats("corners", self.px, len(self.seen), 2))


_REDUCED_PX, _REDUCE_ABOVE_PX = 640, 960

Finder = Callable[[Image], "SeenCorners | None"]


def finders(board: Board) -> dict[str, Finder]:
    """The detectors for this board by their names; each takes an image (H, W) uint8, None where it finds no board.

    Raises CalibrationError where this OpenCV cannot find such a board.
    """
    if isinstance(board, Chessboard):
        return {name: partial(_whole, detector, board) for name, detector in DETECTORS.items()}
    found: dict[str, Finder] = {"ChArUco": partial(_part, board, False)}
    # With an odd number of rows both patterns are the same.
    if LEGACY and board.rows % 2 == 0:
        found["ChArUco, legacy pattern"] = partial(_part, board, True)
    return found


def seekers(board: Board) -> list[Finder]:
    """Those of the finders that are needed to tell whether a board is there: looking in vain takes seconds each."""
    if isinstance(board, Chessboard):
        return [partial(_whole, detector, board) for detector in SEEKING]
    return list(finders(board).values())


def may_show(picture: Image, board: Board) -> bool:
    """Whether it is worth looking for the board in an image (H, W) uint8, told by a reduced one.

    Looking in vain for a chessboard takes the detectors seconds in a large image. One whose squares are smaller than
    a sixtieth of the image's width may be missed. ChArUco boards are quickly found or not.
    """
    width_px = picture.shape[1]
    if not isinstance(board, Chessboard) or width_px <= _REDUCE_ABOVE_PX:
        return True
    size_px = _REDUCED_PX, round(picture.shape[0] * _REDUCED_PX / width_px)
    reduced = np.asarray(cv2.resize(picture, size_px, interpolation=cv2.INTER_AREA), np.uint8)
    return any(find(reduced) is not None for find in seekers(board))


def board_view(name: str, left: SeenCorners, right: SeenCorners, board: Board) -> BoardView | RejectedView:
    """What both images show, as a view of this name; rejected where they share too few corners to say anything."""
    if isinstance(board, Chessboard):
        return BoardView(name, left.px, right.px)
    common = np.intersect1d(left.seen, right.seen, assume_unique=True)
    if board.spans_plane(common):
        return BoardView(name, left.px, right.px, left.seen, right.seen)
    return RejectedView(
        name,
        f"only {len(common)} corners of the board are in both images ({len(left.seen)} left, {len(right.seen)} right): "
        "at least 6 in two rows are needed",
    )


def _whole(detector: Detector, board: Chessboard, picture: Image) -> SeenCorners | None:
    corners = detector(picture, board)
    return None if corners is None else SeenCorners(corners, np.arange(len(corners)))


def _part(board: CharucoBoard, legacy: bool, picture: Image) -> SeenCorners | None:
    corners, seen = charuco_corners(picture, board, legacy)
    if not len(seen):
        return None
    order = np.argsort(seen)
    return SeenCorners(corners[order], seen[order])
