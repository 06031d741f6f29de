"""Which of many views of a board are worth calibrating from: the sharp ones, each unlike the others."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np

from stereo_pick.core.arrays import Floats, Image
from stereo_pick.core.calibration.any_board import Board
from stereo_pick.core.calibration.views import BoardView

MAX_VIEWS = 40
MIN_MOVE = 0.01  # of the image width; turning a board by 20 degrees may move its corners by 2 %
_MIN_SHARPNESS = 0.6  # of the median
_HALF_PATCH_PX = 6


@dataclass(frozen=True)
class Candidate:
    """The `index`-th pair of a recording, the corners that were seen in it and the `sharpness` of the worse image."""

    index: int
    view: BoardView
    sharpness: float


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


def choose(
    candidates: Sequence[Candidate], board: Board, width_px: int, max_views: int = MAX_VIEWS
) -> tuple[Candidate, ...]:
    """The views to calibrate from, in their order: no blurred ones, of similar ones the sharpest, at most `max_views`.

    width_px: of the images; views are similar where the board moved by less than MIN_MOVE of it.
    """
    if not candidates:
        return ()
    limit = _MIN_SHARPNESS * float(np.median([candidate.sharpness for candidate in candidates]))
    taken = list[Candidate]()
    for candidate in sorted(candidates, key=lambda candidate: -candidate.sharpness):
        nearest_px = min((moved_px(candidate.view, other.view, board) for other in taken), default=np.inf)
        if candidate.sharpness >= limit and nearest_px >= MIN_MOVE * width_px:
            taken.append(candidate)
    return tuple(sorted(_farthest_apart(taken, board, max_views), key=lambda candidate: candidate.index))


def moved_px(view: BoardView, other: BoardView, board: Board) -> float:
    """Rms distance [px] of the left corners that both views show, in the order that suits; inf without any.

    Only boards that are seen whole have several orders.
    """
    if view.left_seen is None or other.left_seen is None:
        return min(_rms_px(view.left_px[order], other.left_px) for order in board.orders())
    _, here, there = np.intersect1d(view.left_seen, other.left_seen, assume_unique=True, return_indices=True)
    return _rms_px(view.left_px[here], other.left_px[there]) if len(here) else np.inf


def _farthest_apart(candidates: Sequence[Candidate], board: Board, count: int) -> list[Candidate]:
    """At most `count` of the candidates: the first, then always the one least like those taken."""
    if len(candidates) <= count:
        return list(candidates)
    taken, nearest_px = list[Candidate](), np.full(len(candidates), np.inf)
    while len(taken) < count:
        last = candidates[int(nearest_px.argmax())]
        taken.append(last)
        nearest_px = np.minimum(nearest_px, [moved_px(each.view, last.view, board) for each in candidates])
    return taken


def _rms_px(a: Floats, b: Floats) -> float:
    return float(np.sqrt(((a - b) ** 2).sum(axis=1).mean()))
