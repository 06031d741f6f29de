"""Whether outlines lie on one plane: those of prints on the table, or of the top of a part that is all that shows.

The disparities along outlines on a plane are a linear function of the pixel (Faugeras 1993). So are those along the
silhouette of a ball, nearly, but that plane faces the cameras; a table and the tops of what stands on it do not, unless
the cameras look straight down.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from stereo_pick.core.arrays import Floats
from stereo_pick.core.objects import Blob
from stereo_pick.core.rig import StereoRig
from stereo_pick.core.shapes.table import Table

FLAT_PX = 0.2  # distance of outlines from those of a plane, as two edges' noise allows
_ROWS = 24
_EDGE_PX = 2.0  # rows at the top and at the bottom, where an outline runs along the row, tell no disparity ...
_EDGE = 0.2  # ... but of what is low, no more than this part
_LEAST_PX = 4 * _EDGE_PX  # height of what tells by itself whether it is flat
FACING = np.cos(np.deg2rad(20))  # of a plane's normal and the line of sight, from which on a round body's is as flat


@dataclass(frozen=True, eq=False)
class Sides:
    """Where rows cross both outlines (in the rectified views) of an object, N times.

    terms: (N, 3), of which its disparities (N,) [px] are a linear function if it is flat; weight: (N,), less where an
    outline runs along its row, so that a residual counts as far as it is across the outline.
    """

    terms: Floats
    disparity_px: Floats
    weight: Floats

    @staticmethod
    def of(left: Blob, right: Blob, rig: StereoRig) -> Sides:
        """Those of the outlines of one object; none where no row crosses both."""
        top, bottom = _common_rows_px(left, right)
        if bottom <= top:
            return Sides(np.zeros((0, 3)), np.zeros(0), np.zeros(0))
        edge_px = min(_EDGE_PX, _EDGE * (bottom - top))
        rows = np.linspace(top + edge_px, bottom - edge_px, _ROWS)
        u_left, u_right = _crossings(left.contour_px, rows), _crossings(right.contour_px, rows)
        slopes = np.gradient(np.stack([u_left, u_right]), rows, axis=2)
        focal, (cx, cy) = rig.focal_px, rig.left.P[:2, 2]
        across = u_left.ravel() - cx
        terms = np.stack([across, np.tile(rows - cy, 2), np.full(2 * _ROWS, focal)], axis=1)
        return Sides(terms, across - (u_right.ravel() - rig.right.P[0, 2]), 1 / (1 + (slopes**2).mean(axis=0).ravel()))

    def off_px(self, plane: Floats) -> float:
        """By how much these outlines, as a root mean square, differ from those of what lies on a plane (3,)."""
        if not len(self.weight):
            return np.inf
        return float(np.sqrt(np.mean(self.weight * (self.terms @ plane - self.disparity_px) ** 2)))


def common_plane(several: Sequence[Sides]) -> Floats:
    """The plane (3,), by which the `terms` make disparities, that is nearest to the outlines of all: its normal, in the
    rectified left frame, and as long as the baseline is of its distance."""
    terms, disparity_px, weight = (
        np.concatenate([getattr(each, name) for each in several]) for name in ("terms", "disparity_px", "weight")
    )
    root = np.sqrt(weight)
    plane, *_ = np.linalg.lstsq(terms * root[:, None], disparity_px * root, rcond=None)
    return np.asarray(plane)


def plane_with(normal: Floats, sides: Sides) -> Floats:
    """The plane (3,) with this normal (3,) that is nearest to these outlines, as `common_plane` has it."""
    on_it = sides.terms @ normal
    square = float((sides.weight * on_it) @ on_it)
    return normal * (float((sides.weight * sides.disparity_px) @ on_it) / square if square else 0.0)


def plane_of(table: Table, rig: StereoRig) -> Floats:
    """The plane (3,) of a table, as `common_plane` has it."""
    return np.asarray(-table.normal * rig.baseline_m / table.offset_m, np.float64)


def height_m(plane: Floats, table: Table, rig: StereoRig) -> float:
    """How high above a table a plane (3,) lies that has its normal."""
    return table.offset_m + rig.baseline_m / float(plane @ table.normal)


def shows_one_face(left: Blob, right: Blob, rig: StereoRig) -> bool:
    """Whether the outlines (in the rectified views) are those of one flat face that is tilted from facing the left
    camera, and nothing else of its body shows."""
    top, bottom = _common_rows_px(left, right)
    if bottom - top < _LEAST_PX:
        return False
    sides = Sides.of(left, right, rig)
    plane = common_plane([sides])
    ahead = np.append((left.centroid_px - rig.left.P[:2, 2]) / rig.focal_px, 1.0)
    cosine = abs(float(plane @ ahead)) / float(np.linalg.norm(plane) * np.linalg.norm(ahead))
    return sides.off_px(plane) < FLAT_PX and cosine < FACING


def _common_rows_px(left: Blob, right: Blob) -> tuple[float, float]:
    return max(left.rows_px[0], right.rows_px[0]), min(left.rows_px[1], right.rows_px[1])


def _crossings(contour_px: Floats, rows: Floats) -> Floats:
    """Columns (2, R) of the leftmost, and of the rightmost crossings of a closed contour with rows (R,)."""
    ahead = np.roll(contour_px, -1, axis=0)
    v, v_ahead = contour_px[:, 1], ahead[:, 1]
    crosses = (v[:, None] <= rows) != (v_ahead[:, None] <= rows)
    share = (rows - v[:, None]) / np.where(crosses, (v_ahead - v)[:, None], 1.0)
    u = contour_px[:, :1] + share * (ahead[:, :1] - contour_px[:, :1])
    return np.stack([np.where(crosses, u, np.inf).min(axis=0), np.where(crosses, u, -np.inf).max(axis=0)])
