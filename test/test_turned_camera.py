"""Scenes located with a calibration from before the right camera turned."""

from __future__ import annotations

import numpy as np
import pytest
from rendering.rigs import BENCH_RIGS
from turned_camera import report, stale, turned_scores


@pytest.mark.parametrize("name", BENCH_RIGS)
def test_a_pitch_shifts_rows_and_a_yaw_columns_by_the_focal_length(name: str) -> None:
    rig, ahead = BENCH_RIGS[name], np.array([[0.05, 0.0, 0.9]])
    px = {turn: stale(rig, turn).project(ahead)[1][0] - rig.project(ahead)[1][0] for turn in ((1, 0, 0), (0, 1, 0))}
    focal_px = rig.right.K[1, 1]
    assert abs(px[1, 0, 0][1]) == pytest.approx(focal_px / 1000, rel=0.2)
    assert abs(px[0, 1, 0][0]) == pytest.approx(focal_px / 1000, rel=0.2)
    np.testing.assert_allclose(stale(rig, (0, 0, 0)).right_T_left.rotation, rig.right_T_left.rotation, atol=1e-12)


def test_the_report_has_a_row_for_every_turn() -> None:
    text = report([turned_scores(None, ("four_cylinders", 2))])
    assert "| four_cylinders | none | 4 / 4 | 0 | 0 |" in text
    assert "| four_cylinders | 1 mrad pitch | 4 / 4 | 0 | 0 |" in text
    assert "| four_cylinders | 4 mrad about all axes | 0 / 4 | 1 | 0 |" in text
