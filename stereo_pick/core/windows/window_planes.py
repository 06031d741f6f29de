"""Planes that windows of two views agree on.

On a plane in space the disparity is a linear function of the pixel: a `plane` (3,) is disparity by column, row and 1,
in pixels of the reduced views.
"""

from __future__ import annotations

import numpy as np

from stereo_pick.core.arrays import Bools, Floats
from stereo_pick.core.rig import StereoRig
from stereo_pick.core.shapes.sight import normalized
from stereo_pick.core.shapes.table import EDGE_ON, Table
from stereo_pick.core.windows.table_windows import Windows

_TOLERANCE_PX = 0.5  # from a plane
_ROUNDS = 3


def planes_through(windows: Windows, triples: int, apart_px: float) -> Floats:
    """The planes (P, 3) through three windows each, as far as these span more than a triangle so wide.

    triples: how many are drawn, the same ones of the same windows.
    """
    rows = windows.rows
    chosen = np.random.default_rng(0).integers(len(rows), size=(triples, 3))
    chosen = chosen[np.abs(np.linalg.det(rows[chosen])) > apart_px**2]
    return np.asarray(np.linalg.solve(rows[chosen], windows.disparity_px[chosen][..., None])[..., 0], np.float64)


def off_px(planes: Floats, windows: Windows) -> Floats:
    """By how much (P, N) the disparities of windows are more than those of planes (P, 3)."""
    return np.asarray(windows.disparity_px - planes @ windows.rows.T, np.float64)


def agree_on(plane: Floats, windows: Windows) -> Bools:
    """Which windows (N,) lie on a plane; or (P, N), of planes (P, 3)."""
    return np.asarray(np.abs(off_px(plane, windows)) < _TOLERANCE_PX, np.bool_)


def lie_below(planes: Floats, windows: Windows) -> Bools:
    """Which windows (P, N) lie clearly further away than planes (P, 3)."""
    return np.asarray(off_px(planes, windows) < -2 * _TOLERANCE_PX, np.bool_)


def refitted(plane: Floats, windows: Windows) -> tuple[Floats, Bools]:
    """The plane moved to the middle of the windows that agree on it, and which (N,) these are."""
    for _ in range(_ROUNDS):
        near = windows.those(agree_on(plane, windows))
        plane = np.asarray(np.linalg.lstsq(near.rows, near.disparity_px, rcond=None)[0], np.float64)
    return plane, agree_on(plane, windows)


def as_table(plane: Floats, rig: StereoRig, scale: float, middle_px: Floats, sigma_px: float) -> Table | None:
    """The plane as one in space; None where it would be seen edge-on, or from behind.

    Disparity is focal length x baseline / depth, and a constant. sigma_px: of the disparity of the whole view at a
    place (2,) of the reduced one.
    """
    column, row, one = plane
    half = (column + row) / 2  # pixel centres are whole numbers in both
    constant_px = half + (one - half) / scale
    left, right = rig.left.P, rig.right.P
    apart_px = left[0, 2] - right[0, 2]
    at_centre = column * left[0, 2] + row * left[1, 2] + constant_px - apart_px
    across = np.array([column * left[0, 0], row * left[1, 1], at_centre])
    length = float(np.linalg.norm(across))
    normal = -across / length
    if normal[2] > -EDGE_ON:
        return None
    offset_m = rig.focal_px * rig.baseline_m / length
    depth_m = -offset_m / float(normal @ np.append(normalized(middle_px / scale, rig.left), 1.0))
    return Table(normal, offset_m, sigma_px * depth_m * offset_m / (rig.focal_px * rig.baseline_m))


def of_table(table: Table, rig: StereoRig, scale: float) -> Floats:
    """The plane (3,) of a table, in views of that scale: the other way round."""
    left, right = rig.left.P, rig.right.P
    across = -table.normal * rig.focal_px * rig.baseline_m / table.offset_m
    column, row = across[0] / left[0, 0], across[1] / left[1, 1]
    constant_px = across[2] - column * left[0, 2] - row * left[1, 2] + left[0, 2] - right[0, 2]
    half = (column + row) / 2
    return np.array([column, row, half + scale * (constant_px - half)])


def sigma_on_table_px(windows: Windows, table: Table, rig: StereoRig, scale: float) -> Floats:
    """Sigma (N,) of the disparity of windows on a table, in views of that scale, by that of its height."""
    apart_px = scale * (rig.left.P[0, 2] - rig.right.P[0, 2])
    return np.asarray((windows.disparity_px - apart_px) * table.sigma_m / table.offset_m, np.float64)
