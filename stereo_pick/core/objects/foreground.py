"""Which pixels may belong to objects (thesis 3.7.2, step 2): three ways to choose the threshold."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from stereo_pick.core.arrays import Bools
from stereo_pick.core.objects.background import fit_background
from stereo_pick.core.objects.view import View

# A surface that is lit takes nothing away from its surroundings: at the bright side of the background there is
# only the faint light that objects throw on the table. At the dark side there are their shadows, and a soft
# shadow takes up to half of the light away.
_TRIM = {"bright": 0.15, "dark": 0.5}


@dataclass(frozen=True, eq=False)
class Contrast:
    """How far each pixel of a view lies above the background, before it is said whether objects are bright or dark.

    difference: (H, W) grey levels; threshold: the excess from which a pixel may belong to an object, above
    and below; noise: one sigma of the background; trims: whether glow and shadow can be told from objects.
    """

    difference: NDArray[np.float32]
    bright_threshold: float
    dark_threshold: float
    noise: float
    trims: bool


@dataclass(frozen=True, eq=False)
class Foreground:
    """mask: (H, W), the object pixels; excess: (H, W), grey levels by which each pixel stands out from the
    background in the direction of the polarity; trim: part of an object's own excess below which a pixel at its
    rim is glow or shadow."""

    mask: Bools
    excess: NDArray[np.float32]
    trim: float


def measure_contrast(view: View, method: str, fixed_threshold: int, threshold_sigma: float) -> Contrast:
    """Compare a view with its background by `method`: background, otsu or fixed."""
    if method == "background":
        background = fit_background(view.smooth, view.inside)
        limit = threshold_sigma * background.sigma
        return Contrast(view.smooth - background.level, limit, limit, background.sigma, trims=True)
    threshold = _otsu(view) if method == "otsu" else float(fixed_threshold)
    grey = view.smooth[view.inside]
    above, below = grey[grey > threshold], grey[grey <= threshold]
    # The larger class is the background; half-way levels need a background level, not the threshold.
    level = float(np.median(below if below.size >= above.size else above))
    return Contrast(view.smooth - np.float32(level), threshold - level, level - threshold, 1.0, trims=False)


def foreground(view: View, contrast: Contrast, polarity: str) -> Foreground:
    """The pixels that stand out as bright, or as dark, objects do."""
    bright = polarity == "bright"
    excess = contrast.difference if bright else -contrast.difference
    limit = contrast.bright_threshold if bright else contrast.dark_threshold
    mask = (excess > limit) & view.inside
    return Foreground(mask, excess, _TRIM[polarity] if contrast.trims else 0.0)


def _otsu(view: View) -> float:
    grey = view.smooth[view.inside].round().astype(np.uint8)
    level, _ = cv2.threshold(grey, 0, 255, cv2.THRESH_BINARY + cv2.THRESH_OTSU)
    return float(level) + 0.5
