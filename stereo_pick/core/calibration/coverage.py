"""Which part of the images and which tilts the views cover."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np

from stereo_pick.core.arrays import Floats
from stereo_pick.core.calibration.refinement import StereoSolution
from stereo_pick.core.calibration.views import BoardView


@dataclass(frozen=True)
class Coverage:
    """What the views cover.

    left_area, right_area: the share of each image within the corners' convex hull; tilt_deg: the largest angle between
    the board's normals of any two views; depth_m: nearest and farthest distance of a board along the left optical axis.
    """

    left_area: float
    right_area: float
    tilt_deg: float
    depth_m: tuple[float, float]


def coverage(views: tuple[BoardView, ...], solution: StereoSolution, centre_m: Floats) -> Coverage:
    """Measure it; centre_m: the middle (3,) [m] of the board in its own frame."""
    width, height = solution.size_px
    corners_px = [np.concatenate([getattr(view, side) for view in views]) for side in ("left_px", "right_px")]
    left, right = (cv2.contourArea(cv2.convexHull(px.astype(np.float32))) / (width * height) for px in corners_px)
    normals = np.array([pose.rotation[:, 2] for pose in solution.poses])
    depths = [float(pose.apply(centre_m)[2]) for pose in solution.poses]
    tilt = np.degrees(np.arccos(np.clip(normals @ normals.T, -1, 1).min()))
    return Coverage(float(left), float(right), float(tilt), (min(depths), max(depths)))
