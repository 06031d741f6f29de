"""The squares of a chessboard, as of a calibration's board that was left lying, or is held before the cameras.

Two of them meet at a corner, and nothing else does: objects that are packed meet there by fours. Each view tells them
alone: of squares that are all alike it is open which is which in the other.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import cv2
import numpy as np

from stereo_pick.core.arrays import Floats
from stereo_pick.core.matches.assignment import assign
from stereo_pick.core.matches.left_over import Unread
from stereo_pick.core.matches.similarity import Similarity
from stereo_pick.core.objects import Blob, Blobs

_LEAST = 4  # squares: boxes that meet at their corners are two, or three
_ROUGH = 0.12  # of a side, by which an outline may be off its four corners, which blur rounds
_APART = 0.25  # of a side, between the corners of two that meet
_OPPOSITE = -0.8  # cosine, at these corners, of the ways to their middles
_ALIKE = 2.0  # areas
_BESIDE = 1.0  # sides, beyond the squares: what of a board is one with something else


class _Square(NamedTuple):
    """Four corners (4, 2) [px] of an outline, its middle (2,) and its side."""

    blob: Blob
    corners_px: Floats
    middle_px: Floats
    side_px: float


def told_from_boards(blobs: Blobs, similarity: Similarity) -> tuple[Blobs, list[Unread]]:
    """What may be objects, and what is printed: the squares of boards, and what of the same shade lies among them."""
    left, right = (tuple(among_squares(side)) for side in (blobs.left, blobs.right))
    rest = replace(
        blobs,
        left=tuple(blob for blob in blobs.left if blob not in left),
        right=tuple(blob for blob in blobs.right if blob not in right),
    )
    unread = _refused(left, right, similarity)
    if blobs.others is None:
        return rest, unread
    others, more = told_from_boards(blobs.others, similarity)
    return replace(rest, others=others), unread + more


def among_squares(blobs: Sequence[Blob]) -> list[Blob]:
    """The outlines of one view that are squares of a board, or lie among these."""
    squares = [square for square in map(_square, blobs) if square]
    boards = [board for board in _connected(squares, blobs) if len(board) >= _LEAST]
    return [blob for blob in blobs if any(_lies_among(blob, board) for board in boards)]


def _refused(left: Sequence[Blob], right: Sequence[Blob], similarity: Similarity) -> list[Unread]:
    """Each once, though it may be one of its neighbours that it is taken for in the other view."""
    partner = dict(assign(similarity.costs(left, right), unmatched_cost=1.0))
    several = [Unread("flat", blob, right[partner[i]] if i in partner else None) for i, blob in enumerate(left)]
    return several + [Unread("flat", None, blob) for j, blob in enumerate(right) if j not in partner.values()]


def _square(blob: Blob) -> _Square | None:
    side_px = float(np.sqrt(blob.area_px2))
    corners = cv2.approxPolyDP(blob.contour_px.astype(np.float32), _ROUGH * side_px, closed=True)
    if len(corners) != 4 or not cv2.isContourConvex(corners):
        return None
    return _Square(blob, corners[:, 0].astype(np.float64), blob.centroid_px, side_px)


def _connected(squares: Sequence[_Square], blobs: Sequence[Blob]) -> list[list[_Square]]:
    """Those that meet each other, or others that do; blobs: all outlines of the view."""
    boards: list[list[_Square]] = []
    for square in squares:
        met = [board for board in boards if any(_meet(square, other, blobs) for other in board)]
        boards = [board for board in boards if board not in met]
        boards.append([square, *(other for board in met for other in board)])
    return boards


def _meet(one: _Square, other: _Square, blobs: Sequence[Blob]) -> bool:
    """Whether two squares of about one size meet at a corner, on opposite sides of it, and nothing else is there."""
    small_px, large_px = sorted((one.side_px, other.side_px))
    if large_px > np.sqrt(_ALIKE) * small_px:
        return False
    apart_px = np.linalg.norm(one.corners_px[:, None] - other.corners_px, axis=2)
    i, j = np.unravel_index(apart_px.argmin(), apart_px.shape)
    if apart_px[i, j] > _APART * small_px:
        return False
    corner_px = (one.corners_px[i] + other.corners_px[j]) / 2
    ways = one.middle_px - corner_px, other.middle_px - corner_px
    if ways[0] @ ways[1] > _OPPOSITE * np.linalg.norm(ways[0]) * np.linalg.norm(ways[1]):
        return False
    others = [blob for blob in blobs if blob is not one.blob and blob is not other.blob]
    return not any(_comes_near(blob, corner_px, _APART * small_px) for blob in others)


def _comes_near(blob: Blob, place_px: Floats, near_px: float) -> bool:
    return bool(np.linalg.norm(blob.contour_px - place_px, axis=1).min() < near_px)


def _lies_among(blob: Blob, board: Sequence[_Square]) -> bool:
    hull = cv2.convexHull(np.concatenate([square.corners_px for square in board]).astype(np.float32))
    x, y = blob.centroid_px.tolist()
    beside_px = _BESIDE * max(square.side_px for square in board)
    return cv2.pointPolygonTest(hull, (x, y), True) > -beside_px
