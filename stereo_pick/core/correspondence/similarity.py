"""How alike an object of the left view and one of the right view are."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from stereo_pick.core.arrays import Floats
from stereo_pick.core.objects import Blob


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
        disparity = one[..., 3] - other[..., 3]
        least, most = self.disparities_px
        possible = (gaps <= 1).all(axis=-1) & (disparity >= least) & (disparity <= most)
        return np.where(possible, (gaps**2).mean(axis=-1), np.inf)


def _features(blobs: Sequence[Blob]) -> Floats:
    """Top, bottom and centroid row, centroid column, area: (N, 5) [px, px²]."""
    rows = [(*blob.rows_px, blob.centroid_px[1], blob.centroid_px[0], blob.area_px2) for blob in blobs]
    return np.array(rows, np.float64).reshape(-1, 5)
