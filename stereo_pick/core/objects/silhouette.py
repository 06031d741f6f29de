"""Sub-pixel silhouettes: each contour point moved along its normal to where the grey level crosses half-way."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from stereo_pick.core.arrays import Floats

_STEP_PX = 0.25
_OUTSIDE_PX = np.arange(-3.0, -1.9, _STEP_PX)
_INSIDE_PX = np.arange(1.5, 3.1, _STEP_PX)
_OFFSETS_PX = np.arange(-3.0, 3.1, _STEP_PX)
_SMOOTHING_PX = 2.0
_MIN_POINTS = 16


def refine_contour(image: NDArray[np.float32], contour_px: Floats, min_contrast: float) -> Floats:
    """Move contour points (N, 2) [px] to the half-way level between object and background next to them.

    A threshold near the background finds the whole object but puts its edge further out where the
    object is brighter; the half-way crossing does not. image: (H, W) grey; points whose two sides
    differ by less than min_contrast [grey levels] stay.
    """
    if len(contour_px) < _MIN_POINTS:
        return contour_px
    inward = _inward_normals(contour_px)
    profiles = _sample(image, contour_px, inward)
    outside = np.median(profiles[:, : len(_OUTSIDE_PX)], axis=1)
    inside = np.median(profiles[:, -len(_INSIDE_PX) :], axis=1)
    contrast = inside - outside
    relative = (profiles - outside[:, None]) / np.where(np.abs(contrast) < min_contrast, np.inf, contrast)[:, None]
    moved: Floats = contour_px + _crossing(relative)[:, None] * inward
    return moved


def _inward_normals(contour_px: Floats) -> Floats:
    """Unit normals (N, 2) of a closed contour, smoothed over a few points, pointing inwards."""
    reach = int(3 * _SMOOTHING_PX)
    kernel = np.exp(-0.5 * (np.arange(-reach, reach + 1) / _SMOOTHING_PX) ** 2)
    wrapped = np.concatenate([contour_px[-reach:], contour_px, contour_px[:reach]])
    smooth = np.stack([np.convolve(axis, kernel / kernel.sum(), "valid") for axis in wrapped.T], axis=1)
    tangent = np.roll(smooth, -2, axis=0) - np.roll(smooth, 2, axis=0)
    tangent /= np.linalg.norm(tangent, axis=1, keepdims=True) + 1e-9
    x, y = contour_px.T
    turns_left = float(x @ np.roll(y, -1) - y @ np.roll(x, -1)) > 0
    normal: Floats = np.stack([-tangent[:, 1], tangent[:, 0]], axis=1) * (1 if turns_left else -1)
    return normal


def _sample(image: NDArray[np.float32], contour_px: Floats, inward: Floats) -> Floats:
    """Grey levels (N, M) along the normals, bilinear."""
    at = (contour_px[:, None] + _OFFSETS_PX[None, :, None] * inward[:, None]).astype(np.float32)
    sampled = cv2.remap(image, at[..., 0], at[..., 1], cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
    return np.asarray(sampled, np.float64)


def _crossing(relative: Floats) -> Floats:
    """Offset (N,) [px] where profiles (0 outside, 1 inside) first rise above one half; 0 where they do not."""
    above = relative >= 0.5
    after = np.argmax(above, axis=1)
    found = (after > 0) & above.any(axis=1)
    after = np.where(found, after, 1)
    row = np.arange(len(relative))
    low, high = relative[row, after - 1], relative[row, after]
    span = np.where(high > low, high - low, 1.0)
    return np.where(found, _OFFSETS_PX[after - 1] + (0.5 - low) / span * _STEP_PX, 0.0)
