"""The probability that a position is near enough, against other ways to find it."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from rigs import rotation

from stereo_pick.core.arrays import Floats
from stereo_pick.core.confidence import within

SIGMAS_M = st.tuples(*[st.floats(-5, -2).map(lambda power: 10.0**power)] * 3)
RADII_M = st.floats(-4, -2).map(lambda power: 10.0**power)
TURNS = st.tuples(*[st.floats(-3, 3)] * 3).map(rotation)
RATIOS = np.geomspace(1e-3, 1e3, 61)  # of the radius to the greatest sigma
DRAWN = np.random.default_rng(0).normal(0, 1, (20_000, 3))


def covariance_of(sigmas_m: tuple[float, ...], turn: Floats | None = None) -> Floats:
    """One covariance (1, 3, 3) with these sigmas along its axes."""
    R = np.eye(3) if turn is None else turn
    return np.asarray(R @ np.diag(np.square(sigmas_m)) @ R.T)[None]


def chi_3(x: float) -> float:
    """P(|z| <= x) of three independent standard normal variables."""
    return math.erf(x / math.sqrt(2)) - math.sqrt(2 / math.pi) * x * math.exp(-x * x / 2)


def mean_over_directions(sigmas_m: tuple[float, ...], radius_m: float) -> float:
    """The probability as the mean of `chi_3` over one octant of the directions in which an error may point."""
    nodes, weights = np.polynomial.legendre.leggauss(80)
    cos, angle = (nodes[:, None] + 1) / 2, (nodes + 1) * np.pi / 4
    sin = np.sqrt(1 - cos**2)
    sigma_m = np.sqrt(sum((s * u) ** 2 for s, u in zip(sigmas_m, (sin * np.cos(angle), sin * np.sin(angle), cos))))
    return float(np.vectorize(chi_3)(radius_m / sigma_m) @ weights @ weights / 4)


@pytest.mark.parametrize(
    ("sigmas", "probability"),
    [
        ((1, 1, 1), chi_3),
        ((1, 0, 0), lambda x: math.erf(x / math.sqrt(2))),
        ((1, 0, 1), lambda x: -math.expm1(-x * x / 2)),
        ((0, 0, 0), lambda x: 1.0),
    ],
    ids=["a ball", "a line", "a disc", "a point"],
)
def test_where_a_formula_is_known_it_is_that(sigmas: tuple[float, ...], probability: Callable[[float], float]) -> None:
    for ratio in RATIOS:
        assert within(covariance_of(sigmas), ratio)[0] == pytest.approx(probability(ratio), abs=1e-12)


def test_one_large_sigma_is_as_good_as_alone() -> None:
    for ratio in RATIOS[RATIOS > 0.1]:
        thin = within(covariance_of((1e-5, 3e-5, 1e-2)), ratio * 1e-2)[0]
        assert thin == pytest.approx(math.erf(ratio / math.sqrt(2)), abs=1e-4)


@given(SIGMAS_M, st.floats(0.2, 5))
def test_it_is_the_mean_over_all_directions(sigmas_m: tuple[float, ...], ratio: float) -> None:
    wide = tuple(max(sigma, max(sigmas_m) / 10) for sigma in sigmas_m)
    radius_m = ratio * max(wide)
    assert within(covariance_of(wide), radius_m)[0] == pytest.approx(mean_over_directions(wide, radius_m), abs=1e-6)


@given(SIGMAS_M, TURNS, RADII_M)
def test_that_share_of_many_draws_is_within(sigmas_m: tuple[float, ...], turn: Floats, radius_m: float) -> None:
    stated = within(covariance_of(sigmas_m, turn), radius_m)[0]
    errors_m = DRAWN * sigmas_m @ turn.T
    share = np.mean(np.linalg.norm(errors_m, axis=1) <= radius_m)
    sigma = np.sqrt(stated * (1 - stated) / len(DRAWN))
    assert share == pytest.approx(stated, abs=6 * sigma + 1e-3)


@given(SIGMAS_M, TURNS, RADII_M)
def test_it_does_not_depend_on_the_frame(sigmas_m: tuple[float, ...], turn: Floats, radius_m: float) -> None:
    turned, plain = (within(covariance_of(sigmas_m, way), radius_m)[0] for way in (turn, None))
    assert turned == pytest.approx(plain, abs=1e-9)


@given(SIGMAS_M, TURNS)
def test_a_larger_ball_holds_more_and_a_surer_position_is_in_it(sigmas_m: tuple[float, ...], turn: Floats) -> None:
    covariance = covariance_of(sigmas_m, turn)
    by_radius = [within(covariance, radius_m)[0] for radius_m in np.geomspace(1e-4, 1e-1, 40)]
    assert (np.diff(by_radius) > -1e-12).all()
    assert 0 <= by_radius[0] <= by_radius[-1] <= 1
    assert within(covariance / 4, 1e-3)[0] >= within(covariance, 1e-3)[0] - 1e-12


def test_each_covariance_has_its_own() -> None:
    several = np.concatenate([covariance_of((1e-3, 2e-3, s)) for s in (1e-3, 5e-3, 1e-2)])
    alone = np.array([within(each[None], 0.005)[0] for each in several])
    np.testing.assert_allclose(within(several, 0.005), alone, rtol=1e-12)
    assert (np.diff(alone) < -0.1).all()
    assert within(np.zeros((0, 3, 3)), 0.005).shape == (0,)
