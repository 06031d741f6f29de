"""Grey levels between pixels."""

from __future__ import annotations

import cv2
import numpy as np

from stereo_pick.core.arrays import Floats, Image

_MOST = 32_000  # rows that OpenCV's remap can fill at once, less than 2¹⁵


def sampled(image: Image, points_px: Floats) -> Floats:
    """Bilinear grey levels (N, M) of an image (H, W) at points (N, M, 2) [px]; beyond it, those of its border."""
    u, v = np.moveaxis(points_px.astype(np.float32), -1, 0)
    parts = [slice(first, first + _MOST) for first in range(0, len(u), _MOST)]
    grey = [cv2.remap(image, u[p], v[p], cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE) for p in parts]
    return np.asarray(np.concatenate(grey) if grey else np.empty(u.shape), np.float64)
