"""Stated covariances fit the errors of rendered parts: neither half of what they should be, nor three times that.

Confidences follow from them, and fit as well where it is told that edges are sharp, as those of rendered parts are. By
default they might be rounded, and no more is promised than is kept.
"""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from family_scenes import found
from family_scoring import SceneScore
from mahalanobis import CHI2_3

from stereo_pick.core.arrays import Floats
from stereo_pick.core.confidence import within
from stereo_pick.core.correspondence.feature import Feature
from stereo_pick.core.pipeline import Steps

SCENES = (*(("mixed_shapes", seed) for seed in range(8)), ("many_small", 0), ("many_small", 1))
# Shares below the median and the 95 % point of chi-square, three degrees of freedom: 0.5 and 0.95. Were the covariances
# half of what they should be, 0.24 and 0.73; were they three times that, 0.93 and 1.
BELOW_MEDIAN = (0.37, 0.86)
COVERED = 0.84
PROMISED_TOO_MUCH, PROMISED_TOO_LITTLE = 0.03, 0.2
SHARP, BY_DEFAULT = 0.0, Feature().edge_radius_m


@cache
def scores(edge_radius_m: float) -> list[SceneScore]:
    return [found(*scene, Steps(method=Feature(edge_radius_m=edge_radius_m))) for scene in SCENES]


def squares(edge_radius_m: float = SHARP) -> Floats:
    """Squared Mahalanobis distances of all poses in some scenes."""
    return np.concatenate([each.mahalanobis2 for each in scores(edge_radius_m)])


def fits(d2: Floats) -> bool:
    least, most = BELOW_MEDIAN
    return bool(least < np.mean(d2 < CHI2_3[50]) < most and np.mean(d2 < CHI2_3[95]) > COVERED)


@pytest.mark.parametrize("edge_radius_m", [SHARP, BY_DEFAULT])
def test_errors_are_as_large_as_stated(edge_radius_m: float) -> None:
    assert len(squares(edge_radius_m)) > 50
    assert fits(squares(edge_radius_m))


@pytest.mark.parametrize("seed", range(5))
def test_wrong_covariances_are_told_from_right_ones(seed: int) -> None:
    """As many draws as there are poses: the test above would fail, and only then."""
    drawn = np.random.default_rng(seed).chisquare(3, len(squares()))
    assert fits(drawn)
    assert not fits(drawn * 2)
    assert not fits(drawn / 3)


def promised_too_much(tolerance_m: float, scale: float = 1.0, edge_radius_m: float = SHARP) -> float:
    """The share of poses that are within a tolerance by their covariances, scaled, less that of those that are."""
    stated = np.concatenate([within(each.covariances * scale, tolerance_m) for each in scores(edge_radius_m)])
    off_m = np.concatenate([each.off_m for each in scores(edge_radius_m)])
    return float(stated.mean() - np.mean(off_m <= tolerance_m))


@pytest.mark.parametrize("tolerance_m", [0.0002, 0.0003, 0.0005])
def test_about_as_many_are_near_enough_as_confidence_says(tolerance_m: float) -> None:
    assert -PROMISED_TOO_LITTLE < promised_too_much(tolerance_m) < PROMISED_TOO_MUCH


@pytest.mark.parametrize("tolerance_m", [0.0002, 0.0003, 0.0005, 0.001])
def test_no_fewer_are_near_enough_where_edges_might_be_rounded(tolerance_m: float) -> None:
    assert promised_too_much(tolerance_m, edge_radius_m=BY_DEFAULT) < PROMISED_TOO_MUCH


def test_confidence_by_wrong_covariances_would_promise_other_shares() -> None:
    assert promised_too_much(0.0002, scale=1 / 3) > PROMISED_TOO_MUCH
    assert promised_too_much(0.0002, scale=3) < -PROMISED_TOO_LITTLE
