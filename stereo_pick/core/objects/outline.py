"""From object pixels to outlines (thesis 3.7.2, steps 3 to 5): noise out, gaps closed, holes filled, boundary."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import lru_cache
from typing import TypeVar

import cv2
import numpy as np
from numpy.typing import NDArray

from stereo_pick.core.arrays import Floats, Image
from stereo_pick.core.objects.blob import Blob
from stereo_pick.core.objects.foreground import Foreground
from stereo_pick.core.objects.frames import beside_walls, outermost
from stereo_pick.core.objects.view import View

_PATTERN = 0.04  # of an object's contrast, from a pixel to the next ones
_PATTERN_SIGMAS = 2.0
_GAP = 0.2  # of an object's width

_T = TypeVar("_T", bound=np.generic)


def outlines(fore: Foreground, min_area_px: int, closing_px: int) -> Iterator[Blob]:
    """Yield the objects of one view; their contours run through the centres of their outermost pixels.

    min_area_px and closing_px are those of the view in full size.
    """
    view = fore.contrast.view
    min_area_px = _reduced_area(view, min_area_px)
    closing_px = 2 * (closing_px // (2 * view.reduction)) + 1 if closing_px else 0
    mask = np.asarray(cv2.medianBlur(fore.mask, 3), np.uint8)  # salt and pepper
    for outer in outermost(mask):
        x, y, width, height = cv2.boundingRect(outer)
        if width * height < min_area_px:
            continue
        window = np.s_[y : y + height, x : x + width]
        member = _filled(outer, (height, width), (-x, -y)) & mask[window]
        if cv2.countNonZero(member) >= min_area_px:
            excess = fore.excess(window)
            # What fades at the rim is glow or shadow.
            member &= excess > fore.trim * upper_median(excess[member.view(np.bool_)])
            gap_px = closing_px and max(closing_px, _gap_px(member, excess, fore.contrast.background.sigma))
            yield from pieces(view, member, excess, (x, y), min_area_px, gap_px)
            if fore.polarity == "bright":  # what is dark around something is its shadow, as a rule
                found = pieces(view, beside_walls(member), excess, (x, y), min_area_px, closing_px=1)
                yield from (replace(piece, fault="merged") for piece in found)


def parts(
    view: View, member: Image, excess: NDArray[np.float32], corner: tuple[int, int], min_area_px: int
) -> Iterator[Blob]:
    """Yield the connected parts of a mask, 1 or 0, whose upper left corner is at this (column, row) of the reduced
    view; min_area_px is that of the view in full size."""
    return pieces(view, member, excess, corner, _reduced_area(view, min_area_px), closing_px=1)


def pieces(
    view: View, member: Image, excess: NDArray[np.float32], corner: tuple[int, int], min_area_px: int, closing_px: int
) -> Iterator[Blob]:
    """The same with gaps closed; all sizes are those of the reduced view."""
    kept, excess = _padded(member, closing_px), _padded(excess, closing_px)
    if closing_px > 1:
        kept = np.asarray(cv2.morphologyEx(kept, cv2.MORPH_CLOSE, _disc(closing_px)), np.uint8)
    contours, _ = cv2.findContours(kept, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
    for found in contours:
        filled = _filled(np.asarray(found, np.int32), kept.shape)
        if cv2.countNonZero(filled) < min_area_px or len(found) < 3:
            continue
        contrast, peak = _levels(excess[(filled & kept).view(np.bool_)])
        contour = np.asarray(found[:, 0], np.float64) + (corner[0] - closing_px, corner[1] - closing_px)
        yield Blob(view.full_px(contour), contrast, cut=_leaves(view, contour), peak=peak)


def _gap_px(member: Image, excess: NDArray[np.float32], sigma: float) -> int:
    """Width of the gaps that the dark places of a pattern leave at the rim of a part [px], 0 where it shows none.

    Its shape is not changed by closing gaps much narrower than itself.
    """
    inner = cv2.erode(member, np.ones((5, 5), np.uint8)).view(np.bool_)
    if not inner.any():
        return 0
    uneven = np.abs(excess - cv2.blur(excess, (5, 5)))[inner]
    if upper_median(uneven) < max(_PATTERN * upper_median(excess[inner]), _PATTERN_SIGMAS * sigma):
        return 0
    return 2 * int(_GAP * min(member.shape) / 2) + 1


def upper_median(values: NDArray[np.floating]) -> float:
    """The median, or the upper of two: `np.median` takes longer than all else that is done to an outline."""
    middle = len(values) // 2
    return float(np.partition(values, middle)[middle])


def _levels(values: NDArray[np.floating]) -> tuple[float, float]:
    """The upper median of values (N,) and the level that a tenth of them reach."""
    middle, high = len(values) // 2, len(values) - 1 - len(values) // 10
    ordered = np.partition(values, (middle, high))
    return float(ordered[middle]), float(ordered[high])


def _reduced_area(view: View, area_px: int) -> int:
    return max(1, round(area_px / view.reduction**2))


def _padded(values: NDArray[_T], by_px: int) -> NDArray[_T]:
    padded = np.zeros((values.shape[0] + 2 * by_px, values.shape[1] + 2 * by_px), values.dtype)
    padded[by_px : by_px + values.shape[0], by_px : by_px + values.shape[1]] = values
    return padded


@lru_cache
def _disc(size_px: int) -> Image:
    return np.asarray(cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (size_px, size_px)), np.uint8)


def _filled(contour: NDArray[np.int32], shape: tuple[int, ...], shift_px: tuple[int, int] = (0, 0)) -> Image:
    filled = np.zeros(shape, np.uint8)
    cv2.drawContours(filled, [contour], -1, 1, cv2.FILLED, offset=shift_px)
    return filled


def _leaves(view: View, contour: Floats) -> bool:
    last = np.array(view.core.shape[::-1]) - 1
    columns, rows = np.clip(contour, 0, last).astype(np.int64).T
    return not bool(view.core[rows, columns].all())
