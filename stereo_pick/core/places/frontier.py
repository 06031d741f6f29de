"""The frontier points of an object: where an epipolar plane touches it, both cameras see the same point of it
(Porrill and Pollard 1991). In rectified views these are the top and the bottom of its outlines."""

from __future__ import annotations

import numpy as np

from stereo_pick.core.arrays import Floats
from stereo_pick.core.objects import Blob
from stereo_pick.core.rig import StereoRig
from stereo_pick.core.shapes.table import Table

_END_PX = 1.5  # of an outline, whose middle is where the plane touches
_MARGIN = 0.2  # of the height of the upper point
_LEAST_HEIGHT = 0.1  # of the upper point above the table, by the object's width


def frontier_m(left: Blob, right: Blob, rig: StereoRig) -> Floats:
    """The upper and the lower frontier point (2, 3) [m], rectified left frame, of an object with these outlines."""
    points = []
    for end in (0, 1):
        u_left, u_right = (_column_px(blob, end) for blob in (left, right))
        row = (left.rows_px[end] + right.rows_px[end]) / 2
        x_left = u_left - rig.left.P[0, 2]
        depth = rig.focal_px * rig.baseline_m / max(x_left - u_right + rig.right.P[0, 2], 1e-6)
        points.append([x_left * depth / rig.focal_px, (row - rig.left.P[1, 2]) * depth / rig.focal_px, depth])
    return np.array(points)


def reaches_down(left: Blob, right: Blob, rig: StereoRig, table: Table) -> bool:
    """Whether outlines end as low as those of a whole object on a table do.

    Its lowest point seen is no higher, by its upper one, than a ball's. The lit top of a part, the sides of which do
    not show, ends where it begins: high above the table.
    """
    points = frontier_m(left, right, rig)
    upper_m, lower_m = table.height_m(points)
    ahead = points.mean(axis=0) / np.linalg.norm(points.mean(axis=0))
    across = float(np.sqrt(max(1 - (ahead @ table.normal) ** 2, 0)))  # 1 from level, 0 from straight above
    of_ball = (1 - across) / (1 + across)
    width_m = _width_m(left, points, rig)
    return bool(upper_m > _LEAST_HEIGHT * width_m and lower_m < (of_ball + _MARGIN) * upper_m)


def stands_up(left: Blob, right: Blob, rig: StereoRig, table: Table) -> bool:
    """Whether the upper point of an object with these outlines is above the table."""
    points = frontier_m(left, right, rig)
    return bool(table.height_m(points)[0] > _LEAST_HEIGHT * _width_m(left, points, rig))


def _width_m(left: Blob, points: Floats, rig: StereoRig) -> float:
    return left.rectangle[1] * float(points[:, 2].mean()) / rig.focal_px


def _column_px(blob: Blob, end: int) -> float:
    at_end = np.abs(blob.contour_px[:, 1] - blob.rows_px[end]) < _END_PX
    return float(blob.contour_px[at_end, 0].mean())
