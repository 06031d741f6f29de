"""Grey levels between pixels."""

from __future__ import annotations

from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from stereo_pick.core.arrays import Floats, Image

_MOST = 32_000  # rows that OpenCV's remap can fill at once, less than 2¹⁵
_ALL_IN_ONE = np.empty(0, np.float32)  # no second map: the first one holds both coordinates


def sampled(image: Image, points_px: Floats | NDArray[np.float32]) -> Floats:
    """Bilinear grey levels (N, M) of an image (H, W) at points (N, M, 2) [px]; beyond it, those of its border."""
    return remapped(image, points_px).astype(np.float64)


def places_along(
    points_px: Floats | NDArray[np.float32], ways: Floats | NDArray[np.float32], at_px: Floats | NDArray[np.float32]
) -> NDArray[np.float32]:
    """The places (N, M, 2) so far (M,) [px] along ways (N, 2) from points (N, 2), as `remapped` takes them."""
    places = np.empty((len(points_px), len(at_px), 2), np.float32)
    for axis in (0, 1):  # each by itself: an innermost axis of two is hardly any work for NumPy's loops
        places[..., axis] = points_px[:, axis, None] + at_px * ways[:, axis, None]
    return places


def remapped(
    image: NDArray[Any],
    points_px: Floats | NDArray[np.float32],
    beyond: int = cv2.BORDER_REPLICATE,
    between: int = cv2.INTER_LINEAR,
) -> NDArray[Any]:
    """The same (N, M) of an image (H, W) in its own type; what is beyond it as by this one of OpenCV's border types,
    what is between pixels by this one of its interpolations."""
    places = points_px.astype(np.float32, copy=False)
    parts = [
        cv2.remap(image, places[first : first + _MOST], _ALL_IN_ONE, between, borderMode=beyond)
        for first in range(0, len(places), _MOST)
    ]
    if not parts:
        return np.empty(places.shape[:2], image.dtype)
    return np.concatenate(parts) if len(parts) > 1 else parts[0]
