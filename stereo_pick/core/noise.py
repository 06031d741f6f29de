"""How much noise there is in a view."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

_QUANTISATION_DN = 12**-0.5
_MEDIAN_TO_SIGMA = 1.4826
_MASK = np.outer((1, -2, 1), (1, -2, 1)).astype(np.float32)  # what it leaves of a smooth surface is noise


def noise_dn(image: NDArray[np.float32], where: NDArray[np.bool_] | None = None) -> float:
    """One sigma of the pixel noise of a view [grey levels], at least that of 8 bits (Immerkaer 1996, by the median).

    where: the pixels that count, if not all: what is dark has less noise than what is bright.
    Fine texture all over the view counts as noise. Of a view that was interpolated, as by rectification, it tells less
    than there is: most of what differs from pixel to pixel is gone there.
    """
    left = np.abs(cv2.filter2D(image, -1, _MASK))
    left = left if where is None else left[where]
    return max(float(np.median(left)) * _MEDIAN_TO_SIGMA / float(np.linalg.norm(_MASK)), _QUANTISATION_DN)
