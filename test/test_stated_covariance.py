"""Stated covariances fit the errors of rendered parts: neither half of what they should be, nor three times that."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from families import staged
from family_scoring import SceneScore, score
from mahalanobis import CHI2_3
from rendering.rigs import BENCH_RIGS

from stereo_pick.core.arrays import Floats
from stereo_pick.core.pipeline import Pipeline, Steps

SCENES = (*(("mixed_shapes", seed) for seed in range(8)), ("many_small", 0), ("many_small", 1))
# Shares below the median and the 95 % point of chi-square, three degrees of freedom: 0.5 and 0.95. Were the covariances
# half of what they should be, 0.24 and 0.73; were they three times that, 0.93 and 1.
BELOW_MEDIAN = (0.37, 0.86)
COVERED = 0.84


@cache
def squares() -> Floats:
    """Squared Mahalanobis distances of all poses in some scenes."""
    return np.concatenate([each.mahalanobis2 for each in map(found, SCENES)])


def found(scene: tuple[str, int]) -> SceneScore:
    staging = staged(*scene)
    return score(*scene, Pipeline(BENCH_RIGS[staging.rig_name], Steps()), *staging.taken())


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
