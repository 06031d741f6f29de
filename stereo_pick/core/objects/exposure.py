"""Views that cannot show their objects, because they are too dark, saturated, or uneven.

All these reasons follow from what an object must do to be seen: differ from the background by a least contrast.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import cv2
import numpy as np

from stereo_pick.core.arrays import Image
from stereo_pick.core.camera import Camera
from stereo_pick.core.errors import ImageError
from stereo_pick.core.objects.blob import Blob
from stereo_pick.core.objects.view import View
from stereo_pick.core.rectified_view import valid_region

CLIPPED = 254  # grey level: one less than the highest, because rectification interpolates

_WHITE = 255.0
MOST_LEVELS = 0.5 * _WHITE  # so many grey levels are most of them
_BLACK = 16.0  # the highest grey level that cameras give for no light at all (ITU-R BT.601)
_BESIDE_PX = 4  # how far from the outline the background beside it is looked at
_ALL_OVER = (1.0, 99.0)  # percentiles: hot pixels and a lamp in a corner do not make a view show something
_LOST = 0.1  # part of an object's pixels that may be clipped where its background is: small high lights


def view_fault(view: View, blobs: Sequence[Blob], least_contrast: float) -> str:
    """Why a view cannot show all its objects: `too_dark`, `saturated`, `uneven`, or nothing.

    too_dark: nothing in it is brighter than cameras are without light; or it shows no object, and even what is wholly
    black would stand out from the background by less than least_contrast [grey levels]. The others are of a view that
    shows no object, too. saturated: more than half of it is as bright as it can get, and so would be brighter objects.
    uneven: objects of most grey levels would stand out by less.
    """
    grey = view.smooth[view.inside]
    if not grey.size:
        return ""
    if float(grey.max()) <= _BLACK:
        return "too_dark"
    if any(blob.fault != "faint" for blob in blobs):
        return ""
    level = float(np.median(grey))
    if level >= CLIPPED:
        return "saturated"
    if min(level + least_contrast, _WHITE) - max(level - least_contrast, 0.0) > MOST_LEVELS:
        return "uneven"
    return "too_dark" if level - min(_BLACK, float(grey.min())) < least_contrast else ""


def check_shows_something(side: str, image: Image, camera: Camera) -> None:
    """Raise ImageError for a rectified view (H, W) that is black all over, or as bright as it can get."""
    low, high = np.percentile(image[valid_region(camera)], _ALL_OVER)
    if high <= _BLACK:
        raise ImageError(
            f"the {side} view is black all over (99 % of it at grey level {high:.0f} or below), so there is nothing to "
            "learn: take the lens cap off, give light, or expose longer; 12-bit images in 16 bits need full_scale_16"
        )
    if low >= CLIPPED:
        raise ImageError(
            f"the {side} view is white all over (99 % of it at grey level {low:.0f} or above), so there is nothing to "
            "learn: shorten the exposure, or dim the light"
        )


def with_saturation(blobs: Sequence[Blob], image: Image) -> list[Blob]:
    """Refuse the objects that are clipped and lie on a clipped background: parts of their outline cannot be seen."""
    if not blobs or image.max() < CLIPPED:
        return list(blobs)
    return [replace(blob, fault="saturated") if _is_saturated(blob, image) else blob for blob in blobs]


def _is_saturated(blob: Blob, image: Image) -> bool:
    contour = np.round(blob.contour_px).astype(np.int32)
    low = np.maximum(contour.min(axis=0) - _BESIDE_PX, 0)
    high = contour.max(axis=0) + _BESIDE_PX + 1
    window = image[low[1] : high[1], low[0] : high[0]]
    filled = np.zeros(window.shape, np.uint8)
    cv2.drawContours(filled, [contour - low], -1, 1, cv2.FILLED)
    around = np.ones((2 * _BESIDE_PX + 1, 2 * _BESIDE_PX + 1), np.uint8)
    beside = np.asarray(cv2.dilate(filled, around)) > np.asarray(cv2.dilate(filled, np.ones((3, 3), np.uint8)))
    inside = window[np.asarray(cv2.erode(filled, np.ones((5, 5), np.uint8))) > 0]
    return _clipped(window[beside]) > 0.5 and _clipped(inside) > _LOST


def _clipped(grey: Image) -> float:
    """The part of some pixels that is clipped."""
    return float((grey >= CLIPPED).mean()) if grey.size else 0.0
