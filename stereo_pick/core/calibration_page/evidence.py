"""The used views once more, each corner with where the result puts it."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from stereo_pick.core.arrays import Floats
from stereo_pick.core.calibration.result import CalibrationResult
from stereo_pick.core.calibration.views import BoardView


@dataclass(frozen=True, eq=False)
class Corners:
    """Corners of all used views in one image: where they were seen (N, 2) [px], and from there to the model (N, 2)."""

    seen_px: Floats
    residuals_px: Floats


def corners(result: CalibrationResult) -> tuple[Corners, Corners]:
    """Those of the left and of the right image."""
    left, right, right_T_left = result.solution.cameras
    xyz, seen_px = list[Floats](), list[Floats]()
    for side in (0, 1):
        in_left = [pose.apply(v.points(result.board)[side]) for v, pose in zip(result.views, result.solution.poses)]
        xyz.append(np.concatenate(in_left))
        seen_px.append(np.concatenate([view.corners_px[side] for view in result.views]))
    return (
        Corners(seen_px[0], left.project(xyz[0]) - seen_px[0]),
        Corners(seen_px[1], right.project(right_T_left.apply(xyz[1])) - seen_px[1]),
    )


def typical_view(result: CalibrationResult) -> BoardView:
    """The used pair that fits as well as half of the others: neither the best nor the worst to show."""
    errors_px = [math.hypot(view.left_px, view.right_px) for view in result.used]
    return result.views[int(np.argsort(errors_px)[len(errors_px) // 2])]
