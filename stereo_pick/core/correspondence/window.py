"""Windows of two views compared: the sum of squared differences (thesis eq. 3.8), to a part of a pixel."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from stereo_pick.core.arrays import Floats

Grey = NDArray[np.float32]

_MAX_ITERATIONS = 20
_MAX_STEP_PX = 0.5
_CONVERGED_PX = 1e-3


@dataclass(frozen=True)
class WindowFit:
    """Where a window lies in the other view: its column [px]; one sigma of that from residual and texture [px];
    and the part of the window's own variation that the match explains (1 all, 0 none)."""

    column_px: float
    sigma_px: float
    similarity: float


def window_at(image: Grey, centre_px: Floats, width_px: int, height_px: int | None = None) -> Grey:
    """The window (height, width) around a sub-pixel centre (2,), bilinear."""
    size = (width_px, height_px or width_px)
    return np.asarray(cv2.getRectSubPix(image, size, (float(centre_px[0]), float(centre_px[1]))), np.float32)


def ssd_along_row(one: Grey, other: Grey, centre_px: Floats, window_px: int) -> Floats:
    """SSD (W,) of the window around a point (2,) of `one` with that around each column of the same row of `other`."""
    width = other.shape[1]
    template = window_at(one, centre_px, window_px)
    middle = np.array([(width - 1) / 2, centre_px[1]])
    strip = window_at(other, middle, width + window_px - 1, window_px)
    return np.asarray(cv2.matchTemplate(strip, template, cv2.TM_SQDIFF)[0], np.float64)


def refine(one: Grey, other: Grey, centre_px: Floats, column_px: float, window_px: int) -> WindowFit:
    """Move the window in `other` along the row to where it fits best (Lucas and Kanade 1981).

    The gradient is the mean of both windows': a parabola through three SSD values locks to whole pixels, and the
    gradient of one window alone is biased by the other's noise.
    """
    template = window_at(one, centre_px, window_px + 2, window_px)
    for _ in range(_MAX_ITERATIONS):
        moved = window_at(other, np.array([column_px, centre_px[1]]), window_px + 2, window_px)
        gradient = (_slope(template) + _slope(moved)) / 2
        difference = (template - moved)[:, 1:-1]
        step = float((gradient * difference).sum()) / (float((gradient**2).sum()) + 1e-9)
        column_px += float(np.clip(step, -_MAX_STEP_PX, _MAX_STEP_PX))
        if abs(step) < _CONVERGED_PX:
            break
    squares = float((difference**2).sum())
    inner = template[:, 1:-1]
    sigma_px = np.sqrt(squares / inner.size / (float((gradient**2).sum()) + 1e-9))
    similarity = 1 - squares / (float(((inner - inner.mean()) ** 2).sum()) + 1e-9)
    return WindowFit(column_px, float(sigma_px), similarity)


def _slope(window: Grey) -> Grey:
    return (window[:, 2:] - window[:, :-2]) * np.float32(0.5)
