"""The thesis's closed forms for cameras that hardly turn (1.7), on a rig that turns as its own does."""

from __future__ import annotations

import cv2
import numpy as np
from formatting import Row, decimals, markdown_table
from thesis_printed import WORK_M

from stereo_pick.core.arrays import Floats
from stereo_pick.core.rays import closest_points
from stereo_pick.core.rig import StereoRig
from stereo_pick.core.transform import Transform

_POINTS_M = WORK_M * np.array([(x, y, 1.0) for x in (-0.1, 0.0, 0.1) for y in (-0.1, 0.0, 0.1)])


def parallel(x_1: Floats, y_1: Floats, x_2: Floats, baseline_m: float) -> Floats:
    """Eq. 1.34 to 1.36, (N, 3) [m], with f = 1: cameras side by side, axes parallel."""
    Z = baseline_m / (x_1 - x_2)
    return np.stack([x_1 * Z, y_1 * Z, Z], axis=1)


def turned_about_y(x_1: Floats, y_1: Floats, x_2: Floats, baseline_m: float, theta: float) -> Floats:
    """Eq. 1.37 to 1.39: the axes meet at Z0 = b / tan theta, the image planes are taken as parallel."""
    Z = baseline_m / (x_1 - x_2 + np.tan(theta))
    return np.stack([x_1 * Z, y_1 * Z, Z], axis=1)


def turned_about_x(x_1: Floats, y_1: Floats, x_2: Floats, baseline_m: float, phi: float) -> Floats:
    """Eq. 1.40 to 1.42: Z as for parallel cameras, and tan phi Z added to Y."""
    return parallel(x_1, y_1, x_2, baseline_m) + np.outer(baseline_m / (x_1 - x_2), (0, np.tan(phi), 0))


def approximation_table(rig: StereoRig) -> str:
    """Errors of the closed forms and of eq. 3.21, without noise, at points around the middle of the view."""
    turn = np.abs(cv2.Rodrigues(rig.right_T_left.rotation)[0].ravel())
    b = rig.baseline_m
    rows: list[Row] = []
    for name, axis, closed in (
        ("parallel cameras, eq. 1.34 to 1.36", (0.0, 0.0, 0.0), lambda *seen: parallel(*seen, b)),
        ("right camera turned about Y, eq. 1.37 to 1.39", (0.0, -turn[1], 0.0),
         lambda *seen: turned_about_y(*seen, b, turn[1])),
        ("right camera turned about X, eq. 1.40 to 1.42", (turn[0], 0.0, 0.0),
         lambda *seen: turned_about_x(*seen, b, turn[0])),
    ):  # fmt: skip
        left_T_right = Transform(cv2.Rodrigues(np.array(axis))[0], np.array([b, 0.0, 0.0]))
        left, right = _normalized(_POINTS_M), _normalized(left_T_right.inverse().apply(_POINTS_M))
        on_left, on_right = closest_points(left, right, left_T_right.inverse())
        errors = (closed(left[:, 0], left[:, 1], right[:, 0]), (on_left + on_right) / 2)
        rows.append([name, f"{np.degrees(np.linalg.norm(axis)):.1f}°", *(_worst_mm(each) for each in errors)])
    return markdown_table(["", "turned by", "closed form: worst error in X, Y, Z mm", "eq. 3.21"], rows)


def _normalized(points: Floats) -> Floats:
    return np.asarray(points / points[:, 2:])


def _worst_mm(found_m: Floats) -> str:
    return ", ".join(decimals(mm, 1) for mm in np.abs(found_m - _POINTS_M).max(axis=0) * 1000)
