"""Both cameras, their distance and all board poses at once (thesis 3.4.2: bundle adjustment).

`cv2.stereoCalibrate` minimises the same sum, but where it ends depends on the OpenCV version: on
data/vigir2023_puma 4.6 ends at 0.537 px and 4.14, after its 100 iterations, at 0.631 px. This
Levenberg-Marquardt ends at the minimum, and its normal matrix says how sure the result is.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np

from stereo_pick.core.arrays import Floats
from stereo_pick.core.calibration.boards import Chessboard
from stereo_pick.core.calibration.mono import MonoCalibration
from stereo_pick.core.calibration.views import BoardView
from stereo_pick.core.camera import Camera
from stereo_pick.core.errors import CalibrationError
from stereo_pick.core.transform import Transform

# The parameters: fx fy cx cy k1 k2 p1 p2 of left and right, rvec and tvec right_T_left, then of each left_T_board.
_LEFT, _RIGHT, _EXTRINSICS, _SHIFT, _POSES = slice(0, 8), slice(8, 16), slice(16, 22), slice(19, 22), 22
_MAX_STEPS = 200
_EPS = 1e-9


@dataclass(frozen=True)
class StereoSolution:
    """Cameras and `right_T_left` [m] at the minimum.

    errors_px (V, 2): rms distance [px] of each view's left and right corners; rms_px: over all corners;
    sigma (22 + 6 V,): standard deviations of the parameters; baseline_sigma_m [m].
    """

    left: Camera
    right: Camera
    right_T_left: Transform
    errors_px: Floats
    baseline_sigma_m: float

    @property
    def rms_px(self) -> float:
        """Rms distance [px] over all corners of both cameras."""
        return float(np.sqrt(np.mean(self.errors_px**2)))
