"""One-to-one assignment against an exhaustive search."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays_of

from stereo_pick.core.arrays import Floats
from stereo_pick.core.matches.assignment import assign

COSTS = arrays_of.arrays(
    np.float64,
    st.tuples(st.integers(0, 7), st.integers(0, 7)),
    elements=st.one_of(st.floats(0, 3), st.just(np.inf), st.sampled_from([0.0, 0.5, 1.0])),
)


def least_total(cost: Floats, unmatched_cost: float) -> float:
    """The best that any one-to-one assignment reaches, by trying them all."""

    @cache
    def best(row: int, taken: int) -> float:
        if row == len(cost):
            return 0.0
        free = [column for column in range(cost.shape[1]) if not taken >> column & 1]
        with_partner = [float(cost[row, column]) + best(row + 1, taken | 1 << column) for column in free]
        return min([unmatched_cost + best(row + 1, taken), *with_partner])

    return best(0, 0)


@given(COSTS, st.floats(0.05, 2))
def test_no_other_assignment_is_better(cost: Floats, unmatched_cost: float) -> None:
    pairs = assign(cost, unmatched_cost)
    total = sum(cost[pair] for pair in pairs) + unmatched_cost * (len(cost) - len(pairs))
    assert total == pytest.approx(least_total(cost, unmatched_cost), abs=1e-9)


@given(COSTS, st.floats(0.05, 2))
def test_nothing_is_assigned_twice_or_against_the_impossible(cost: Floats, unmatched_cost: float) -> None:
    pairs = assign(cost, unmatched_cost)
    assert len({row for row, _ in pairs}) == len({column for _, column in pairs}) == len(pairs)
    assert all(np.isfinite(cost[pair]) for pair in pairs)


@given(COSTS)
def test_a_pair_that_costs_more_than_none_is_not_made(cost: Floats) -> None:
    assert all(cost[pair] <= 1.0 + 1e-9 for pair in assign(cost, unmatched_cost=1.0))


def test_large_problems_agree_with_scipy() -> None:
    optimize = pytest.importorskip("scipy.optimize", reason="compares with scipy, which the tests do not require")
    for seed in range(5):
        cost = np.random.default_rng(seed).uniform(0, 2, (60, 50))
        cost[cost > 1.5] = np.inf
        wide = np.hstack([np.where(np.isfinite(cost), cost, 1e6), np.where(np.eye(60) > 0, 1.0, 1e6)])
        expected = wide[optimize.linear_sum_assignment(wide)].sum()
        pairs = assign(cost, unmatched_cost=1.0)
        assert sum(cost[pair] for pair in pairs) + 60 - len(pairs) == pytest.approx(expected)
