"""How sure a depth is, against the covariance that triangulation states."""

from __future__ import annotations

import numpy as np
import pytest
from outlines import PARALLEL, disc

from stereo_pick.core.correspondence.correspondences import Match, collect
from stereo_pick.core.doubts.certainty import sigma_of_width
from stereo_pick.core.places.position import Located
from stereo_pick.core.triangulation import Triangulator

RADIUS_PX = 20.0


@pytest.mark.parametrize("disparity_px", [30.0, 60.0, 150.0])
@pytest.mark.parametrize("sigma_px", [0.05, 1.0])
@pytest.mark.parametrize("together_m", [0.0, 0.002])
def test_it_is_the_sigma_of_the_stated_depth_by_the_width_of_the_outline(
    disparity_px: float, sigma_px: float, together_m: float
) -> None:
    blobs = disc(320, 240, RADIUS_PX), disc(320 - disparity_px, 240, RADIUS_PX)
    moved = together_m**2 * np.eye(3)
    where = Located(blobs[0].centroid_px, blobs[1].centroid_px, sigma_px, None, covariance=moved)
    size_px = 2 * RADIUS_PX, 2 * RADIUS_PX
    match = Match(where.left_px, where.right_px, (sigma_px, sigma_px), size_px, 0.0, covariance=moved)
    points = Triangulator(max_ray_gap_m=1.0).triangulate(collect([match], []), PARALLEL)
    width_m = 2 * RADIUS_PX * points.xyz[0, 2] / PARALLEL.focal_px
    stated = float(np.sqrt(points.covariance[0, 2, 2])) / width_m
    assert sigma_of_width(blobs, where, PARALLEL) == pytest.approx(stated, rel=0.02)
