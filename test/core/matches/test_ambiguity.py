"""What cannot be told apart is not told apart."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from outlines import disc

from stereo_pick.core.matches.ambiguity import ambiguous_pairs, uncrossed

INF = np.inf


@given(st.permutations(range(6)))
def test_pairs_that_cross_are_put_in_order(order: list[int]) -> None:
    left = [disc(100 + 60 * i, 100) for i in range(6)]
    right = [disc(50 + 60 * j, 100) for j in range(6)]
    pairs = uncrossed(list(enumerate(order)), np.full((6, 6), 0.1), left, right)
    assert sorted(pairs) == [(i, i) for i in range(6)]


def test_an_order_that_only_impossible_pairs_would_restore_stays() -> None:
    left, right = [disc(100, 100), disc(200, 300)], [disc(50, 300), disc(150, 100)]
    cost = np.array([[INF, 0.1], [0.1, INF]])
    assert sorted(uncrossed([(0, 1), (1, 0)], cost, left, right)) == [(0, 1), (1, 0)]


def test_pairs_without_a_rival_are_certain() -> None:
    assert ambiguous_pairs([(0, 0), (1, 1)], np.array([[0.0, 0.1], [0.1, 0.0]]), margin=0.25) == set()


def test_an_object_left_over_that_fits_as_well_casts_doubt() -> None:
    assert ambiguous_pairs([(0, 0)], np.array([[0.1], [0.2]]), margin=0.25) == {(0, 0)}
    assert ambiguous_pairs([(0, 0)], np.array([[0.1, 0.2]]), margin=0.25) == {(0, 0)}


def test_one_that_fits_clearly_worse_casts_none() -> None:
    assert ambiguous_pairs([(0, 0)], np.array([[0.1], [0.4]]), margin=0.25) == set()


@given(st.integers(2, 8))
def test_doubt_runs_through_a_chain_of_exchanges(count: int) -> None:
    """Each left object fits two neighbours of the right; one right object too many makes all of them uncertain."""
    cost = np.full((count, count + 1), INF)
    for i in range(count):
        cost[i, i] = cost[i, i + 1] = 0.1
    pairs = [(i, i) for i in range(count)]
    assert ambiguous_pairs(pairs, cost, margin=0.25) == set(pairs)


def test_doubt_does_not_reach_those_that_nothing_links() -> None:
    cost = np.array([[0.1, 0.1, INF], [INF, INF, 0.1]])
    assert ambiguous_pairs([(0, 0), (1, 2)], cost, margin=0.25) == {(0, 0)}
