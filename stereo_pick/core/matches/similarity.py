"""How alike an object of the left view and one of the right view are."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from stereo_pick.core.arrays import Floats
from stereo_pick.core.objects import Blob
from stereo_pick.core.objects.blob import CUT

_BEYOND_PX = 1.0  # by which the outline reaches beyond a cut where its end is the object's
_ROUGHLY = 0.5  # of what the area of a cut object tells
_LEAST_AREA_PX2 = 1e-6  # of what is but a line

_ROWS_PX, _OF_HEIGHT, _AREA_RATIO = 3.0, 2.0, 4.0  # by how much pieces of one object may differ


@dataclass(frozen=True)
class Similarity:
    """By how much an object may differ between the views.

    epipolar_tolerance_px and shape_tolerance (a part of the height): in its top, bottom and centroid row;
    max_area_ratio: in its area; disparities_px: least and greatest `u_left - u_right`.
    """

    epipolar_tolerance_px: float
    shape_tolerance: float
    max_area_ratio: float
    disparities_px: tuple[float, float]

    def of_pieces(self) -> Similarity:
        """By how much pieces of an object may differ that each view shows: those that are lit, or not hidden."""
        return Similarity(_ROWS_PX, _OF_HEIGHT, _AREA_RATIO, self.disparities_px)

    def costs(self, left: Sequence[Blob], right: Sequence[Blob]) -> Floats:
        """Cost (N, M) of every pair: 0 alike, 1 barely possible, inf impossible.

        Where an epipolar plane touches an object it touches it for both cameras, so in the rectified views an
        object has the same top and bottom row whatever its shape; its area is nearly the same.
        """
        one, other = _features(left)[:, None], _features(right)[None]
        height = np.minimum(one[..., 1] - one[..., 0], other[..., 1] - other[..., 0])
        tolerance = self.epipolar_tolerance_px + self.shape_tolerance * height
        row_gaps = np.abs(one[..., :3] - other[..., :3]) / tolerance[..., None]
        area_gap = np.abs(np.log(one[..., 4] / other[..., 4])) / max(np.log(self.max_area_ratio), 1e-9)
        gaps = np.concatenate([row_gaps, area_gap[..., None]], axis=-1)
        known = np.minimum(one[..., 5:], other[..., 5:])
        disparity = one[..., 3] - other[..., 3]
        least, most = self.disparities_px
        possible = (gaps * known <= 1).all(axis=-1) & (disparity >= least) & (disparity <= most)
        possible &= known[..., :2].any(axis=-1)
        cost = (known * gaps**2).sum(axis=-1) / np.maximum(known.sum(axis=-1), 1)
        return np.where(possible, cost, np.inf)

    def is_on_rows(self, piece: Blob, blob: Blob) -> bool:
        """Whether what may be but a piece is on the rows of another object."""
        (first, last), (top, bottom) = piece.rows_px, blob.rows_px
        tolerance = self.epipolar_tolerance_px + self.shape_tolerance * (bottom - top)
        return bool(top - tolerance <= first and last <= bottom + tolerance)


def _features(blobs: Sequence[Blob]) -> Floats:
    """Top, bottom and centroid row, centroid column, area [px, px²], and how far the rows and the area are the
    object's own, 1 wholly, 0 not at all: (N, 9)."""
    rows = [
        (*blob.rows_px, *blob.centroid_px[::-1], max(blob.area_px2, _LEAST_AREA_PX2), *_own(blob)) for blob in blobs
    ]
    return np.array(rows, np.float64).reshape(-1, 9)


def _own(blob: Blob) -> tuple[float, float, float, float]:
    """How far top row, bottom row, centroid row and area are the object's own, and not those of a cut."""
    cut = blob.sharpness <= CUT
    if not cut.any():
        return 1.0, 1.0, 1.0, 1.0
    rows = blob.contour_px[:, 1]
    top, bottom = rows[~cut].min(initial=np.inf), rows[~cut].max(initial=-np.inf)
    return float(top <= rows[cut].min() - _BEYOND_PX), float(bottom >= rows[cut].max() + _BEYOND_PX), 0.0, _ROUGHLY
