"""From object pixels to outlines (thesis 3.7.2, steps 3 to 5): noise out, gaps closed, holes filled, boundary."""

from __future__ import annotations

from collections.abc import Iterator

import cv2
import numpy as np
from numpy.typing import NDArray

from stereo_pick.core.arrays import Bools, Floats
from stereo_pick.core.objects.blob import Blob
from stereo_pick.core.objects.foreground import Foreground
from stereo_pick.core.objects.view import View


def outlines(view: View, fore: Foreground, min_area_px: int, closing_px: int) -> Iterator[Blob]:
    """Yield the objects of one view; their contours run through the centres of their outermost pixels.

    min_area_px and closing_px are those of the view in full size.
    """
    min_area_px = max(1, round(min_area_px / view.reduction**2))
    closing_px = 2 * (closing_px // (2 * view.reduction)) + 1 if closing_px else 0
    mask = cv2.medianBlur(fore.mask.astype(np.uint8), 3)  # salt and pepper
    contours, _ = cv2.findContours(mask, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)  # 8-connected
    for outer in contours:
        x, y, width, height = cv2.boundingRect(outer)
        window = np.s_[y : y + height, x : x + width]
        member = _filled(np.asarray(outer, np.int32) - np.array([x, y], np.int32), (height, width)).astype(
            np.bool_
        ) & mask[window].astype(np.bool_)
        if np.count_nonzero(member) < min_area_px:
            continue
        for pixels, contrast in _trimmed(member, fore.excess[window], fore.trim, min_area_px, closing_px):
            contour = _outer_contour(pixels) + (x - closing_px, y - closing_px)
            yield Blob(view.full_px(contour), contrast, cut=_leaves(view, contour))


def _trimmed(
    member: Bools, excess: NDArray[np.float32], trim: float, min_area_px: int, closing_px: int
) -> Iterator[tuple[NDArray[np.uint8], float]]:
    """Cut the glow or shadow off a component, close and fill it; yield what is left, in pieces, with their contrast."""
    return _closed(member & (excess > trim * np.median(excess[member])), excess, min_area_px, closing_px)


def pieces(
    view: View, member: Bools, excess: NDArray[np.float32], corner: tuple[int, int], min_area_px: int
) -> Iterator[Blob]:
    """Yield the connected parts of a mask whose upper left corner is at this (column, row) of the reduced view."""
    for pixels, contrast in _closed(member, excess, max(1, round(min_area_px / view.reduction**2)), 1):
        contour = _outer_contour(pixels) + (corner[0] - 1, corner[1] - 1)
        yield Blob(view.full_px(contour), contrast, cut=_leaves(view, contour))


def _closed(
    member: Bools, excess: NDArray[np.float32], min_area_px: int, closing_px: int
) -> Iterator[tuple[NDArray[np.uint8], float]]:
    """The filled pieces of a mask, padded by closing_px all around, with their contrast."""
    kept, excess = np.pad(member.astype(np.uint8), closing_px), np.pad(excess, closing_px)
    if closing_px > 1:
        kernel = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (closing_px, closing_px))
        kept = np.asarray(cv2.morphologyEx(kept, cv2.MORPH_CLOSE, kernel), np.uint8)
    contours, _ = cv2.findContours(kept, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
    for contour in contours:
        filled = _filled(np.asarray(contour, np.int32), kept.shape)
        if cv2.countNonZero(filled) >= min_area_px and len(contour) >= 3:
            yield filled, float(np.median(excess[(filled & kept).astype(np.bool_)]))


def _filled(contour: NDArray[np.int32], shape: tuple[int, ...]) -> NDArray[np.uint8]:
    filled = np.zeros(shape, np.uint8)
    cv2.drawContours(filled, [contour], -1, 1, cv2.FILLED)
    return filled


def _outer_contour(pixels: NDArray[np.uint8]) -> Floats:
    contours, _ = cv2.findContours(pixels, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
    return np.asarray(max(contours, key=len)[:, 0], np.float64)


def _leaves(view: View, contour: Floats) -> bool:
    rows, columns = (np.clip(contour[:, axis], 0, view.core.shape[1 - axis] - 1).astype(np.int64) for axis in (1, 0))
    return not bool(view.core[rows, columns].all())
