"""One rectified view, made ready for segmentation."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import cv2
import numpy as np
from numpy.typing import NDArray

from stereo_pick.core.arrays import Bools, Floats, Image, Ints
from stereo_pick.core.camera import Camera
from stereo_pick.core.rectified_view import valid_region

_SMOOTHING_PX = 0.8  # of the reduced view
_KERNEL = cv2.getGaussianKernel(7, _SMOOTHING_PX)
_VOID = 1e-3
_REDUCED_PX = 640 * 480  # objects are found on a view of at most about so many pixels ...
_MAX_REDUCTION = 3  # ... but one of min_area_px must still show there


@dataclass(frozen=True, eq=False)
class View:
    """image: (H, W), where edges are placed; smooth: (h, w) grey, reduced in size and in noise, where objects are
    found; inside: (h, w), where the raw image covers the view; core: the same less its outermost pixel;
    reduction: H / h."""

    image: Image
    smooth: NDArray[np.float32]
    inside: Bools
    core: Bools
    reduction: int

    @staticmethod
    def of(image: Image, camera: Camera, reduction: int | None = None) -> View:
        """Prepare one image (H, W) of a rectified pair."""
        if reduction is None:
            reduction = _reduction(camera)
        inside, core, rim, coverage = _masks(camera, reduction)
        small = _blurred(_reduced(np.asarray(cv2.bitwise_and(image, _mask(camera))), reduction))
        small.reshape(-1)[rim] /= coverage
        return View(image, small, inside, core, reduction)

    def nearest(self, points_px: Floats) -> tuple[Ints, Ints]:
        """Rows and columns (N,) of the reduced view's pixels next to points (N, 2) of the view itself [px]."""
        at = np.round((points_px + 0.5) / self.reduction - 0.5).astype(np.int64)
        columns, rows = np.clip(at, 0, np.array(self.smooth.shape[::-1]) - 1).T
        return rows, columns

    def full_px(self, reduced_px: Floats) -> Floats:
        """Points of the reduced view (..., 2) in the view itself [px]."""
        points: Floats = (reduced_px + 0.5) * self.reduction - 0.5
        return points


def _reduction(camera: Camera) -> int:
    factor = np.sqrt(camera.width_px * camera.height_px / _REDUCED_PX)
    return int(np.clip(round(factor), 1, _MAX_REDUCTION))


@lru_cache(maxsize=8)
def _masks(camera: Camera, reduction: int) -> tuple[Bools, Bools, Ints, NDArray[np.float32]]:
    """Inside and core of a reduced view; and the pixels at its rim (flat), with the part of each one's smoothing
    window that the raw image covers: the void around the image must not darken its rim."""
    covered = np.asarray(_reduced(_mask(camera), reduction) / np.float32(255), np.float32)
    inside = covered > 0.5
    least = cv2.erode(inside.astype(np.uint8), np.ones((3, 3), np.uint8), borderType=cv2.BORDER_CONSTANT, borderValue=0)
    coverage = _blurred(covered).reshape(-1)
    rim = np.flatnonzero((coverage > _VOID) & (coverage < 1 - _VOID))
    return inside, np.asarray(least, np.bool_), rim, coverage[rim]


@lru_cache(maxsize=8)
def _mask(camera: Camera) -> Image:
    return valid_region(camera).astype(np.uint8) * np.uint8(255)


def _reduced(image: Image, reduction: int) -> Image | NDArray[np.float32]:
    if reduction == 1:
        return image
    height, width = image.shape[0] // reduction, image.shape[1] // reduction
    whole = image[: height * reduction, : width * reduction].astype(np.float32)
    return np.asarray(cv2.resize(whole, (width, height), interpolation=cv2.INTER_AREA), np.float32)


def _blurred(grey: Image | NDArray[np.float32]) -> NDArray[np.float32]:
    blurred = cv2.sepFilter2D(grey, cv2.CV_32F, _KERNEL, _KERNEL, borderType=cv2.BORDER_CONSTANT)
    return np.asarray(blurred, np.float32)
