"""Which of many views of a board are worth calibrating from: the sharp ones, each unlike the others."""

from __future__ import annotations

from dataclasses import dataclass, field

import cv2
import numpy as np

from stereo_pick.core.arrays import Floats, Image
from stereo_pick.core.calibration.any_board import Board
from stereo_pick.core.calibration.detection import BoardImages
from stereo_pick.core.calibration.views import BoardView

MAX_VIEWS = 40
MIN_MOVE = 0.01  # of the image width; turning a board by 20 degrees may move its corners by 2 %
_WIDER = 2**0.5
_MIN_SHARPNESS = 0.6  # of the median
_HALF_PATCH_PX = 6


@dataclass(frozen=True, eq=False)
class Candidate:
    """The `index`-th pair, the corners that were seen in it and the `sharpness` of the worse image."""

    index: int
    images: BoardImages
    view: BoardView
    sharpness: float


@dataclass(frozen=True, eq=False)
class _Place:
    """Where a board was first seen, and the sharpest candidate of those that are nearest to it."""

    first: BoardView
    best: Candidate


@dataclass(eq=False)
class Selection:
    """Candidates chosen while they come: of similar ones the sharpest, none that is blurred, at most `max_views`.

    Views are similar where the board moved by less than MIN_MOVE of the image's width; where there are too many, by
    less than more and more. Everything depends on the candidates and their order alone.
    """

    board: Board
    max_views: int = MAX_VIEWS
    _places: list[_Place] = field(default_factory=list)
    _sharpness: list[float] = field(default_factory=list)
    _min_move: float = MIN_MOVE

    def add(self, candidate: Candidate) -> None:
        """Take a candidate, or pass over it."""
        self._sharpness.append(candidate.sharpness)
        if candidate.sharpness < self._least_sharpness():
            return
        self._put(_Place(candidate.view, candidate))
        while len(self._places) > self.max_views:
            self._min_move *= _WIDER
            places, self._places = self._places, []
            for place in places:
                self._put(place)

    def chosen(self) -> tuple[Candidate, ...]:
        """The candidates to calibrate from, in the order in which they came."""
        least, best = self._least_sharpness(), [place.best for place in self._places]
        return tuple(sorted((each for each in best if each.sharpness >= least), key=lambda each: each.index))

    def _least_sharpness(self) -> float:
        return _MIN_SHARPNESS * float(np.median(self._sharpness)) if self._sharpness else 0.0

    def _put(self, new: _Place) -> None:
        """As a place of its own, or where it is sharper as the best of the place that is nearest to it."""
        distances_px = [moved_px(new.first, place.first, self.board) for place in self._places]
        nearest = int(np.argmin(distances_px)) if distances_px else 0
        if not distances_px or distances_px[nearest] >= self._min_move * new.best.images.size_px[0]:
            self._places.append(new)
        elif new.best.sharpness > self._places[nearest].best.sharpness:
            self._places[nearest] = _Place(self._places[nearest].first, new.best)


def sharpness(picture: Image, corners_px: Floats) -> float:
    """How steep the edges at the corners (N, 2) [px] are: the share of the contrast that one pixel spans, 0 .. 1.

    picture: (H, W) uint8. The median over the corners; independent of how bright the image is.
    """
    slopes = [cv2.Sobel(picture, cv2.CV_32F, dx, dy, scale=1 / 8) for dx, dy in ((1, 0), (0, 1))]
    steepness = cv2.magnitude(*slopes)
    shares = []
    for u, v in np.rint(corners_px).astype(int):
        patch = (
            slice(max(v - _HALF_PATCH_PX, 0), v + _HALF_PATCH_PX + 1),
            slice(max(u - _HALF_PATCH_PX, 0), u + _HALF_PATCH_PX + 1),
        )
        contrast = max(float(np.ptp(picture[patch])), 1.0)
        shares.append(float(steepness[patch].max()) / contrast)
    return float(np.median(shares))


def moved_px(view: BoardView, other: BoardView, board: Board) -> float:
    """Rms distance [px] of the left corners that both views show, in the order that suits; inf without any.

    Only boards that are seen whole have several orders.
    """
    if view.left_seen is None or other.left_seen is None:
        return min(_rms_px(view.left_px[order], other.left_px) for order in board.orders())
    _, here, there = np.intersect1d(view.left_seen, other.left_seen, assume_unique=True, return_indices=True)
    return _rms_px(view.left_px[here], other.left_px[there]) if len(here) else np.inf


def _rms_px(a: Floats, b: Floats) -> float:
    return float(np.sqrt(((a - b) ** 2).sum(axis=1).mean()))
