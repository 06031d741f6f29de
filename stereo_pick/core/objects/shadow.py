"""Shadows cut off objects: a shadow fades at its rim, an object ends at once."""

from __future__ import annotations

from collections.abc import Iterator

import cv2
import numpy as np

from stereo_pick.core.objects.blob import Blob
from stereo_pick.core.objects.foreground import Contrast
from stereo_pick.core.objects.outline import parts

_MAY_FADE = 0.05  # part of an outline that may fade before a shadow is looked for
_MAY_BE_NOTCHED = 0.05
_MUST_GAIN = 0.5


def may_hold_shadow(blob: Blob) -> bool:
    """Whether so much of the outline fades that it is worth looking for a shadow in it."""
    return blob.fading > _MAY_FADE


def strongest_parts(blob: Blob, contrast: Contrast, polarity: str, min_area_px: int) -> Iterator[Blob]:
    """The pieces of a blob (its contour in the view's pixels) that stand out most, by Otsu's threshold inside it."""
    view = contrast.view
    contour = np.round((blob.contour_px + 0.5) / view.reduction - 0.5).astype(np.int32)
    x, y, width, height = cv2.boundingRect(contour)
    x, y = max(x, 0), max(y, 0)
    excess = contrast.excess(polarity, np.s_[y : y + height, x : x + width])
    member = np.zeros(excess.shape, np.uint8)
    cv2.drawContours(member, [contour], -1, 1, cv2.FILLED, offset=(-x, -y))
    inside = excess[member.view(np.bool_)]
    top = float(inside.max(initial=0.0))
    if top <= 0:
        return
    grey = np.clip(inside * (255 / top), 0, 255).astype(np.uint8)
    level, _ = cv2.threshold(grey, 0, 255, cv2.THRESH_BINARY + cv2.THRESH_OTSU)
    member &= excess > level / 255 * top
    yield from parts(view, member, excess, (x, y), min_area_px)


def clearer(parts: list[Blob], whole: Blob) -> bool:
    """Whether what is left without the shadow fades much less at its rim than the whole did, and has no notches.

    Glossy stripes along the rim of a part would be cut away like a shadow.
    """
    if not parts or max(part.concavity for part in parts) > max(whole.concavity, _MAY_BE_NOTCHED):
        return False
    points = sum(len(part.contour_px) for part in parts)
    faded = sum(part.fading * len(part.contour_px) for part in parts) / points
    return faded < (1 - _MUST_GAIN) * whole.fading
