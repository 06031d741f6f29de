"""Stereo images on their way through the pipeline; a type is the proof that its step was done."""

from __future__ import annotations

from dataclasses import dataclass

import cv2

from stereo_pick.core import arrays
from stereo_pick.core.arrays import Image
from stereo_pick.core.errors import ImageError
from stereo_pick.core.rig import StereoRig


@dataclass(frozen=True, eq=False)
class StereoFrame:
    """A raw pair: left and right (H, W) grey or (H, W, 3) BGR, uint8, taken at the same time.

    Raises ImageError where an image is empty or of another type.
    """

    left: Image
    right: Image
    stamp_ns: int = 0

    def __post_init__(self) -> None:
        for side in ("left", "right"):
            try:
                object.__setattr__(self, side, arrays.image(f"{side} image", getattr(self, side)))
            except ValueError as error:
                raise ImageError(str(error)) from None


@dataclass(frozen=True, eq=False)
class RectifiedPair:
    """Rectified grey images (H, W) uint8 in which a point has the same row, and the rig they belong to."""

    left: Image
    right: Image
    rig: StereoRig
    stamp_ns: int = 0

    def __post_init__(self) -> None:
        for side, camera in (("left", self.rig.left), ("right", self.rig.right)):
            picture = getattr(self, side)
            check_size(f"rectified {side} image", picture, camera.frame_size)
            object.__setattr__(self, side, arrays.image(f"rectified {side} image", picture))


def grey(picture: Image) -> Image:
    """A grey (H, W) image of a grey or BGR one."""
    return picture if picture.ndim == 2 else cv2.cvtColor(picture, cv2.COLOR_BGR2GRAY)  # type: ignore[return-value]


def check_size(what: str, picture: Image, size_px: tuple[int, int]) -> None:
    """Raise ImageError unless the image has the calibration's width and height [px]."""
    height, width = picture.shape[:2]
    if (width, height) != size_px:
        raise ImageError(
            f"{what} is {width} x {height}, but the calibration is for {size_px[0]} x {size_px[1]}: "
            "calibrate at the resolution that the camera runs at"
        )
