"""How sharply an outline is seen: out of focus, the place of an edge is anybody's guess."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from stereo_pick.core.arrays import Floats, Image, Ints
from stereo_pick.core.objects.blob import Blob
from stereo_pick.core.objects.edge_model import BLURS_PX
from stereo_pick.core.sampling import places_along, sampled

MAX_BLUR_PX = BLURS_PX[-1]
"""One sigma; through more, the profile in which `edge_model` looks for the edge no longer shows what is outside."""

_OFFSETS_PX = np.arange(-8.0, 8.1, 1.0)
_CHORD = 3  # points of the outline to both sides that give its direction
_STRIDE = 2  # one in so many points of the outline is looked at
_ARC = 3  # of them are seen together, against noise
_SHARPEST = 0.1  # part of the outline: shadows and rounded limbs are soft in every picture
_NEAR_PX = np.arange(-4.0, 4.1, 0.5)
_NEAR_ARC = 2  # points to both sides
_CLEAR, _CLEAREST = 0.5, 0.9
_OF_LENS = 0.2  # part of the clear edges of a view that are no softer than the lens makes them


def blur_px(blob: Blob, image: Image) -> float:
    """The blur (one sigma) of the sharpest parts of an outline; image: (H, W), in which the blob was found.

    A step seen through a Gaussian blur rises by `step / (blur √(2π))` a pixel where it is steepest.
    """
    profiles = _profiles(blob.contour_px, image)
    steepest = np.abs(np.diff(profiles, axis=1)).max(axis=1)
    rise_px = (profiles.max(axis=1) - profiles.min(axis=1)) / np.maximum(steepest, 1e-9)
    sharpest = int(_SHARPEST * len(rise_px))
    return float(np.partition(rise_px, sharpest)[sharpest] / np.sqrt(2 * np.pi))


def is_out_of_focus(blobs: Sequence[Blob], image: Image) -> bool:
    """Whether no part of any of these outlines is sharp enough to be placed.

    Where a lens is in focus for some parts of a view, a soft outline is one along which light fades; that is known
    from its sharpness.
    """
    return bool(blobs) and all(blur_px(blob, image) > MAX_BLUR_PX for blob in blobs)


def local_blur_px(contours_px: Sequence[Floats], image: Image) -> tuple[Floats, Floats]:
    """The blur (N,) [px, one sigma] at each point of some outlines, and the step (N,) [grey levels] there."""
    profiles = _across(contours_px, image, _NEAR_PX)
    around = [_further(contours_px, by) for by in range(-_NEAR_ARC, _NEAR_ARC + 1)]
    mean = np.mean([profiles[each] for each in around], axis=0)
    steepest = np.abs(mean[:, 2:] - mean[:, :-2]).max(axis=1)  # a pixel apart
    step = mean.max(axis=1) - mean.min(axis=1)
    return step / np.maximum(steepest, 1e-9) / np.sqrt(2 * np.pi), step


def lens_blur_px(contours_px: Sequence[Floats], image: Image) -> float:
    """The blur of the lens, by the clearest edges of a view: what is softer has its own reason."""
    blur_px, step = local_blur_px(contours_px, image)
    return float(np.quantile(blur_px[step >= _CLEAR * np.quantile(step, _CLEAREST)], _OF_LENS))


def normals(contours_px: Sequence[Floats]) -> Floats:
    """Unit normals (N, 2) at the points of some outlines, all to the same side of each outline's way."""
    points = np.concatenate(contours_px)
    x, y = (points[_further(contours_px, _CHORD)] - points[_further(contours_px, -_CHORD)]).T
    return np.asarray(np.stack([-y, x], axis=1) / (np.hypot(x, y) + 1e-9)[:, None])


def _profiles(contour_px: Floats, image: Image) -> Floats:
    """Grey levels (N, len(_OFFSETS_PX)) across the outline, each the mean over an arc of it."""
    grey = _across([contour_px], image, _OFFSETS_PX)[::_STRIDE]
    whole = max(1, len(grey) // _ARC) * _ARC
    return np.asarray(grey[:whole].reshape(-1, min(_ARC, len(grey)), grey.shape[1]).mean(axis=1))


def _across(contours_px: Sequence[Floats], image: Image, offsets_px: Floats) -> Floats:
    """Grey levels (N, M) across outlines of N points."""
    points, across = np.concatenate(contours_px), normals(contours_px)
    return sampled(image, places_along(points, across, offsets_px))


def _further(contours_px: Sequence[Floats], by: int) -> Ints:
    """The index (N,) of the point that lies `by` points further along the same outline."""
    counts = np.array([len(contour) for contour in contours_px])
    first, count = np.repeat(np.cumsum(counts) - counts, counts), np.repeat(counts, counts)
    return np.asarray(first + (np.arange(len(first)) - first + by) % count)
