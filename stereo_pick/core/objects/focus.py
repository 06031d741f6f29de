"""How sharply an outline is seen: out of focus, the place of an edge is anybody's guess."""

from __future__ import annotations

from collections.abc import Sequence

import cv2
import numpy as np

from stereo_pick.core.arrays import Floats, Image
from stereo_pick.core.objects.blob import Blob
from stereo_pick.core.objects.edge_model import BLURS_PX

MAX_BLUR_PX = BLURS_PX[-1]
"""One sigma; through more, the profile in which `edge_model` looks for the edge no longer shows what is outside."""

_OFFSETS_PX = np.arange(-8.0, 8.1, 1.0)
_CHORD = 3  # points of the outline to both sides that give its direction
_STRIDE = 2  # one in so many points of the outline is looked at
_ARC = 3  # of them are seen together, against noise
_SHARPEST = 0.1  # part of the outline: shadows and rounded limbs are soft in every picture


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


def _profiles(contour_px: Floats, image: Image) -> Floats:
    """Grey levels (N, len(_OFFSETS_PX)) across the outline, each the mean over an arc of it."""
    around = np.take(contour_px, np.arange(-_CHORD, len(contour_px) + _CHORD), axis=0, mode="wrap")
    x, y = (around[2 * _CHORD :: _STRIDE] - around[: -2 * _CHORD : _STRIDE]).T
    points = contour_px[::_STRIDE]
    across = np.stack([-y, x], axis=1) / (np.hypot(x, y) + 1e-9)[:, None]
    u, v = ((points[:, axis, None] + _OFFSETS_PX * across[:, axis, None]).astype(np.float32) for axis in (0, 1))
    grey = np.asarray(cv2.remap(image, u, v, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE), np.float64)
    whole = max(1, len(grey) // _ARC) * _ARC
    return np.asarray(grey[:whole].reshape(-1, min(_ARC, len(grey)), grey.shape[1]).mean(axis=1))
