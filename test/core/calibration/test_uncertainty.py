"""Stated uncertainties: they cover the truth as often as they claim, of parameters and of points."""

from __future__ import annotations

import json
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from marks import first_of
from simulated_views import BOARD, RIG, SIZE_PX, USUAL_D, make_views, rig_with, triangulated

from stereo_pick.core.calibration.boards import Chessboard
from stereo_pick.core.calibration.parameters import NAMES, RICH, UNITS, USUAL, DistortionModel, rig_vector
from stereo_pick.core.calibration.refinement import refine
from stereo_pick.core.calibration.result import CalibrationResult
from stereo_pick.core.calibration.solving import calibrate
from stereo_pick.core.calibration.uncertainty import CalibrationUncertainty
from stereo_pick.core.errors import ArrayError, CalibrationError
from stereo_pick.core.rig import StereoRig

TRUTH = rig_vector(RIG.left, RIG.right, RIG.right_T_left)
WORK_M = np.array([[0, 0, 0.5], [0.08, 0.06, 0.55], [-0.1, -0.07, 0.7], [0.05, -0.05, 0.8], [0, 0, 0.9]])


@cache
def simulated() -> list[CalibrationResult]:
    """A hundred calibrations of one rig, each from eight views of its own with 0.1 px of noise."""
    return [calibrate(make_views(8, noise_px=0.1, seed=seed), SIZE_PX, BOARD) for seed in range(100)]


def test_every_parameter_has_a_name_and_a_unit() -> None:
    assert len(NAMES) == len(set(NAMES)) == len(UNITS) == 24
    named = dict(zip(NAMES, zip(TRUTH, UNITS)))
    assert named["left.fy"] == (815, "px")
    assert named["right.p2"] == (0.001, "1")
    assert named["rotation.y"][1] == "rad"
    assert named["translation.x"] == (pytest.approx(-0.118), "m")


def test_stated_uncertainties_cover_the_truth_as_often_as_they_claim() -> None:
    free = USUAL.free
    errors = np.array([(result.solution.parameters - TRUTH)[free] for result in simulated()])
    sigmas = np.array([result.uncertainty.sigma[free] for result in simulated()])
    for of_sigma, claimed, allowed in ((1.0, 0.683, 0.07), (1.96, 0.95, 0.04)):
        covered = np.abs(errors) < of_sigma * sigmas
        assert covered.mean() == pytest.approx(claimed, abs=allowed)
        # Four standard deviations of a share among a hundred.
        np.testing.assert_allclose(covered.mean(axis=0), claimed, atol=4 * np.sqrt(claimed * (1 - claimed) / 100))


def test_stated_covariance_of_points_covers_their_errors() -> None:
    squares = squared_distances(RIG, simulated())
    # Chi-square of three degrees of freedom: its 68.3 and 95 % points.
    assert np.mean(squares < 3.53) == pytest.approx(0.683, abs=0.07)
    assert np.mean(squares < 7.81) == pytest.approx(0.95, abs=0.04)


def squared_distances(rig: StereoRig, results: list[CalibrationResult]) -> np.ndarray:
    """Of the points that each calibration triangulates from the truth, in their stated covariance: (R, N)."""
    left_px, right_px = rig.project(WORK_M)
    errors = np.array([triangulated(result.rig, left_px, right_px) - WORK_M for result in results])
    covariances = np.array([result.uncertainty.point_covariance(WORK_M) for result in results])
    return np.asarray((errors * np.linalg.solve(covariances, errors[..., None])[..., 0]).sum(axis=-1))


def test_points_far_away_are_less_sure() -> None:
    covariance = simulated()[0].uncertainty.point_covariance([[0, 0, 0.5], [0, 0, 1.0]])
    sigma = np.sqrt(np.diagonal(covariance, axis1=1, axis2=2))
    assert (sigma[1] > 1.5 * sigma[0]).all()


def test_coefficients_that_are_not_estimated_are_zero_for_sure() -> None:
    result = simulated()[0]
    assert result.uncertainty.sigmas["left.k3"] == 0 == result.rig.left.D[4]
    assert result.uncertainty.sigmas["left.fx"] > 0


K1_RIG, NO_RIG = rig_with((-0.25, 0, 0, 0, 0), (-0.2, 0, 0, 0, 0)), rig_with((0,) * 5, (0,) * 5)
K1_K2_RIG = rig_with((-0.27, 0.4, 0, 0, 0), (-0.25, 0.4, 0, 0, 0))
K3_RIG = rig_with((-0.3, 0.2, 0.001, -0.002, 15.0), (-0.3, 0.2, -0.001, 0.001, 15.0))
SMALL_P1_P2_RIG = rig_with((-0.27, 0.4, 0.0006, -0.001, 0), (-0.25, 0.4, -0.001, 0.0006, 0))
HIDDEN_K3_RIG = rig_with((-0.27, 0.4, 0.0006, -0.001, 6.0), (-0.25, 0.4, -0.001, 0.0006, 6.0))


@pytest.mark.parametrize(
    ("rig", "model"),
    [(NO_RIG, USUAL), (K1_RIG, USUAL), (K1_K2_RIG, USUAL), (rig_with(*USUAL_D), USUAL), (K3_RIG, RICH)],
    ids=["none", "k1", "k1 k2", USUAL.value, RICH.value],
)
def test_distortion_model_lacks_nothing_of_what_made_the_views(rig: StereoRig, model: DistortionModel) -> None:
    found = [calibrate(make_views(15, 0.05, seed, rig), SIZE_PX, BOARD).solution.model for seed in range(3)]
    assert found == [model] * 3


@cache
def unclear(rig: StereoRig, seed: int) -> CalibrationResult:
    """From so few and so noisy views that they hardly tell the smallest coefficients from zero."""
    return calibrate(make_views(8, noise_px=0.2, seed=seed, rig=rig), SIZE_PX, BOARD)


@pytest.mark.parametrize(
    "rig", first_of(SMALL_P1_P2_RIG, HIDDEN_K3_RIG, NO_RIG), ids=["small p1 p2", "hidden k3", "none"]
)
def test_points_are_covered_where_the_views_hardly_tell_coefficients_from_zero(rig: StereoRig) -> None:
    squares = squared_distances(rig, [unclear(rig, seed) for seed in range(40)])
    # A calibration's points err alike: three standard deviations of a share among forty.
    for limit, claimed in ((3.53, 0.683), (7.81, 0.95)):
        assert np.mean(squares < limit) > claimed - 3 * np.sqrt(claimed * (1 - claimed) / 40)
    assert squares.mean() < 3 + 3 * np.sqrt(6 / 40)


def test_k3_leaves_points_as_sure_as_they_are_without_it() -> None:
    for result in (unclear(HIDDEN_K3_RIG, seed) for seed in range(10)):
        start = BOARD, result.views, result.solution.cameras, result.solution.poses
        usual, rich = (
            CalibrationUncertainty(SIZE_PX, solution.parameters, solution.covariance)
            for solution in (refine(*start, model) for model in (USUAL, RICH))
        )
        assert rich.sigmas["left.k2"] > 2 * usual.sigmas["left.k2"]
        np.testing.assert_allclose(spread_m(rich), spread_m(usual), rtol=0.05)


def spread_m(uncertainty: CalibrationUncertainty) -> np.ndarray:
    """One sigma (N,) of each point."""
    return np.sqrt(np.trace(uncertainty.point_covariance(WORK_M), axis1=1, axis2=2))


def test_residuals_are_given_for_each_axis_in_pixels_and_on_the_board() -> None:
    left, right = calibrate(make_views(12, noise_px=0.2), SIZE_PX, BOARD).residuals
    for camera in (left, right):
        assert camera.x_px == pytest.approx(0.2, rel=0.1)
        assert camera.y_px == pytest.approx(0.2, rel=0.1)
        assert camera.x_m == pytest.approx(camera.x_px / 800 * camera.distance_m, rel=0.03)
        assert camera.distance_m == pytest.approx(0.6, abs=0.1)


@pytest.mark.parametrize(
    ("covariance", "error"),
    [
        (np.eye(23), ArrayError),
        (-np.eye(24), CalibrationError),
        (np.eye(24) + np.eye(24, k=1), CalibrationError),
        (np.full((24, 24), 2.0) - np.eye(24), CalibrationError),
    ],
)
def test_what_is_no_covariance_is_refused(covariance: np.ndarray, error: type[Exception]) -> None:
    with pytest.raises(error, match="covariance"):
        CalibrationUncertainty(SIZE_PX, TRUTH, covariance)


def test_bouguet_states_the_published_uncertainties(calibrated, shared_data: Path) -> None:
    published = json.loads((shared_data / "bouguet_stereo/published.json").read_text())["after_stereo_optimisation"]
    result = calibrated("bouguet_stereo/left*.jpg", "bouguet_stereo/right*.jpg", Chessboard(9, 6, 0.03))
    values, bounds = (
        np.concatenate(
            [
                *(published[f"{part}_{side}{suffix}"] for side in ("left", "right") for part in ("fc", "cc", "kc")),
                published[f"om{suffix}"],
                np.array(published[f"T_mm{suffix}"]) / 1000,
            ]
        )
        for suffix in ("", "_pm")
    )
    assert result.rms_px <= 0.25
    assert (np.abs(result.solution.parameters - values) <= bounds).all()
    estimated = bounds > 0
    ratio = 3 * result.uncertainty.sigma[estimated] / bounds[estimated]
    assert (ratio > 0.5).all()
    assert (ratio < 2).all()
