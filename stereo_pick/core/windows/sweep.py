"""Windows of one size around every pixel compared with the other view at every whole disparity."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import cv2
import numpy as np

from stereo_pick.core.arrays import Floats, Ints
from stereo_pick.core.windows.window import Grey, factor, misfit

_STRIP_ROWS = 64  # so that the misfits at all disparities fit into memory


@dataclass(frozen=True, eq=False)
class WholeMatches:
    """The best whole disparity of each pixel, (H, W); by what factor the next best fits worse, (H, W); and the shift
    (H, W, 2) from the pixel to the middle of the window that fitted best [px].
    """

    disparity_px: Ints
    uniqueness: Floats
    shift_px: Ints


def sweep(
    one: Grey, other: Grey, limits_px: tuple[int, int], window_px: int, cost: str, *, shifted: bool = True
) -> WholeMatches:
    """Match every pixel of `one` (H, W) at disparities from the least to the greatest of `limits_px`.

    Near a depth edge a window around the pixel shows two depths; so, of nine windows that contain the pixel, the one
    that fits best is taken (Fusiello, Roberto and Trucco 1997), if they are to be `shifted`.
    """
    step_px = max(1, round(window_px / 4)) if shifted else 0
    parts = []
    for rows, inner in _strips(one.shape[0], window_px):
        costs = _costs(one[rows], other[rows], limits_px, window_px, cost)
        parts.append(_winners(costs, window_px, step_px, inner))
    best, uniqueness, shift = (np.concatenate(each) for each in zip(*parts))
    return WholeMatches(best + limits_px[0], uniqueness, shift)


def _strips(height: int, margin: int) -> Iterator[tuple[slice, slice]]:
    """Rows to look at, and which of them are dealt with, without those that only surround them."""
    for top in range(0, height, _STRIP_ROWS):
        first, last = max(0, top - margin), min(height, top + _STRIP_ROWS + margin)
        yield slice(first, last), slice(top - first, min(height, top + _STRIP_ROWS) - first)


def _costs(one: Grey, other: Grey, limits_px: tuple[int, int], window_px: int, cost: str) -> Grey:
    """Misfit (D, H, W) of the window around each pixel of `one` at each disparity, inf where that leaves the image."""
    height, width = one.shape
    level = one.mean()
    one, other = one - level, other - level
    sums = [(_box(view, window_px), _box(view * view, window_px)) for view in (one, other)]
    costs = np.full((limits_px[1] - limits_px[0] + 1, height, width), np.inf, np.float32)
    for k, disparity in enumerate(range(limits_px[0], limits_px[1] + 1)):
        a = slice(max(0, disparity), max(0, min(width, width + disparity)))
        b = slice(a.start - disparity, a.stop - disparity)
        if a.stop <= a.start:
            continue
        ab = _box(one[:, a] * other[:, b], window_px)
        (mean_a, aa), (mean_b, bb) = sums
        costs[k, :, a] = misfit(cost, mean_a[:, a], mean_b[:, b], aa[:, a], bb[:, b], ab)
    return costs


def _box(image: Grey, window_px: int) -> Grey:
    return np.asarray(cv2.boxFilter(image, -1, (window_px, window_px), borderType=cv2.BORDER_REFLECT), np.float32)


def _winners(costs: Grey, window_px: int, step_px: int, rows: slice) -> tuple[Ints, Floats, Ints]:
    """Index of the best disparity, uniqueness and shift (..., 2) of the window, of each pixel of some rows."""
    nine = np.zeros((2 * step_px + 1,) * 2, np.uint8)
    nine[:: max(1, step_px), :: max(1, step_px)] = 1
    least = np.stack([cv2.erode(cost, nine)[rows] for cost in costs])
    best = least.argmin(axis=0)
    lowest = np.take_along_axis(least, best[None], axis=0)[0]
    near = np.abs(np.arange(len(costs))[:, None, None] - best) <= window_px // 2
    least[near] = np.inf
    there = np.isfinite(lowest)
    uniqueness = np.where(there, factor(least.min(axis=0).astype(np.float64), np.where(there, lowest, 1)), 0)
    return best, uniqueness, _shifts(costs, best, lowest, step_px, rows)


def _shifts(costs: Grey, best: Ints, lowest: Grey, step_px: int, rows: slice) -> Ints:
    """From each pixel to the middle of the window that had the lowest misfit at the best disparity, (..., 2)."""
    height, width = costs.shape[1:]
    v, u = np.indices(best.shape)
    shift = np.zeros((*best.shape, 2), np.int64)
    for dv in (-step_px, step_px, 0):
        for du in (-step_px, step_px, 0):
            y, x = v + rows.start + dv, u + du
            inside = (y >= 0) & (y < height) & (x >= 0) & (x < width)
            y, x = np.clip(y, 0, height - 1), np.clip(x, 0, width - 1)
            shift[inside & (costs[best, y, x] == lowest)] = du, dv
    return shift
