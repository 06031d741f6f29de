"""Windows of two views compared: sum of squared differences (thesis eq. 3.8) and normalised cross-correlation."""

from __future__ import annotations

from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from stereo_pick.core.arrays import Floats

Grey = NDArray[np.float32]

COSTS = ("zncc", "ssd")
_MAX_GAIN = 1.5  # of one camera over the other within a window; more of it makes noise out of an edge
_LEAST_VARIANCE_DN2 = 1e-6
_ROUNDING_DN2 = 2 / 12  # of two images of whole grey levels: a misfit below it says nothing


def window_at(image: Grey, centre_px: Floats, width_px: int, height_px: int | None = None) -> Grey:
    """The window (height, width) around a sub-pixel centre (2,), bilinear."""
    size = (width_px, height_px or width_px)
    return np.asarray(cv2.getRectSubPix(image, size, (float(centre_px[0]), float(centre_px[1]))), np.float32)


def misfit(cost: str, mean_a: Any, mean_b: Any, aa: Any, bb: Any, ab: Any) -> Any:
    """Mean square that window b leaves unexplained of window a [dn²], from the means of a, b, a², b² and a b.

    `ssd`: of the plain difference. `zncc`: of the difference after the best offset and gain. With the gain free that
    is (1 - r²) times the variance of a, where r is the zero-mean normalised cross-correlation, so its least value is
    the greatest correlation. Arrays are broadcast.
    """
    if cost == "ssd":
        return np.maximum(aa + bb - 2 * ab, 0)
    covariance = ab - mean_a * mean_b
    variance_a, variance_b = aa - mean_a**2, bb - mean_b**2
    gain = np.clip(covariance / np.maximum(variance_b, _LEAST_VARIANCE_DN2), 1 / _MAX_GAIN, _MAX_GAIN)
    return np.maximum(variance_a + gain * (gain * variance_b - 2 * covariance), 0)


def misfit_along_row(one: Grey, other: Grey, centre_px: Floats, window_px: int, cost: str) -> Floats:
    """Misfit (W,) of the window around a point (2,) of `one` with that around each column of the row of `other`."""
    width = other.shape[1]
    template = window_at(one, centre_px, window_px)
    strip = window_at(other, np.array([(width - 1) / 2, centre_px[1]]), width + window_px - 1, window_px)
    level = template.mean()  # taken off before squaring, which single precision would not bear
    template, strip = template - level, strip - level
    count = template.size
    ab = cv2.matchTemplate(strip, template, cv2.TM_CCORR)[0] / count
    over_window = np.ones(window_px) / count
    mean_b = np.convolve(strip.sum(axis=0, dtype=np.float64), over_window, "valid")
    bb = np.convolve((strip**2).sum(axis=0, dtype=np.float64), over_window, "valid")
    found = misfit(cost, float(template.mean()), mean_b, float((template**2).mean()), bb, ab)
    return np.asarray(found, np.float64)


def factor(next_best: Any, best: Any) -> Any:
    """By what factor one misfit [dn²] is worse than another; 1 where both are mere rounding."""
    return np.maximum(next_best, _ROUNDING_DN2) / np.maximum(best, _ROUNDING_DN2)
