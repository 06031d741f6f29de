"""Sub-pixel silhouettes: each contour point moved along its normal to where the surface ends."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from stereo_pick.core.arrays import Floats, Image
from stereo_pick.core.objects.edge_model import OFFSETS_PX, best_blur_px, find_edges
from stereo_pick.core.objects.rings import Rings
from stereo_pick.core.sampling import places_along, sampled

_REACH_PX = 4.0
_STEP_PX = 0.5
_COARSE_PX = np.arange(-_REACH_PX, _REACH_PX + 0.1, _STEP_PX)
_SIDE = 4  # outermost samples of a profile that show the levels outside and inside
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
    rings = Rings.of(contours_px)
    normals = rings.inward_normals()
    rings = rings.at(rings.points_px + _half_way(image, rings.points_px, normals, min_contrast)[:, None] * normals)
    normals = rings.inward_normals()
    profiles = rings.smoothed(_profiles(image, rings.points_px, normals, OFFSETS_PX))
    blur_px = best_blur_px(profiles[:: max(1, len(profiles) // _PROFILES_FOR_BLUR)])
    edges = find_edges(profiles, blur_px, rings.numbers())
    clear = profiles.max(axis=1) - profiles.min(axis=1) >= min_contrast
    points = rings.points_px + np.where(clear, edges.place_px, 0.0)[:, None] * normals
    sharpness = np.where(clear, edges.sharpness, 0.0)
    return [Silhouette(*traced) for traced in zip(rings.split(points), rings.split(sharpness))]


def _half_way(image: Image, points_px: Floats, inward: Floats, min_contrast: float) -> Floats:
    """Offset (N,) [px, inwards] of each point to the half-way level between both ends of its profile."""
    profiles = _profiles(image, points_px, inward, _COARSE_PX)
    outside, inside = _middle(profiles[:, :_SIDE]), _middle(profiles[:, -_SIDE:])
    contrast = inside - outside
    relative = (profiles - outside[:, None]) / np.where(np.abs(contrast) < min_contrast, np.inf, contrast)[:, None]
    return _crossing(relative)


def _profiles(image: Image, points_px: Floats, inward: Floats, offsets_px: Floats) -> Floats:
    """Grey levels (N, M) along the inward normals (N, 2) of points (N, 2), bilinear."""
    return sampled(image, places_along(points_px, inward, offsets_px))


def _middle(levels: Floats) -> Floats:
    """Median (N,) of _SIDE levels each."""
    levels = np.sort(levels, axis=1)
    return np.asarray(levels[:, (_SIDE - 1) // 2 : _SIDE // 2 + 1].mean(axis=1))


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
