"""A model of an empty work surface on which light is no simple surface: a lamp mirrors in it, or stands close by.

B-splines, from few intervals to many (as in Forsey and Bartels 1988), each fitted to what those before leave, robustly:
objects are smaller than an interval, so that none of these surfaces can follow them.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stereo_pick.core.arrays import Bools, Floats
from stereo_pick.core.objects.background import (
    CLEARLY_TIGHTER,
    Background,
    Window,
    grid_stride_px,
    refined,
    spread,
)
from stereo_pick.core.objects.exposure import CLIPPED

_INTERVALS = (1, 2, 3, 6)  # along the shorter side of a view
_DONE = 1.5  # times what neighbours differ by
_KNOWN = 0.5  # of a view, at least, that is neither outside nor clipped
_WHITE = np.float32(255.0)


@dataclass(frozen=True, eq=False)
class UnevenBackground:
    """Grey level (H, W) of the empty surface, and the spread (one sigma, grey levels) around it."""

    level: NDArray[np.float32]
    sigma: float

    def at(self, window: Window, above: float = 0.0) -> NDArray[np.float32]:
        """Grey level of the empty surface in a window of the image, raised by `above`."""
        return self.level[window] + np.float32(above)


def fit_uneven(image: NDArray[np.float32], valid: Bools, even: Background) -> UnevenBackground | None:
    """The background of a view (H, W) with so many intervals that what is left is hardly more than what a pixel
    differs by from its neighbours; None where the best is not clearly tighter than the even one.

    valid: (H, W), the pixels to look at.
    """
    grid = (np.s_[:: grid_stride_px(image.shape)],) * 2
    grey, known = image[grid], valid[grid] & (image[grid] < CLIPPED)
    if known.mean() < _KNOWN:
        return None
    least_sigma = _DONE * _noise(grey, known)
    level, sigma = even.level, even.sigma
    for intervals in _INTERVALS:
        more, sigma = _left_over(grey - level[grid], known, image.shape, intervals)
        level = level + more
        if sigma <= least_sigma:
            break
    if even.sigma <= CLEARLY_TIGHTER * sigma:
        return None
    return UnevenBackground(np.minimum(level, _WHITE), sigma)


def _left_over(
    left: NDArray[np.float32], known: Bools, shape: tuple[int, ...], intervals: int
) -> tuple[NDArray[np.float32], float]:
    """The surface (H, W) with so many intervals along the shorter side through what is left on a grid (h, w), and the
    spread around it."""
    stride_px = grid_stride_px(shape)
    rows, columns = (_basis(np.arange(size) / size, round(intervals * size / min(shape))) for size in shape)
    terms = rows[::stride_px, None, :, None] * columns[None, ::stride_px, None, :]
    terms = terms.reshape(*known.shape, -1)[known]
    grey = left[known].astype(np.float64)
    coefficients = refined(np.zeros(terms.shape[1]), terms, grey)
    surface = rows @ coefficients.reshape(rows.shape[1], -1) @ columns.T
    return surface.astype(np.float32), spread(grey - terms @ coefficients)


def _noise(grey: NDArray[np.float32], known: Bools) -> float:
    """One sigma of what samples (H, W) differ by from the mean of those beside them in a row: noise and grain, which no
    surface can follow, as it follows a slope."""
    three = known[:, 2:] & known[:, 1:-1] & known[:, :-2]
    return spread(np.diff(grey, n=2, axis=1)[three].astype(np.float64) / np.sqrt(6))


def _basis(axis: Floats, intervals: int) -> Floats:
    """Cubic B-splines (N, intervals + 3) at places (N,) from 0 to 1, over equal intervals."""
    first = np.minimum((axis * intervals).astype(int), intervals - 1)
    t = axis * intervals - first
    pieces = (1 - t) ** 3, 3 * t**3 - 6 * t**2 + 4, 1 + 3 * t * (1 + t - t * t), t**3
    basis = np.zeros((len(axis), intervals + 3))
    for i, piece in enumerate(pieces):
        basis[np.arange(len(axis)), first + i] = piece / 6
    return basis
