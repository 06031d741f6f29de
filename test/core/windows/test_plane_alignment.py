"""A plane aligned with what both views show of it."""

from __future__ import annotations

import numpy as np
import pytest
from grain_on_planes import columns_in_left, plane, seen
from rigs import RIGS

from stereo_pick.core.arrays import Floats
from stereo_pick.core.frames import RectifiedPair
from stereo_pick.core.windows.plane_alignment import Alignment, aligned
from stereo_pick.core.windows.table_windows import Windows
from stereo_pick.core.windows.window import Grey

RIG = RIGS["thesis"]
GRID = 17, 9, 20
TABLE = plane(40, 10)


def disparity_plane() -> Floats:
    """Disparity by left column, row and 1 of the table, from where it puts three pixels of the right view."""
    right = np.array([[100.0, 100.0], [500.0, 120.0], [300.0, 400.0]])
    left = columns_in_left(RIG, TABLE, right[:, 0], right[:, 1])
    return np.asarray(np.linalg.solve(np.c_[left, right[:, 1], np.ones(3)], left - right[:, 0]))


def windows() -> Windows:
    """Where they are says nothing about their disparities."""
    columns, rows = np.meshgrid(np.arange(150, 500, 20.0), np.arange(60, 420, 20.0))
    return Windows(np.stack([columns.ravel(), rows.ravel()], axis=1), np.full(columns.size, np.nan))


def alignment(pair: RectifiedPair, start: Floats) -> Alignment | None:
    left, right = (each.astype(np.float32) - np.float32(110) for each in (pair.left, pair.right))
    return aligned(left, right, start, windows(), GRID)


@pytest.mark.parametrize("off", [(0.0, 0.0, 0.6), (0.001, -0.001, 0.0), (-0.001, 0.0005, 0.3)])
def test_it_goes_where_the_views_agree_and_knows_how_well(off: tuple[float, float, float]) -> None:
    truth = disparity_plane()
    found = alignment(seen(RIG, TABLE, 8.0), truth + np.array(off))
    assert found is not None
    rows = windows().rows
    off_px = rows @ (found.plane - truth)
    sigma_px = np.sqrt(np.einsum("ni,ij,nj->n", rows, found.covariance, rows))
    assert np.abs(off_px).max() < 0.05
    assert (np.abs(off_px) < 5 * sigma_px + 0.01).all()  # 0.01: cubic interpolation of the views


def test_a_camera_with_more_gain_makes_no_difference() -> None:
    pair, truth = seen(RIG, TABLE, 8.0), disparity_plane()
    left: Grey = pair.left.astype(np.float32) - np.float32(110)
    right: Grey = (pair.right.astype(np.float32) - np.float32(110)) * np.float32(1.3)
    found = aligned(left, right, truth + np.array([0.0, 0.0, 0.4]), windows(), GRID)
    assert found is not None and np.abs(windows().rows @ (found.plane - truth)).max() < 0.05


def test_views_of_different_things_cannot_be_aligned() -> None:
    one, other = (seen(RIG, TABLE, 8.0, seed) for seed in (0, 1))
    assert alignment(RectifiedPair(one.left, other.right, RIG, 0), disparity_plane()) is None
