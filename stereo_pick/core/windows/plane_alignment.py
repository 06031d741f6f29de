"""A plane moved until what both views show of it is the same, finer than windows one by one say where they are.

A window of a plane that is seen at an angle is sheared in the other view, and where in it its edges are says how far
it seems to be off. Here the right view is warped by the plane first; what is left over is the step (Lucas and Kanade
1981).
"""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import cv2
import numpy as np

from stereo_pick.core.arrays import Floats
from stereo_pick.core.noise import noise_dn
from stereo_pick.core.rig import StereoRig
from stereo_pick.core.shapes.table import Table
from stereo_pick.core.windows.table_windows import Windows
from stereo_pick.core.windows.window import Grey
from stereo_pick.core.windows.window_planes import as_table

_ROUNDS, _REWEIGHTED = 6, 5
_LEAST = 8  # windows
_ALIKE = 0.7  # correlation
_REACH_PX, _NARROWING, _LEAST_REACH_PX = 1.0, 0.6, 0.24
_PLACED_PX = 0.03  # sigma of the best of windows
_SPREAD_PX = 0.02  # the least
_MAX_GAIN = 2.0  # of one camera over the other
_SIGMAS = 3.0  # what light does to marks is no noise
_TINY = 1e-9


class Alignment(NamedTuple):
    """plane: (3,), disparity by column, row and 1; covariance: (3, 3), as windows scatter about it."""

    plane: Floats
    covariance: Floats

    def table(self, middle: Floats, rig: StereoRig, scale: float, least_px: float) -> Table | None:
        """The plane in space; None where it would be seen edge-on. middle: (3,), row of the place at which its sigma
        is asked for; scale: of the views; least_px: sigma of its disparity, if nothing scatters."""
        sigma_px = np.hypot(_SIGMAS * np.sqrt(middle @ self.covariance @ middle), least_px) / scale
        table = as_table(self.plane, rig, scale, middle[:2], float(sigma_px))
        if table is None:
            return None
        slope = _SIGMAS * float(np.sqrt(self.covariance[:2, :2].trace() / 2))
        return replace(table, tilt_rad=float(np.hypot(table.tilt_rad, slope * table.offset_m / rig.baseline_m)))


def aligned(left: Grey, right: Grey, plane: Floats, windows: Windows, grid: tuple[int, int, int]) -> Alignment | None:
    """The plane on which the views (h, w), of zero mean, agree best at those windows; None where few do.

    grid: how wide, high and far apart the windows are [px].
    """
    wide_px, high_px, stride_px = grid
    rows = windows.rows
    for round_ in range(_ROUNDS):
        off_px, sigma_px, alike = off_plane(left, right, plane, windows, (wide_px, high_px))
        near = (np.abs(off_px) < max(_REACH_PX * _NARROWING**round_, _LEAST_REACH_PX)) & (alike > _ALIKE)
        if near.sum() < _LEAST:
            return None
        step, covariance = _fitted(rows[near], off_px[near], sigma_px[near])
        plane = plane + step
    overlap = max(1.0, wide_px * high_px / stride_px**2)  # windows that share pixels are not so many
    return Alignment(plane, covariance * overlap)


def off_plane(
    left: Grey, right: Grey, plane: Floats, windows: Windows, size_px: tuple[int, int]
) -> tuple[Floats, Floats, Floats]:
    """By how much (N,) the disparity of windows is more than the plane's, the sigma of that, and how alike they are."""
    height, width = left.shape
    column, row = np.meshgrid(np.arange(width, dtype=np.float32), np.arange(height, dtype=np.float32))
    moved = column - (plane[0] * column + plane[1] * row + plane[2]).astype(np.float32)
    warped = cv2.remap(right, moved, row, cv2.INTER_CUBIC)
    slope = cv2.filter2D(warped, -1, np.array([[-0.5, 0, 0.5]], np.float32))
    x, y = windows.centre_px.astype(int).T

    def summed(product: Grey) -> Floats:
        return np.asarray(cv2.boxFilter(product, -1, size_px, normalize=False)[y, x], np.float64)

    both, own, other = summed(left * warped), summed(warped * warped), summed(left * left)
    slopes = np.maximum(summed(slope * slope), _TINY)
    gain = np.clip(both / np.maximum(own, _TINY), 1 / _MAX_GAIN, _MAX_GAIN)
    off_px = (gain * summed(warped * slope) - summed(left * slope)) / (gain * slopes)
    sigma_px = np.hypot(noise_dn(left) / np.sqrt(slopes), _PLACED_PX)
    return off_px, sigma_px, both / np.sqrt(np.maximum(own * other, _TINY))


def _fitted(rows: Floats, off_px: Floats, sigma_px: Floats) -> tuple[Floats, Floats]:
    """The plane (3,) through most of these, and its covariance (3, 3)."""
    weight = sigma_px**-2
    for _ in range(_REWEIGHTED):
        normal = (rows * weight[:, None]).T @ rows
        step = np.asarray(np.linalg.solve(normal, (rows * weight[:, None]).T @ off_px), np.float64)
        left_px = off_px - rows @ step
        spread_px = max(1.4826 * float(np.median(np.abs(left_px))), _SPREAD_PX)
        weight = sigma_px**-2 / (1 + (left_px / (2 * spread_px)) ** 2)  # Cauchy's
    scatter = float(weight @ left_px**2) / max(len(rows) - 3, 1)
    return step, np.asarray(np.linalg.inv((rows * weight[:, None]).T @ rows) * scatter, np.float64)
