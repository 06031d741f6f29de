"""Rectification (thesis 3.7.3): raw pairs to pairs whose epipolar lines are the rows."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from stereo_pick.core.frames import RectifiedPair, StereoFrame, check_size, grey
from stereo_pick.core.rectified_view import rectification_maps
from stereo_pick.core.rig import StereoRig

Maps = tuple[NDArray[np.float32], NDArray[np.float32]]


class Rectifier:
    """Resamples raw pairs into the rig's rectified view; the maps are made once."""

    def __init__(self, rig: StereoRig) -> None:
        self.rig = rig
        self._left: Maps = rectification_maps(rig.left)
        self._right: Maps = rectification_maps(rig.right)

    def rectify(self, frame: StereoFrame) -> RectifiedPair:
        """Return the rectified grey pair; raises ImageError where an image is not of the calibration's size."""
        check_size("left image", frame.left, self.rig.left.frame_size)
        check_size("right image", frame.right, self.rig.right.frame_size)
        left, right = (
            cv2.remap(grey(picture), *maps, cv2.INTER_LINEAR, borderMode=cv2.BORDER_CONSTANT)
            for picture, maps in ((frame.left, self._left), (frame.right, self._right))
        )
        return RectifiedPair(left, right, self.rig, frame.stamp_ns)  # type: ignore[arg-type]
