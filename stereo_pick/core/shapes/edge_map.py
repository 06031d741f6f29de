"""How much of a solid's predicted silhouette the images show as edges, of whichever sign."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from stereo_pick.core.arrays import Bools, Floats, Image
from stereo_pick.core.camera import Camera

_BLUR = cv2.getGaussianKernel(7, 0.8).ravel()
_SMOOTH = np.convolve(_BLUR, [0.25, 0.5, 0.25])
_SLOPE = np.convolve(_BLUR, [-0.5, 0.0, 0.5])
_CLEAR = 5.0  # sigmas of the gradient from which it is an edge
_STEP_PX = 0.5
_SAMPLED = 4  # every so many pixels for the noise
_LEAST_NOISE = 0.1  # grey levels a pixel: rounding alone
_CHUNK = 16000  # remap takes no longer rows


@dataclass(frozen=True, eq=False)
class EdgeMap:
    """The gradient of a rectified view: x, y (H, W) [grey levels/px]; noise: one sigma where there are no edges."""

    x: NDArray[np.float32]
    y: NDArray[np.float32]
    noise: float
    camera: Camera

    @staticmethod
    def of(image: Image, camera: Camera) -> EdgeMap:
        """Differentiate a view (H, W)."""
        x = cv2.sepFilter2D(image, cv2.CV_32F, _SLOPE, _SMOOTH)
        y = cv2.sepFilter2D(image, cv2.CV_32F, _SMOOTH, _SLOPE)
        typical = float(np.median(np.abs(x[::_SAMPLED, ::_SAMPLED])))
        return EdgeMap(
            np.asarray(x, np.float32), np.asarray(y, np.float32), max(1.4826 * typical, _LEAST_NOISE), camera
        )

    def shows(self, points_px: Floats, normals: Floats, reach_px: float) -> Bools:
        """Whether there is an edge across these normals (N, 2), so near to each point (N, 2) of a closed line."""
        reach = np.arange(-reach_px, reach_px + _STEP_PX / 2, _STEP_PX)
        parts = [slice(i, i + _CHUNK) for i in range(0, len(points_px), _CHUNK)]
        strength = np.concatenate([self._across(points_px[part], normals[part], reach) for part in parts])
        return np.asarray(strength > _CLEAR * self.noise)

    def _across(self, points_px: Floats, normals: Floats, reach_px: Floats) -> Floats:
        at = (points_px[:, None] + reach_px[:, None] * normals[:, None]).astype(np.float32)
        x = cv2.remap(self.x, at[..., 0], at[..., 1], cv2.INTER_LINEAR)
        y = cv2.remap(self.y, at[..., 0], at[..., 1], cv2.INTER_LINEAR)
        slope = x * normals[:, :1] + y * normals[:, 1:]
        along = cv2.blur(slope, (1, 3), borderType=cv2.BORDER_REPLICATE)  # an edge goes on beside the point
        return np.asarray(np.abs(along).max(axis=1), np.float64)
