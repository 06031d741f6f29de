"""A table that is given: believed where the parts stand on it, and nothing where they agree on another one."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest
from rendered_solids import PARTS, PLACED, RIG, table_of
from rendering import Scene, Solid, render_with_truth

from stereo_pick.core.correspondence.feature import Feature
from stereo_pick.core.pipeline import Pipeline, Result, Steps
from stereo_pick.core.shapes.table import Table

TRUE = table_of(RIG, PLACED)


def seen(parts: Sequence[Solid], lifted_m: float) -> tuple[Result, np.ndarray]:
    """What becomes of parts whose table is said to be so much higher than it is, and their true centres (N, 3)."""
    frame, truth = render_with_truth(RIG, Scene(tuple(parts), PLACED, ambient=0.6))
    given = Table(TRUE.normal, TRUE.offset_m - lifted_m, TRUE.sigma_m)
    return Pipeline(RIG, Steps(method=Feature(table=given.text))).run(frame), truth.centres_m


@pytest.mark.parametrize("lifted_m", [-0.002, 0.0, 0.002])
def test_parts_on_the_given_table_are_found(lifted_m: float) -> None:
    result, centres_m = seen(list(PARTS.values()), lifted_m)
    assert len(result.poses) == len(PARTS) and not result.correspondences.notice
    off_m = np.linalg.norm(result.poses.xyz[:, None] - centres_m, axis=2).min(axis=1)
    assert off_m.max() < 1e-3


@pytest.mark.parametrize("lifted_m", [-0.03, -0.01, 0.01, 0.03])
def test_where_parts_agree_on_another_table_all_are_refused_and_told_by_how_much(lifted_m: float) -> None:
    result, _ = seen(list(PARTS.values()), lifted_m)
    refused = result.poses.refused
    assert len(result.poses) == 0 and [each.reason for each in refused] == ["off_table"] * len(PARTS)
    detail = refused[0].detail
    assert ("below" if lifted_m > 0 else "above") in detail and "measure it again" in detail
    assert result.correspondences.notice == detail
    told_mm = float(detail.split("what objects stand on is ")[1].split(" mm")[0])
    assert told_mm == pytest.approx(abs(lifted_m) * 1000, abs=0.5)


def test_one_part_alone_contradicts_no_table() -> None:
    result, _ = seen([PARTS["sphere"]], 0.0)
    assert len(result.poses) == 1
