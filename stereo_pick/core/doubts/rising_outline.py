"""What outlines show beside a solid that rises from the table: more of the object, as a bottle's neck, and no shadow.

Where an outline crosses a row in both views, it does so at one place, the side of an object apart: of what lies on the
table the disparity is the table's there, of what rises it is more.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from stereo_pick.core.arrays import Bools, Floats, Ints
from stereo_pick.core.camera import Camera
from stereo_pick.core.objects import Blob
from stereo_pick.core.objects.blob import SHARP
from stereo_pick.core.places.position import BlobPair
from stereo_pick.core.rig import StereoRig
from stereo_pick.core.shapes.predicted import inside
from stereo_pick.core.shapes.sight import normalized
from stereo_pick.core.shapes.solid_fit import SolidFit
from stereo_pick.core.shapes.table import Table
from stereo_pick.core.windows.table_windows import Windows
from stereo_pick.core.windows.window_planes import of_table, off_px, sigma_on_table_px

_CLEAR_PX = 1.5  # of silhouettes: further off than edges are placed wrongly
_RISES_PX, _SIGMAS = 1.0, 3.0  # of disparity, above the table's, and of that
_AGREE_PX, _LEAST = 1.0, 3  # crossings that rise alike: the limb of a ball is another one to each camera


class _Crossings(NamedTuple):
    """Where an outline crosses rows of pixels: which (N,) row, twice, and one more where it does so downwards; and the
    columns (N,) [px]."""

    which: Ints
    columns: Floats


def rises_beside(blobs: BlobPair, solids: Sequence[SolidFit], rig: StereoRig, table: Table) -> bool:
    """Whether an object's outlines show something clear of all these solids that rises from the table."""
    polygons = zip(*(fit.silhouettes(rig) for fit in solids))
    one, other = (
        _crossings(blob, _is_clear(blob, camera, several))
        for blob, camera, several in zip(blobs, (rig.left, rig.right), polygons)
    )
    which, at, there = np.intersect1d(one.which, other.which, return_indices=True)
    windows = Windows(np.c_[one.columns[at], which // 2], one.columns[at] - other.columns[there])
    above_px = off_px(of_table(table, rig, 1.0), windows)
    open_px = _SIGMAS * sigma_on_table_px(windows, table, rig, 1.0)
    rising_px = np.sort(above_px[above_px > open_px + _RISES_PX])
    agree = np.searchsorted(rising_px, rising_px + _AGREE_PX) - np.arange(len(rising_px))
    return int(agree.max(initial=0)) >= _LEAST


def _is_clear(blob: Blob, camera: Camera, polygons: Sequence[Floats]) -> Bools:
    """Which points (N,) of an outline are sharp, as far as that was measured, and clear of silhouettes (K, 2),
    normalized."""
    points = normalized(blob.contour_px, camera)[None]
    clear = blob.sharpness >= SHARP if len(blob.sharpness) else np.zeros(len(blob.contour_px), np.bool_)
    for polygon in polygons:
        clear &= inside(points, polygon[None])[0] * camera.P[0, 0] < -_CLEAR_PX
    return np.asarray(clear, np.bool_)


def _crossings(blob: Blob, shown: Bools) -> _Crossings:
    """Where those points of an outline that are shown cross rows, but for rows crossed there more than once alike."""
    (x, y), (next_x, next_y) = blob.contour_px.T, np.roll(blob.contour_px, -1, axis=0).T
    row = np.ceil(np.minimum(y, next_y))
    crosses = shown & np.roll(shown, -1) & (row < np.maximum(y, next_y))
    share = (row - y)[crosses] / (next_y - y)[crosses]
    columns = x[crosses] + share * (next_x - x)[crosses]
    which = 2 * row[crosses].astype(np.int64) + (next_y > y)[crosses]
    once, at, counts = np.unique(which, return_index=True, return_counts=True)
    return _Crossings(once[counts == 1], columns[at[counts == 1]])
