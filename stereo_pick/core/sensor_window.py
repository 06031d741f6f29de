"""Drivers that deliver a part of a sensor's image, or combine its pixels: their camera_info are of the full image."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from stereo_pick.core.arrays import Floats
from stereo_pick.core.camera import Camera
from stereo_pick.core.errors import CalibrationError


@dataclass(frozen=True)
class SensorWindow:
    """The region of interest, in pixels of the full image (width and height 0: all of it), and how many of its pixels
    become one (0 as 1): as `roi`, `binning_x` and `binning_y` of a sensor_msgs/CameraInfo have it."""

    x_px: int
    y_px: int
    width_px: int
    height_px: int
    binning_x: int
    binning_y: int

    @staticmethod
    def of(info: Any) -> SensorWindow:
        """That of a camera_info message of ROS 1 or ROS 2."""
        roi = info.roi
        several = roi.x_offset, roi.y_offset, roi.width, roi.height, info.binning_x, info.binning_y
        return SensorWindow(*(int(each) for each in several))

    def of_raw(self, full: Camera) -> Camera:
        """The camera whose raw images are this window of a full one's; the rectified view, which it shares with that of
        another camera, stays as it is.

        Raises CalibrationError where the window reaches beyond the full image.
        """
        width_px, height_px = self._size_px(full)
        return replace(full, width_px=width_px, height_px=height_px, K=self._from_full @ full.K)

    def of_rectified(self, full: Camera) -> Camera:
        """The same of rectified images: the window is one of the rectified view."""
        return replace(self.of_raw(full), P=self._from_full @ full.P)

    def _size_px(self, full: Camera) -> tuple[int, int]:
        width_px, height_px = self.width_px or full.width_px, self.height_px or full.height_px
        if self.x_px + width_px > full.width_px or self.y_px + height_px > full.height_px:
            raise CalibrationError(
                f"{full.name} camera: its region of interest, {width_px} x {height_px} pixels at ({self.x_px}, "
                f"{self.y_px}), reaches beyond its image of {full.width_px} x {full.height_px}: width, height, K and P "
                "of a camera_info are those of the full image; leave roi empty if they are those of the region"
            )
        return width_px // max(self.binning_x, 1), height_px // max(self.binning_y, 1)

    @property
    def _from_full(self) -> Floats:
        """(3, 3): from pixels of the full image to those of the window."""
        across, down = max(self.binning_x, 1), max(self.binning_y, 1)
        x_px, y_px = self.x_px + (across - 1) / 2, self.y_px + (down - 1) / 2  # the middle of those that become one
        return np.array([[1 / across, 0.0, -x_px / across], [0.0, 1 / down, -y_px / down], [0.0, 0.0, 1.0]])
