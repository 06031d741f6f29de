"""Stretches of silhouettes along which there are edges, and such where there are none but by chance."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from stereo_pick.core.arrays import Floats
from stereo_pick.core.edges.stretches import stretches_found

COUNT = 120
SIDES = np.repeat([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]], COUNT // 4, axis=0)
SIDE = np.arange(COUNT) // (COUNT // 4)
ANGLE = np.arange(COUNT) * (2 * np.pi / COUNT)
CIRCLE = np.stack([np.cos(ANGLE), np.sin(ANGLE), np.zeros(COUNT)], axis=1)
OPEN = np.ones((1, 2, COUNT), bool)


def found(normals: Floats, trusted: Floats, open_: Floats | None = None) -> Floats:
    """In the first of two views that show the same."""
    both = np.broadcast_to(trusted, OPEN.shape)
    seen = OPEN if open_ is None else np.broadcast_to(open_, OPEN.shape)
    return stretches_found(np.broadcast_to(7.0 * normals, (1, 2, COUNT, 3)), both, seen)[0, 0]


@pytest.mark.parametrize("normals", [SIDES, CIRCLE])
def test_where_most_edges_are_trusted_all_points_count(normals: Floats) -> None:
    np.testing.assert_allclose(found(normals, np.full(COUNT, 0.6)), 1.0)


def test_a_side_without_edges_counts_nothing_up_to_its_corners() -> None:
    """Where chance finds one in fifteen; the others count as ever."""
    counts = found(SIDES, np.where(SIDE == 1, 1 / 15, 0.8))
    assert counts[SIDE == 1].max() < 0.02
    np.testing.assert_allclose(counts[SIDE != 1], 1.0)


def test_what_is_hidden_makes_the_rest_of_a_side_count_no_less() -> None:
    seen = (SIDE != 1) | (np.arange(COUNT) % 30 < 10)
    counts = found(SIDES, np.where(seen, 0.8, 0.0), seen)
    np.testing.assert_allclose(counts[seen], 1.0)


@given(arrays(np.float64, COUNT, elements=st.floats(0, 1)))
def test_each_counts_between_nothing_and_once_and_the_more_the_more_is_trusted(trusted: Floats) -> None:
    counts = found(CIRCLE, trusted)
    assert ((counts >= 0) & (counts <= 1)).all()
    assert (found(CIRCLE, (1 + trusted) / 2) >= counts).all()
