"""Stated covariances fit the errors of rendered parts: neither half of what they should be, nor three times that."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from family_scenes import found
from mahalanobis import CHI2_3

from stereo_pick.core.arrays import Floats

SCENES = (*(("mixed_shapes", seed) for seed in range(8)), ("many_small", 0), ("many_small", 1))
# Shares below the median and the 95 % point of chi-square, three degrees of freedom: 0.5 and 0.95. Were the covariances
# half of what they should be, 0.24 and 0.73; were they three times that, 0.93 and 1.
BELOW_MEDIAN = (0.37, 0.86)
COVERED = 0.84


@cache
def squares() -> Floats:
    """Squared Mahalanobis distances of all poses in some scenes."""
    return np.concatenate([found(*scene).mahalanobis2 for scene in SCENES])


def fits(d2: Floats) -> bool:
    least, most = BELOW_MEDIAN
    return bool(least < np.mean(d2 < CHI2_3[50]) < most and np.mean(d2 < CHI2_3[95]) > COVERED)


def test_errors_are_as_large_as_stated() -> None:
    assert len(squares()) > 50
    assert fits(squares())


@pytest.mark.parametrize("seed", range(5))
def test_wrong_covariances_are_told_from_right_ones(seed: int) -> None:
    """As many draws as there are poses: the test above would fail, and only then."""
    drawn = np.random.default_rng(seed).chisquare(3, len(squares()))
    assert fits(drawn)
    assert not fits(drawn * 2)
    assert not fits(drawn / 3)
