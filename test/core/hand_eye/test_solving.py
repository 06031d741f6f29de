"""Hand-eye from pairs: the truth within the stated uncertainty, and a reason where there can be no answer."""

from __future__ import annotations

import re

import numpy as np
import pytest

from stereo_pick.core.errors import CalibrationError
from stereo_pick.core.hand_eye.pairs import Mount, RobotView
from stereo_pick.core.hand_eye.rotations import rotation_matrix, rotation_vector
from stereo_pick.core.hand_eye.solvers import SOLVERS
from stereo_pick.core.hand_eye.solving import solve_hand_eye
from stereo_pick.core.transform import Transform


def pose(rotation: object, translation: object) -> Transform:
    return Transform(rotation_matrix(np.array(rotation, float)), np.array(translation, float))


TRUTH = {
    Mount.EYE_TO_HAND: pose([2.1, 0.3, -0.4], [0.8, 0.1, 0.9]),
    Mount.EYE_IN_HAND: pose([0.1, -0.2, 1.5], [0.05, 0.02, 0.08]),
}
FIXED = {
    Mount.EYE_TO_HAND: pose([0.1, 0.2, -0.3], [0.02, 0.03, 0.1]),  # flange_T_board
    Mount.EYE_IN_HAND: pose([0.5, 2, 1], [0.6, 0.1, 0]),  # base_T_board
}


def robot_view(mount: Mount, camera_T_board: Transform, name: str = "view") -> RobotView:
    X, Y = TRUTH[mount], FIXED[mount]
    stand_T_parent = Y @ camera_T_board.inverse() @ X.inverse()
    A = stand_T_parent if mount is Mount.EYE_IN_HAND else stand_T_parent.inverse()
    return RobotView(name, A, camera_T_board)


def simulate(
    mount: Mount, seed: int = 0, count: int = 15, sigma_rad: float = 0.0, sigma_m: float = 0.0
) -> list[RobotView]:
    """Pairs whose board was seen with noise in its rotation and position."""
    rng = np.random.default_rng(seed)
    views = []
    for i in range(count):
        camera_T_board = pose(rng.uniform(-0.5, 0.5, 3) + [3, 0, 0], rng.uniform(-0.1, 0.1, 3) + [0, 0, 0.8])
        exact = robot_view(mount, camera_T_board, f"view{i:02d}")
        noisy = camera_T_board @ pose(rng.normal(0, sigma_rad, 3), np.zeros(3))
        moved = Transform(noisy.rotation, noisy.translation + rng.normal(0, sigma_m, 3))
        views.append(RobotView(exact.name, exact.base_T_flange, moved))
    return views


def error(found: Transform, truth: Transform) -> np.ndarray:
    """Rotation vector [rad] and translation [m] (6,) from what was found to the truth, in the parent's frame."""
    return np.r_[rotation_vector(truth.rotation @ found.rotation.T), truth.translation - found.translation]


@pytest.mark.parametrize("mount", Mount)
@pytest.mark.parametrize("count", [3, 15])
def test_exact_pairs_give_the_exact_place(mount: Mount, count: int) -> None:
    result = solve_hand_eye(simulate(mount, seed=count, count=count), mount)
    assert result.name == {Mount.EYE_TO_HAND: "base_T_camera", Mount.EYE_IN_HAND: "flange_T_camera"}[mount]
    np.testing.assert_allclose(error(result.found.transform, TRUTH[mount]), 0, atol=1e-9)
    assert result.rms_mm < 1e-6
    assert result.warnings == () if count > 3 else result.warnings[0].startswith("only 3 pairs")


@pytest.mark.parametrize("mount", Mount)
def test_the_stated_uncertainty_covers_the_truth_as_often_as_it_claims(mount: Mount) -> None:
    seeds = 50
    ratios, distances = [], []
    for seed in range(seeds):
        found = solve_hand_eye(simulate(mount, seed, 12, 2e-3, 5e-4), mount).found
        off = error(found.transform, TRUTH[mount])
        ratios.append(np.abs(off) / np.sqrt(np.diag(found.covariance)))
        distances.append(off @ np.linalg.solve(found.covariance, off))
    assert np.mean(np.array(ratios) < 1) == pytest.approx(0.68, abs=0.07)
    assert np.mean(np.array(ratios) < 2) == pytest.approx(0.954, abs=0.04)
    assert np.mean(distances) == pytest.approx(6, abs=4 * np.sqrt(12 / seeds))  # chi-square of 6 degrees


def test_five_pairs_state_what_little_they_know() -> None:
    ratios = []
    for seed in range(60):
        found = solve_hand_eye(simulate(Mount.EYE_TO_HAND, seed, 5, 2e-3, 5e-4), Mount.EYE_TO_HAND).found
        ratios.append(np.abs(error(found.transform, TRUTH[Mount.EYE_TO_HAND])) / np.sqrt(np.diag(found.covariance)))
    assert np.mean(np.array(ratios) < 2) == pytest.approx(0.95, abs=0.06)


def test_a_solver_that_fails_keeps_quiet(capfd: pytest.CaptureFixture[str]) -> None:
    views = [robot_view(Mount.EYE_TO_HAND, pose([3, turn, 0.1 * turn**2], [0, 0, 0.8])) for turn in (0, 0.1, 0.2)]
    with pytest.raises(CalibrationError):
        solve_hand_eye(views, Mount.EYE_TO_HAND)
    for solver in SOLVERS.values():
        solver([view.base_T_flange.inverse() for view in views], [view.camera_T_board for view in views])
    assert capfd.readouterr().err == ""


@pytest.mark.parametrize("mount", Mount)
def test_the_refined_place_is_better_than_that_of_any_single_solver(mount: Mount) -> None:
    squares: dict[str, list[float]] = {}
    for seed in range(12):
        views = simulate(mount, seed, 12, 2e-3, 5e-4)
        result = solve_hand_eye(views, mount)
        assert {attempt.solver for attempt in result.attempts} <= set(SOLVERS) and len(result.attempts) >= 5
        squares.setdefault("refined", []).append(float((error(result.found.transform, TRUTH[mount])[3:] ** 2).sum()))
        A, B = [view.stand_T_parent(mount) for view in views], [view.camera_T_board for view in views]
        for name, solver in SOLVERS.items():
            X = solver(A, B)
            assert X is not None
            squares.setdefault(name, []).append(float((error(X, TRUTH[mount])[3:] ** 2).sum()))
    mean = {name: np.mean(each) for name, each in squares.items()}
    assert mean["refined"] <= min(mean.values()) * 1.1, mean


def test_the_weights_are_found_whichever_noise_is_the_larger() -> None:
    for sigma_rad, sigma_m in ((5e-3, 1e-5), (1e-5, 2e-3)):
        result = solve_hand_eye(simulate(Mount.EYE_TO_HAND, 3, 20, sigma_rad, sigma_m), Mount.EYE_TO_HAND)
        assert np.radians(result.rms_deg or 0) == pytest.approx(sigma_rad * np.sqrt(3), rel=0.3)
        assert result.rms_mm / 1000 == pytest.approx(sigma_m * np.sqrt(3), rel=0.35)


def test_a_point_s_covariance_grows_with_its_distance_as_the_turn_does() -> None:
    found = solve_hand_eye(simulate(Mount.EYE_TO_HAND, 1, 15, 2e-3, 5e-4), Mount.EYE_TO_HAND).found
    rng = np.random.default_rng(0)
    point = np.array([0.1, -0.1, 0.7])
    draws = rng.multivariate_normal(np.zeros(6), found.covariance, 4000)
    X = found.transform
    moved = [rotation_matrix(draw[:3]) @ X.rotation @ point + X.translation + draw[3:] for draw in draws]
    np.testing.assert_allclose(found.point_covariance(point[None])[0], np.cov(np.transpose(moved)), rtol=0.2, atol=1e-8)


def test_a_pair_of_two_moments_is_suspected_by_name() -> None:
    views = simulate(Mount.EYE_TO_HAND, 5, 15, 5e-4, 2e-4)
    late = views[6].camera_T_board
    views[6] = RobotView("view06", views[6].base_T_flange, Transform(late.rotation, late.translation + [0.02, 0, 0]))
    warnings = solve_hand_eye(views, Mount.EYE_TO_HAND).warnings
    assert len(warnings) == 1 and warnings[0].startswith("view06 misses by")


@pytest.mark.parametrize("mount", Mount)
def test_views_without_rotation_are_refused_with_the_measured_angle(mount: Mount) -> None:
    rng = np.random.default_rng(0)
    boards = [pose([3, 0.1, 0] + rng.normal(0, 1e-3, 3), rng.uniform(-0.2, 0.2, 3) + [0, 0, 0.8]) for _ in range(10)]
    with pytest.raises(CalibrationError, match=r"differ by 0\.\d+ deg at most: without rotation"):
        solve_hand_eye([robot_view(mount, board) for board in boards], mount)


@pytest.mark.parametrize("mount", Mount)
def test_turns_about_one_axis_are_refused_with_the_measured_angles(mount: Mount) -> None:
    rng = np.random.default_rng(0)
    start = pose([3, 0.1, 0], np.zeros(3)).rotation
    boards = [
        Transform(rotation_matrix(np.array([0, 0, turn])) @ start, rng.uniform(-0.1, 0.1, 3) + [0, 0, 0.8])
        for turn in np.linspace(-0.6, 0.6, 10)
    ]
    with pytest.raises(CalibrationError, match=r"about one axis \(68\.\d deg about it, 0\.00 deg off it"):
        solve_hand_eye([robot_view(mount, board) for board in boards], mount)


def test_too_few_pairs_and_millimetres_are_refused() -> None:
    views = simulate(Mount.EYE_TO_HAND)
    with pytest.raises(CalibrationError, match="2 pairs of robot pose and board view: at least 3"):
        solve_hand_eye(views[:2], Mount.EYE_TO_HAND)
    flange = views[4].base_T_flange
    views[4] = RobotView("view04", Transform(flange.rotation, flange.translation * 1000), views[4].camera_T_board)
    with pytest.raises(CalibrationError, match="view04: the flange is .* millimetres"):
        solve_hand_eye(views, Mount.EYE_TO_HAND)


@pytest.mark.parametrize("mount", Mount)
def test_the_wrong_mount_is_refused_and_the_right_one_named(mount: Mount) -> None:
    with pytest.raises(CalibrationError, match=f"do not fit together: rms .* they fit as {mount.other.value}"):
        solve_hand_eye(simulate(mount.other, 2, 10, 1e-3, 3e-4), mount)


def test_an_inverted_board_pose_is_refused_and_named() -> None:
    views = [RobotView(v.name, v.base_T_flange, v.camera_T_board.inverse()) for v in simulate(Mount.EYE_TO_HAND, 2, 10)]
    with pytest.raises(CalibrationError, match="one of the poses the inverse"):
        solve_hand_eye(views, Mount.EYE_TO_HAND)


def test_pairs_in_another_order_are_refused() -> None:
    views = simulate(Mount.EYE_TO_HAND, 2, 10)
    shifted = [RobotView(a.name, a.base_T_flange, b.camera_T_board) for a, b in zip(views, views[1:] + views[:1])]
    with pytest.raises(CalibrationError, match="in this order"):
        solve_hand_eye(shifted, Mount.EYE_TO_HAND)


def scaled(views: list[RobotView], scale: float) -> list[RobotView]:
    """The same, with squares that were given so many times too large."""
    boards = [Transform(view.camera_T_board.rotation, scale * view.camera_T_board.translation) for view in views]
    return [RobotView(view.name, view.base_T_flange, board) for view, board in zip(views, boards)]


@pytest.mark.parametrize("mount", Mount)
@pytest.mark.parametrize(("scale", "says"), [(30 / 29, "smaller"), (28.5 / 29, "larger")])
def test_a_wrong_square_size_is_refused_that_the_residuals_hardly_show(mount: Mount, scale: float, says: str) -> None:
    exact = solve_hand_eye(simulate(mount, seed=4), mount).found.transform.translation
    views = simulate(mount, 4, sigma_rad=1e-3, sigma_m=3e-4)
    assert np.linalg.norm(solve_hand_eye(views, mount).found.transform.translation - exact) < 2e-3
    with pytest.raises(CalibrationError, match=rf"% {says}.*square size") as error:
        solve_hand_eye(scaled(views, scale), mount)
    told = re.search(r"would be ([0-9.]+) times", str(error.value))
    assert told is not None and float(told[1]) == pytest.approx(1 / scale, abs=2e-3)


@pytest.mark.parametrize("mount", Mount)
def test_noise_is_no_wrong_square_size(mount: Mount) -> None:
    for seed in range(40):
        solve_hand_eye(simulate(mount, seed, 6 + seed % 7, 3e-3, 2e-3), mount)
        solve_hand_eye(scaled(simulate(mount, seed, 12, 1e-3, 3e-4), 1.001), mount)
