"""Which pixels may belong to objects (thesis 3.7.2, step 2): three ways to choose the threshold."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from stereo_pick.core.arrays import Image
from stereo_pick.core.objects.background import EmptySurface, Window, even_background, fit_background
from stereo_pick.core.objects.exposure import MOST_LEVELS
from stereo_pick.core.objects.uneven import fit_uneven
from stereo_pick.core.objects.view import View

# A surface that is lit takes nothing away from its surroundings: at the bright side of the background there is
# only the faint light that objects throw on the table. At the dark side there are their shadows, and a soft
# shadow takes up to half of the light away.
_TRIM = {"bright": 0.15, "dark": 0.5}
_GRID_PX = 4


@dataclass(frozen=True, eq=False)
class Contrast:
    """A view beside its background, before it is said whether objects are bright or dark.

    background: the empty surface; threshold: the excess [grey levels] from which a pixel may belong to an object,
    above and below it; trims: whether glow and shadow can be told from objects; beyond: (h, w), 1 where another surface
    lies beside the table, None where there is none.
    """

    view: View
    background: EmptySurface
    bright_threshold: float
    dark_threshold: float
    trims: bool
    beyond: Image | None = None

    def threshold(self, polarity: str) -> float:
        """The excess from which a pixel may belong to an object of this polarity [grey levels]."""
        return self.bright_threshold if polarity == "bright" else self.dark_threshold

    def excess(self, polarity: str, window: Window) -> NDArray[np.float32]:
        """Grey levels by which the pixels of a window stand out from the background in this direction."""
        grey, level = self.view.smooth[window], self.background.at(window)
        return grey - level if polarity == "bright" else level - grey

    def energies(self) -> dict[str, float]:
        """For each polarity about the sum of the excess² of all pixels that may belong to objects, from a grid."""
        window = np.s_[::_GRID_PX, ::_GRID_PX]
        excess = self.excess("bright", window)[self.view.inside[window]]
        bright, dark = excess[excess > self.bright_threshold], excess[excess < -self.dark_threshold]
        return {"bright": float(bright @ bright) * _GRID_PX**2, "dark": float(dark @ dark) * _GRID_PX**2}


@dataclass(frozen=True, eq=False)
class Foreground:
    """The pixels that stand out as objects of one polarity do, by mask (H, W), 1 or 0; trim: part of an object's own
    excess below which a pixel at its rim is glow or shadow."""

    contrast: Contrast
    polarity: str
    mask: Image
    trim: float

    def excess(self, window: Window) -> NDArray[np.float32]:
        """By how much the pixels of a window stand out [grey levels]."""
        return self.contrast.excess(self.polarity, window)


def measure_contrast(view: View, method: str, fixed_threshold: int, threshold_sigma: float) -> Contrast:
    """Compare a view with its background by `method`: background, otsu or fixed."""
    if method == "background":
        return contrast_with(_fitted_background(view, threshold_sigma), view, threshold_sigma)
    threshold = _otsu(view) if method == "otsu" else float(fixed_threshold)
    grey = view.smooth[view.inside]
    above, below = grey[grey > threshold], grey[grey <= threshold]
    # The larger class is the background; half-way levels need a background level, not the threshold.
    level = float(np.median(below if below.size >= above.size else above))
    return Contrast(view, even_background(level, view.smooth.shape), threshold - level, level - threshold, trims=False)


def contrast_with(background: EmptySurface, view: View, threshold_sigma: float) -> Contrast:
    """Compare a view with a model of its empty surface."""
    limit = threshold_sigma * background.sigma
    return Contrast(view, background, limit, limit, trims=True)


def foreground(contrast: Contrast, polarity: str) -> Foreground:
    """The pixels that stand out as bright, or as dark, objects do."""
    bright, limit = polarity == "bright", contrast.threshold(polarity)
    level = contrast.background.at(np.s_[:, :], limit if bright else -limit)
    mask = contrast.view.smooth > level if bright else contrast.view.smooth < level
    mask &= contrast.view.inside
    if contrast.beyond is not None:
        mask &= contrast.beyond == 0
    return Foreground(contrast, polarity, mask.view(np.uint8), _TRIM[polarity] if contrast.trims else 0.0)


def _fitted_background(view: View, threshold_sigma: float) -> EmptySurface:
    """An even surface, unless objects of most grey levels could not be told from that."""
    even = fit_background(view.smooth, view.inside)
    if 2 * threshold_sigma * even.sigma <= MOST_LEVELS:
        return even
    return fit_uneven(view.smooth, view.inside, even) or even


def _otsu(view: View) -> float:
    grey = view.smooth[view.inside].round().astype(np.uint8)
    level, _ = cv2.threshold(grey, 0, 255, cv2.THRESH_BINARY + cv2.THRESH_OTSU)
    return float(level) + 0.5
