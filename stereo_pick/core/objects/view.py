"""One rectified view, made ready for segmentation."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import cv2
import numpy as np
from numpy.typing import NDArray

from stereo_pick.core.arrays import Bools, Image
from stereo_pick.core.camera import Camera
from stereo_pick.core.rectified_view import valid_region

_SMOOTHING_PX = 0.8
_EDGE_SMOOTHING_PX = 0.5


@dataclass(frozen=True, eq=False)
class View:
    """smooth: (H, W) grey, noise reduced, for finding objects; sharp: (H, W) grey, for placing their edges;
    inside: (H, W), where the raw image covers the rectified one; core: the same less its outermost pixel."""

    smooth: NDArray[np.float32]
    sharp: NDArray[np.float32]
    inside: Bools
    core: Bools

    @staticmethod
    def of(image: Image, camera: Camera) -> View:
        """Prepare one image (H, W) of a rectified pair."""
        inside = valid_region(camera)
        masked = np.where(inside, image, 0).astype(np.float32)
        return View(
            smooth=_blurred(masked, _SMOOTHING_PX) / _coverage(camera, _SMOOTHING_PX),
            sharp=_blurred(masked, _EDGE_SMOOTHING_PX) / _coverage(camera, _EDGE_SMOOTHING_PX),
            inside=inside,
            core=_core(camera),
        )


@lru_cache(maxsize=8)
def _coverage(camera: Camera, sigma_px: float) -> NDArray[np.float32]:
    """What part of each pixel's smoothing window the raw image covers: the void around it must not darken the rim."""
    return np.maximum(_blurred(valid_region(camera).astype(np.float32), sigma_px), np.float32(1e-3))


@lru_cache(maxsize=8)
def _core(camera: Camera) -> Bools:
    mask = valid_region(camera).astype(np.uint8)
    less = cv2.erode(mask, np.ones((3, 3), np.uint8), borderType=cv2.BORDER_CONSTANT, borderValue=0)
    return np.asarray(less, np.bool_)


def _blurred(grey: NDArray[np.float32], sigma_px: float) -> NDArray[np.float32]:
    return np.asarray(cv2.GaussianBlur(grey, (0, 0), sigma_px, borderType=cv2.BORDER_CONSTANT), np.float32)
