"""Least squares with how far edges are rounded as an unknown that is eliminated."""

from __future__ import annotations

import numpy as np
import pytest

from stereo_pick.core.arrays import Floats
from stereo_pick.core.edges.rounding import however_rounded

RADIUS = 4  # which of the seven unknowns it is


def equations(seed: int) -> tuple[Floats, Floats]:
    """Of two solids, each seen by 30 points."""
    random = np.random.default_rng(seed)
    jacobian, residual = random.normal(size=(2, 30, 7)), random.normal(size=(2, 30))
    return jacobian.transpose(0, 2, 1) @ jacobian, (jacobian.transpose(0, 2, 1) @ residual[..., None])[..., 0]


@pytest.mark.parametrize("seed", range(3))
def test_the_other_unknowns_are_as_in_the_whole_problem_with_a_radius_of_that_sigma(seed: int) -> None:
    (normal, right), sigma_m = equations(seed), 0.2
    whole = normal.copy()
    whole[:, RADIUS, RADIUS] += sigma_m**-2
    less, less_right = however_rounded(normal, right, sigma_m)
    covariance = np.delete(np.delete(np.linalg.inv(whole), RADIUS, 1), RADIUS, 2)
    np.testing.assert_allclose(np.linalg.inv(less), covariance)
    step = np.delete(np.linalg.solve(whole, right[..., None])[..., 0], RADIUS, 1)
    np.testing.assert_allclose(np.linalg.solve(less, less_right[..., None])[..., 0], step)


def test_sharp_edges_are_no_unknown() -> None:
    normal, right = equations(0)
    less, less_right = however_rounded(normal, right, 0.0)
    np.testing.assert_array_equal(less, np.delete(np.delete(normal, RADIUS, 1), RADIUS, 2))
    np.testing.assert_array_equal(less_right, np.delete(right, RADIUS, 1))
