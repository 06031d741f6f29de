"""What is dark beside a bright object: its shadow, its own dark side, or another object that touches it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import cv2
import numpy as np

from stereo_pick.core.objects.blob import Blob, Blobs
from stereo_pick.core.objects.foreground import Contrast

BESIDE_PX = 5.0
"""Between two outlines that touch: the blur of both."""

_OF_SHADOW = 0.5  # of the light of the table, that a soft shadow takes away
_HIGH_LIGHT = 0.5  # of a dark object's area, at most


def with_others(found: Blobs, others: Blobs) -> Blobs:
    """The objects found, and those of the other polarity; dark ones beside a bright one are faulty."""
    dark, bright = (found, others) if found.polarity == "dark" else (others, found)
    dark = replace(dark, left=_shades(dark.left, bright.left), right=_shades(dark.right, bright.right))
    return replace(dark, others=bright) if found.polarity == "dark" else replace(bright, others=dark)


def without_shadows(dark: Sequence[Blob], bright: Sequence[Blob], contrast: Contrast) -> tuple[Blob, ...]:
    """The dark blobs of a view but those beside a bright one that take away no more light than its shadow does."""
    return tuple(
        blob
        for blob in dark
        if blob.peak > _OF_SHADOW * _level(blob, contrast) or not any(are_beside(blob, each) for each in bright)
    )


def is_high_light(bright: Blob, dark: Blob) -> bool:
    """Whether a bright blob is a small place on a dark one."""
    outline = dark.contour_px.astype(np.float32)
    inside = all(cv2.pointPolygonTest(outline, (x, y), False) >= 0 for x, y in bright.contour_px[::4].tolist())
    return inside and bright.area_px2 < _HIGH_LIGHT * dark.area_px2


def are_beside(one: Blob, other: Blob, reach_px: float = BESIDE_PX) -> bool:
    """Whether two outlines come as near to each other as this."""
    outline = other.contour_px
    low, high = outline.min(axis=0) - reach_px, outline.max(axis=0) + reach_px
    near = one.contour_px[((one.contour_px > low) & (one.contour_px < high)).all(axis=1)]
    return any(float(np.hypot(*(outline - point).T).min()) < reach_px for point in near)


def _level(blob: Blob, contrast: Contrast) -> float:
    """Grey level of the background where a blob is."""
    (row,), (column,) = contrast.view.nearest(blob.centroid_px[None])
    return float(contrast.background.at(np.s_[row : row + 1, column : column + 1])[0, 0])


def _shades(dark: Sequence[Blob], bright: Sequence[Blob]) -> tuple[Blob, ...]:
    """The dark blobs of a view; faulty beside a bright one, unless that is a high light on one of them."""
    objects = [blob for blob in bright if not any(is_high_light(blob, each) for each in dark)]
    return tuple(_faulty(blob) if any(are_beside(blob, each) for each in objects) else blob for blob in dark)


def _faulty(blob: Blob) -> Blob:
    return replace(blob, fault=blob.fault if blob.fault not in ("", "merged") else "beside_bright")
