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
    in_left = [pose.apply(result.board.object_points()) for view, pose in zip(result.views, result.solution.poses)]
    xyz = np.concatenate(in_left)
    seen = [np.concatenate([getattr(view, side) for view in result.views]) for side in ("left_px", "right_px")]
    return (
        Corners(seen[0], left.project(xyz) - seen[0]),
        Corners(seen[1], right.project(right_T_left.apply(xyz)) - seen[1]),
    )


def typical_view(result: CalibrationResult) -> BoardView:
    """The used pair that fits as well as half of the others: neither the best nor the worst to show."""
    errors_px = [math.hypot(view.left_px, view.right_px) for view in result.used]
    return result.views[int(np.argsort(errors_px)[len(errors_px) // 2])]
