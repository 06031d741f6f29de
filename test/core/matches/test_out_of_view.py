"""Rows of alike objects that go on beyond both views have no pair that is surely one."""

from __future__ import annotations

import numpy as np
import pytest
from outlines import PARALLEL, disc
from rendered_solids import rectified
from rendering import Cylinder, Scene, Sphere
from rendering.rigs import BENCH_RIGS, table_before

from stereo_pick.core.correspondence.feature import Feature
from stereo_pick.core.matches.out_of_view import OpenRows
from stereo_pick.core.objects import Blob
from stereo_pick.core.pipeline import Steps
from stereo_pick.core.refusal import count_reasons

PITCH_PX = 90.0


def row(count: int, first_px: float, row_px: float = 240.0) -> list[Blob]:
    return [disc(first_px + PITCH_PX * i, row_px, 20.0) for i in range(count)]


def doubtful(left: list[Blob], right: list[Blob], cut: list[Blob]) -> set[tuple[int, int]]:
    """Of pairs of the first with the first, and so on, all of which fit each other as well."""
    cost = np.zeros((len(left), len(right)))
    pairs = [(i, i) for i in range(len(left))]
    return OpenRows((left, right), PARALLEL, cut, Feature().similarity(PARALLEL)).ambiguous_pairs(pairs, cost, 0.25)


def test_a_row_that_fills_both_views_and_is_cut_may_be_shifted_by_one() -> None:
    left, right = row(7, 60), row(7, 35)
    assert doubtful(left, right, [disc(630, 240, 12.0)]) == {(i, i) for i in range(7)}


def test_a_row_of_which_all_is_seen_is_not_doubted() -> None:
    assert doubtful(row(7, 60), row(7, 35), []) == set()


def test_what_is_cut_on_other_rows_casts_no_doubt() -> None:
    assert doubtful(row(7, 60), row(7, 35), [disc(630, 300, 12.0)]) == set()


def test_shifted_by_one_both_ends_must_be_out_of_view() -> None:
    """Where one of them would be seen by both cameras, it would have a partner."""
    assert doubtful(row(4, 150), row(4, 125), [disc(630, 240, 12.0)]) == set()


@pytest.mark.parametrize("part", [Sphere(0.0, 0.0, (0.03,) * 3), Cylinder(0.0, 0.0, (0.03, 0.03, 0.04))])
def test_no_part_of_a_row_that_goes_on_is_published_half_a_metre_below_the_table(part: Sphere | Cylinder) -> None:
    rig = BENCH_RIGS["wide"]
    parts = tuple(type(part)(x_m, 0.0, part.size_m) for x_m in np.arange(-0.6, 0.61, 0.06))
    scene = Scene(parts, table_before(rig, 0.6, elevation_deg=50.0), ambient=0.7)
    steps = Steps()
    _, matches = steps.correspond(rectified(rig, scene))
    poses = steps.locate(matches, rig, 0)
    off_m = [np.linalg.norm(scene.positions_m() - xyz, axis=1).min() for xyz in poses.xyz]
    assert max(off_m, default=0.0) < 1e-3
    assert count_reasons(matches.refused)["ambiguous"] >= 7
