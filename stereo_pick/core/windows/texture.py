"""How well a window can be placed by what it shows, foretold from the gradient and the noise of one view."""

from __future__ import annotations

import cv2
import numpy as np

from stereo_pick.core.arrays import Floats
from stereo_pick.core.windows.window import Grey, window_at

_WIDENING = 1.5


def window_sizes(narrowest_px: int, widest_px: int) -> list[int]:
    """Odd widths from the narrowest to the widest, each about one and a half times the one before it [px]."""
    sizes = [narrowest_px]
    while sizes[-1] < widest_px:
        sizes.append(min(widest_px, int(sizes[-1] * _WIDENING) // 2 * 2 + 1))
    return sizes


def predicted_sigma_px(image: Grey, sigma_dn: float, window_px: int, cost: str) -> Grey:
    """Sigma (H, W) of the place of a window around each pixel, found in another view of the same noise [px].

    It is the Cramer-Rao bound: noise over root of the sum of the squared gradients, of which the noise's own share
    is taken off. Where the cost forgives an offset, an even slope of grey levels does not fix the place.
    """
    gradient = cv2.filter2D(image, -1, np.array([[-0.5, 0, 0.5]], np.float32), borderType=cv2.BORDER_REPLICATE)
    size = (window_px, window_px)
    energy = cv2.sqrBoxFilter(gradient, -1, size, borderType=cv2.BORDER_REFLECT) - sigma_dn**2 / 2
    if cost == "zncc":
        energy -= cv2.boxFilter(gradient, -1, size, borderType=cv2.BORDER_REFLECT) ** 2
    with np.errstate(divide="ignore"):
        return np.asarray(sigma_dn * np.sqrt(2 / np.maximum(energy, 0)) / window_px, np.float32)


def predicted_sigma_at(image: Grey, point_px: Floats, sigma_dn: float, window_px: int, cost: str) -> float:
    """The same for the window around one point (2,) [px]."""
    middle = window_px // 2 + 1
    patch = window_at(image, point_px, 2 * middle + 1)
    return float(predicted_sigma_px(patch, sigma_dn, window_px, cost)[middle, middle])
