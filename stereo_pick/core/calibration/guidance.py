"""What a person who moves the board in front of the cameras should show next."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

import cv2
import numpy as np

from stereo_pick.core.arrays import Bools, Floats
from stereo_pick.core.calibration.any_board import Board
from stereo_pick.core.calibration.views import BoardView

WANTED_VIEWS = 15
_TILTED_DEG = 15.0
_ROWS = ("upper", "middle", "lower")
_COLUMNS = ("left", "middle", "right")
_NOMINAL_FOCAL = 1.0  # of the image's width: an angle of view of 53 deg; good enough to tell directions
_FACING = {"left": (-1, 0), "right": (1, 0), "up": (0, -1), "down": (0, 1)}


@dataclass(frozen=True, eq=False)
class Guidance:
    """What is missing of a good set of views.

    views: how many there are; left_empty, right_empty: which ninths (3, 3) of each image no board has reached, row by
    row; facing: the directions, as the cameras see them, to which no board was turned by 15 degrees or so.
    """

    views: int
    left_empty: Bools
    right_empty: Bools
    facing: tuple[str, ...]

    @property
    def missing(self) -> tuple[str, ...]:
        """One text for each kind of thing that is missing; empty where the views are good."""
        return tuple(self._missing())

    def _missing(self) -> Iterator[str]:
        if self.views < WANTED_VIEWS:
            yield f"{WANTED_VIEWS - self.views} more views"
        for side, empty in (("left", self.left_empty), ("right", self.right_empty)):
            if empty.any():
                yield f"the board in the {side} image's {', '.join(_named(empty))}"
        if self.facing:
            yield f"the board turned to face {', '.join(self.facing)}"


def guide(views: Sequence[BoardView], size_px: tuple[int, int], board: Board) -> Guidance:
    """What these views lack; size_px: width and height of the images."""
    leans_deg = np.array([_lean_deg(view, size_px, board) for view in views]).reshape(-1, 2)
    facing = tuple(name for name, way in _FACING.items() if not (leans_deg @ np.array(way) >= _TILTED_DEG).any())
    left, right = (_empty((view.corners_px[side] for view in views), size_px) for side in (0, 1))
    return Guidance(len(views), left, right, facing)


def _empty(corners_px: Iterable[Floats], size_px: tuple[int, int]) -> Bools:
    """Which ninths (3, 3) of an image hold no corner."""
    empty = np.ones((3, 3), np.bool_)
    for px in corners_px:
        column, row = np.clip((px + 0.5) * 3 // size_px, 0, 2).astype(int).T
        empty[row, column] = False
    return empty


def _lean_deg(view: BoardView, size_px: tuple[int, int], board: Board) -> Floats:
    """By how much (2,) [deg] the board faces to the right and down in the left image, for a usual lens."""
    width, height = size_px
    focal_px = _NOMINAL_FOCAL * width
    K = np.array([[focal_px, 0, (width - 1) / 2], [0, focal_px, (height - 1) / 2], [0, 0, 1]])
    points, _ = view.points(board)
    _, rvec, _ = cv2.solvePnP(points, view.left_px, K, None, flags=cv2.SOLVEPNP_IPPE)
    x, y, z = cv2.Rodrigues(rvec)[0][:, 2]
    # The board's z axis points into it; it faces the other way.
    return np.degrees([np.arctan2(-x, abs(z)), np.arctan2(-y, abs(z))])


def _named(empty: Bools) -> list[str]:
    """Names of the ninths, like `upper left`."""
    return [
        "middle" if row == column == 1 else f"{_ROWS[row]} {_COLUMNS[column]}" for row, column in np.argwhere(empty)
    ]
