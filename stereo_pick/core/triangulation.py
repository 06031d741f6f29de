"""Triangulation (thesis 3.9): two rays of one point to its position.

All positions are in the left camera's own (raw) optical frame. On a verged rig the rectified frame is turned
against it by several degrees; ROS's image_pipeline stamps points of the rectified frame with the raw frame's name.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from stereo_pick.core.arrays import Floats, Ints, floats, frozen
from stereo_pick.core.correspondence import Correspondences
from stereo_pick.core.params import Configurable, parameter
from stereo_pick.core.rays import closest_points
from stereo_pick.core.refusal import Refusal
from stereo_pick.core.rig import StereoRig

_STEP_PX = 0.01


@dataclass(frozen=True, eq=False)
class Points:
    """N positions in the left camera's optical frame.

    xyz: (N, 3) [m]; covariance: (N, 3, 3) [m²]; ray_gap: (N,), distance of the two rays [m];
    row: (N,), the row of `Correspondences` each came from; tolerance_m: how far off one may be for the pick to succeed;
    refused: all that gave no position, so far; min_confidence: the least with which one is to be published.
    """

    xyz: Floats
    covariance: Floats
    ray_gap: Floats
    row: Ints
    tolerance_m: float
    refused: tuple[Refusal, ...] = ()
    min_confidence: float = 0.0

    def __post_init__(self) -> None:
        count = len(self.row)
        for name, shape in (("xyz", (count, 3)), ("covariance", (count, 3, 3)), ("ray_gap", (count,))):
            object.__setattr__(self, name, floats(name, np.reshape(getattr(self, name), shape), *shape))
        object.__setattr__(self, "row", frozen(np.array(self.row, np.int64)))

    def __len__(self) -> int:
        return len(self.row)


@dataclass(frozen=True)
class Triangulator(Configurable):
    """Turns correspondences into positions, and refuses those whose rays do not meet."""

    max_ray_gap_m: float = parameter(
        0.010, "Distance of the two rays of a point from which it is refused.", low=0.0001, high=1.0
    )
    tolerance_m: float = parameter(
        0.005,
        "How far off a position may be for the pick to succeed; confidence is the probability that it is no farther "
        "off.",
        low=0.0001,
        high=0.1,
    )
    min_confidence: float = parameter(
        0.0,
        "Confidence from which an object gets a pose; what has less is refused (low_confidence). Poses alone do not "
        "carry theirs: set it, as to 0.99, where a controller reads nothing else.",
        low=0.0,
        high=1.0,
    )

    def triangulate(self, correspondences: Correspondences, rig: StereoRig) -> Points:
        """Return the positions whose rays meet in front of both cameras within max_ray_gap_m."""
        if len(correspondences) == 0:
            none = np.zeros(0)
            return Points(none, none, none, none.astype(np.int64), self.tolerance_m, correspondences.refused)
        left_px, right_px = correspondences.left_px, correspondences.right_px
        left, right = closest_points(rig.left.rays(left_px), rig.right.rays(right_px), rig.right_T_left)
        gap = np.linalg.norm(left - right, axis=1)
        behind = (left[:, 2] <= 0) | (rig.right_T_left.apply(right)[:, 2] <= 0)
        apart = ~behind & (gap > self.max_ray_gap_m)
        row = np.flatnonzero(~behind & ~apart)
        refused = (
            *correspondences.refused,
            *(
                Refusal("behind_camera", left_px[i], right_px[i], f"z = {left[i, 2]:.3f} m")
                for i in np.flatnonzero(behind)
            ),
            *(Refusal("ray_gap", left_px[i], right_px[i], f"{gap[i] * 1000:.1f} mm") for i in np.flatnonzero(apart)),
        )
        covariance = _covariance(left_px, right_px, correspondences.sigma_px, rig)
        covariance = covariance + rig.left.R.T @ correspondences.covariance @ rig.left.R
        middle = (left + right)[row] / 2
        return Points(middle, covariance[row], gap[row], row, self.tolerance_m, refused, self.min_confidence)


def _covariance(left_px: Floats, right_px: Floats, sigma_px: Floats, rig: StereoRig) -> Floats:
    """Covariance (N, 3, 3) [m²] of the mid-points from the image points' sigma, to first order."""
    columns = []
    for side in (0, 1):
        for axis in (0, 1):
            step = np.zeros(2)
            step[axis] = _STEP_PX
            ahead, behind = (_mid_points(left_px, right_px, side, sign * step, rig) for sign in (1, -1))
            columns.append((ahead - behind) / (2 * _STEP_PX) * sigma_px[:, [side]])
    jacobian = np.stack(columns, axis=-1)
    return np.asarray(jacobian @ jacobian.transpose(0, 2, 1))


def _mid_points(left_px: Floats, right_px: Floats, side: int, step: Floats, rig: StereoRig) -> Floats:
    moved = (left_px + step, right_px) if side == 0 else (left_px, right_px + step)
    left, right = closest_points(rig.left.rays(moved[0]), rig.right.rays(moved[1]), rig.right_T_left)
    return (left + right) / 2
