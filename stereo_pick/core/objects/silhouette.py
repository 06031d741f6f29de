"""Sub-pixel silhouettes: each contour point moved along its normal to where the surface ends."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from stereo_pick.core.arrays import Floats, Image
from stereo_pick.core.objects.edge_model import OFFSETS_PX, best_blur_px, find_edges

_REACH_PX = 4.0
_STEP_PX = 0.5
_COARSE_PX = np.arange(-_REACH_PX, _REACH_PX + 0.1, _STEP_PX)
_SIDE_PX = 1.5  # length of the outermost parts of a profile that show the levels outside and inside
_SMOOTHING_PX = 2.0
_MIN_POINTS = 16
_PROFILES_FOR_BLUR = 150


@dataclass(frozen=True, eq=False)
class Silhouette:
    """A closed contour: points_px (N, 2); sharpness (N,) of the edge at each, as `edge_model.Edges` has it."""

    points_px: Floats
    sharpness: Floats


def trace_silhouettes(image: Image, contours_px: Sequence[Floats], min_contrast: float) -> list[Silhouette]:
    """Move the points of contours (N, 2) [px] to the edge of the object that each runs along, one a pixel of length.

    A threshold near the background finds the whole object but puts its edge further out where the object is
    brighter. First each point goes to the half-way level of its own profile, then to the place where a blurred
    step with shading behind it explains the profile best. image: (H, W) grey levels; points whose two sides
    differ by less than min_contrast stay, and have no sharpness.
    """
    even = [resampled(contour) for contour in contours_px]
    even = [_moved(contour, offsets) for contour, offsets in zip(even, _half_way(image, even, min_contrast))]
    profiles = _profiles(image, even, OFFSETS_PX)
    profiles = np.concatenate([_smoothed(part) for part in _split(profiles, even)])
    blur_px = best_blur_px(profiles[:: max(1, len(profiles) // _PROFILES_FOR_BLUR)])
    edges = find_edges(profiles, blur_px)
    clear = np.ptp(profiles, axis=1) >= min_contrast
    places = _split(np.where(clear, edges.place_px, 0.0), even)
    sharpness = _split(np.where(clear, edges.sharpness, 0.0), even)
    return [Silhouette(_moved(contour, at), sharp) for contour, at, sharp in zip(even, places, sharpness)]


def resampled(contour_px: Floats) -> Floats:
    """A closed contour with a point each pixel of its length, without the steps of its pixels."""
    closed = np.concatenate([contour_px, contour_px[:1]])
    along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(closed, axis=0), axis=1))])
    at = np.linspace(0.0, along[-1], max(int(along[-1]), _MIN_POINTS), endpoint=False)
    even = np.stack([np.interp(at, along, closed[:, axis]) for axis in (0, 1)], axis=1)
    return _smoothed(even)


def _moved(contour_px: Floats, inward_px: Floats) -> Floats:
    moved: Floats = contour_px + inward_px[:, None] * inward_normals(contour_px)
    return moved


def _half_way(image: Image, contours_px: Sequence[Floats], min_contrast: float) -> list[Floats]:
    """Offset (N,) [px, inwards] of each point to the half-way level between both ends of its profile."""
    profiles = _profiles(image, contours_px, _COARSE_PX)
    side = round(_SIDE_PX / _STEP_PX) + 1
    outside, inside = np.median(profiles[:, :side], axis=1), np.median(profiles[:, -side:], axis=1)
    contrast = inside - outside
    relative = (profiles - outside[:, None]) / np.where(np.abs(contrast) < min_contrast, np.inf, contrast)[:, None]
    return _split(_crossing(relative), contours_px)


def _profiles(image: Image, contours_px: Sequence[Floats], offsets_px: Floats) -> Floats:
    """Grey levels (sum N, M) along the inward normals of all contours, bilinear."""
    points = np.concatenate(contours_px)
    inward = np.concatenate([inward_normals(contour) for contour in contours_px])
    at = (points[:, None] + offsets_px[None, :, None] * inward[:, None]).astype(np.float32)
    grey = cv2.remap(image, at[..., 0], at[..., 1], cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
    return np.asarray(grey, np.float64)


def inward_normals(contour_px: Floats) -> Floats:
    """Unit normals (N, 2) of a closed contour that point inwards."""
    smooth = _smoothed(contour_px)
    tangent = np.roll(smooth, -2, axis=0) - np.roll(smooth, 2, axis=0)
    tangent /= np.linalg.norm(tangent, axis=1, keepdims=True) + 1e-9
    x, y = contour_px.T
    turns_left = float(x @ np.roll(y, -1) - y @ np.roll(x, -1)) > 0
    normal: Floats = np.stack([-tangent[:, 1], tangent[:, 0]], axis=1) * (1 if turns_left else -1)
    return normal


def _smoothed(values: Floats) -> Floats:
    """Values (N, M) along a closed contour, each averaged with its neighbours."""
    reach = int(3 * _SMOOTHING_PX)
    kernel = np.exp(-0.5 * (np.arange(-reach, reach + 1) / _SMOOTHING_PX) ** 2)
    wrapped = np.take(values, np.arange(-reach, len(values) + reach), axis=0, mode="wrap")
    smooth = cv2.filter2D(wrapped, cv2.CV_64F, (kernel / kernel.sum())[:, None], borderType=cv2.BORDER_REPLICATE)
    return np.asarray(smooth[reach:-reach])


def _split(values: NDArray[np.float64], contours_px: Sequence[Floats]) -> list[Floats]:
    return np.split(values, np.cumsum([len(contour) for contour in contours_px])[:-1])


def _crossing(relative: Floats) -> Floats:
    """Offset (N,) [px] where profiles (0 outside, 1 inside) first rise above one half; 0 where they do not."""
    above = relative >= 0.5
    after = np.argmax(above, axis=1)
    found = (after > 0) & above.any(axis=1)
    after = np.where(found, after, 1)
    row = np.arange(len(relative))
    low, high = relative[row, after - 1], relative[row, after]
    span = np.where(high > low, high - low, 1.0)
    return np.where(found, _COARSE_PX[after - 1] + (0.5 - low) / span * _STEP_PX, 0.0)
