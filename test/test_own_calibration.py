"""Calibrations out of simulated views of a board, and scenes of the true rig that are located with them."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from board_views import BOARD, board_views
from calibrated_scenes import Outcome, outcome
from calibration_tables import report
from mahalanobis import CHI2_3
from rendering.rigs import BENCH_RIGS, DISTANCES_M

from stereo_pick.core.calibration.solving import calibrate

CALIBRATIONS = range(6)
SCENES = (("two_cylinders", 1), ("four_cylinders", 2))


@pytest.mark.parametrize("name", BENCH_RIGS)
def test_boards_are_seen_whole_in_all_parts_of_the_image_near_and_far(name: str) -> None:
    rig = BENCH_RIGS[name]
    views = board_views(rig, DISTANCES_M[name][0], 16, 0.0, seed=0)
    assert len(views) == 16
    for side, camera in enumerate((rig.left, rig.right)):
        corners = np.concatenate([view.corners_px[side] for view in views])
        assert (corners > 0).all() and (corners < camera.frame_size).all()
        assert (np.ptp(corners, axis=0) > 0.7 * np.array(camera.frame_size)).all()
    lengths_px = [float(np.linalg.norm(view.corners_px[0][-1] - view.corners_px[0][0])) for view in views]
    assert max(lengths_px) > 1.3 * min(lengths_px)


def test_corners_have_the_noise_that_was_asked_for() -> None:
    exact, noisy = (board_views(BENCH_RIGS["wide"], 0.6, 16, noise_px, seed=3) for noise_px in (0.0, 0.1))
    errors = [np.subtract(a.corners_px, b.corners_px) for a, b in zip(noisy, exact)]
    assert np.std(errors) == pytest.approx(0.1, rel=0.05)
    assert abs(np.mean(errors)) < 0.01


@pytest.mark.parametrize("name", BENCH_RIGS)
def test_exact_corners_give_the_rig_back(name: str) -> None:
    rig = BENCH_RIGS[name]
    found = calibrate(board_views(rig, DISTANCES_M[name][0], 16, 0.0, seed=1), rig.left.frame_size, BOARD).rig
    assert found.baseline_m == pytest.approx(rig.baseline_m, abs=1e-7)
    np.testing.assert_allclose(found.left.K, rig.left.K, atol=1e-3)


@cache
def outcomes(calibrated: bool) -> list[Outcome]:
    return [outcome(*scene, None, way) for scene in SCENES for way in (CALIBRATIONS if calibrated else (None,))]


def test_depths_between_parts_hardly_suffer_from_a_calibration() -> None:
    scores = [each.whole for each in outcomes(calibrated=True)]
    assert all(each.right for each in scores)
    assert 1000 * np.mean(np.concatenate([each.depths_m for each in scores])) < 0.35


def test_the_stated_covariance_holds_the_calibrations_error() -> None:
    """Not the image's alone, and with the true calibration that is enough."""
    with_true, with_own = outcomes(calibrated=False), outcomes(calibrated=True)
    assert covered([each.image.mahalanobis2 for each in with_true]) == 1
    assert covered([each.image.mahalanobis2 for each in with_own]) < 0.5
    assert covered([each.whole.mahalanobis2 for each in with_own]) > 0.8


def covered(squares: list[list[float]]) -> float:
    return float(np.mean(np.concatenate(squares) < CHI2_3[95]))


def test_the_true_calibration_adds_nothing_and_each_of_its_own_another_error() -> None:
    for each in outcomes(calibrated=False):
        assert each.image.mahalanobis2 == each.whole.mahalanobis2
    distances_m = [np.mean(each.whole.distances_m) for each in outcomes(calibrated=True)]
    assert len(set(distances_m)) == len(distances_m)


def test_the_report_tells_true_from_own_calibrations() -> None:
    text = report([*outcomes(calibrated=False), *outcomes(calibrated=True)])
    assert "| two_cylinders | true | 2 / 2 |" in text
    assert f"| two_cylinders | own | {2 * len(CALIBRATIONS)} / {2 * len(CALIBRATIONS)} |" in text
    assert f"| thesis, k1 k2 p1 p2 | {len(CALIBRATIONS)} |" in text
