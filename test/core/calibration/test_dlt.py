"""The thesis's direct linear transformation: exact where the pixels are, honest where they are not."""

from __future__ import annotations

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from stereo_pick.core.calibration.dlt import MAX_CONDITION, direct_linear
from stereo_pick.core.calibration.least_squares import SOLVERS, condition
from stereo_pick.core.errors import CalibrationError, ParameterError
from stereo_pick.core.transform import Transform

K = np.array([[812.0, 1.5, 331], [0, 797, 236], [0, 0, 1]])
camera_T_world = Transform(cv2.Rodrigues(np.array([0.4, -0.3, 0.1]))[0], np.array([0.02, -0.01, 0.6]))
CUBE = np.array([[x, y, z] for x in (0, 0.1, 0.2) for y in (0, 0.1, 0.2) for z in (0, 0.1)])


def seen(xyz: np.ndarray, K: np.ndarray = K, pose: Transform = camera_T_world) -> np.ndarray:
    homogeneous = pose.apply(xyz) @ K.T
    return homogeneous[:, :2] / homogeneous[:, 2:]


@pytest.mark.parametrize("solver", SOLVERS)
@settings(max_examples=60, deadline=None)
@given(
    seed=st.integers(0, 2**32 - 1),
    focal_px=st.floats(200, 4000),
    aspect=st.floats(0.8, 1.2),
    skew_px=st.floats(-20, 20),
    count=st.integers(12, 60),
)
def test_exact_pixels_give_the_exact_camera(
    solver: str, seed: int, focal_px: float, aspect: float, skew_px: float, count: int
) -> None:
    rng = np.random.default_rng(seed)
    K = np.array([[focal_px, skew_px, rng.uniform(0, 640)], [0, focal_px * aspect, rng.uniform(0, 480)], [0, 0, 1]])
    R = cv2.Rodrigues(rng.uniform(-1, 1, 3) * 1.8)[0]
    xyz = rng.uniform(-0.2, 0.2, (count, 3))
    pose = Transform(R, np.array([*rng.uniform(-0.1, 0.1, 2), rng.uniform(0.6, 1.2)]))
    found = direct_linear(xyz, seen(xyz, K, pose), solver)
    camera = found.split()
    np.testing.assert_allclose(camera.K, K, rtol=0, atol=1e-9 * focal_px)
    np.testing.assert_allclose(camera.camera_T_world.rotation, pose.rotation, rtol=0, atol=1e-9)
    np.testing.assert_allclose(camera.camera_T_world.translation, pose.translation, rtol=0, atol=1e-9)
    assert found.rms_px < 1e-9 * focal_px


def test_six_points_are_enough_and_the_eleven_parameters_are_the_thesis_s() -> None:
    xyz = CUBE[[0, 2, 7, 9, 14, 17]]
    found = direct_linear(xyz, seen(xyz))
    g = found.parameters
    assert g.shape == (11,)
    X, Y, Z = CUBE.T
    H = g[8] * X + g[9] * Y + g[10] * Z + 1  # eq. 1.19 and 1.20, written out
    expected = np.c_[(g[0] * X + g[1] * Y + g[2] * Z + g[3]) / H, (g[4] * X + g[5] * Y + g[6] * Z + g[7]) / H]
    np.testing.assert_allclose(expected, seen(CUBE), atol=1e-8)
    np.testing.assert_allclose(found.project(CUBE), expected, atol=1e-8)


def test_the_split_multiplied_again_is_the_projection() -> None:
    found = direct_linear(CUBE, seen(CUBE))
    camera = found.split()
    pose = camera.camera_T_world
    np.testing.assert_allclose(camera.K @ np.c_[pose.rotation, pose.translation], found.projection, atol=1e-9)
    np.testing.assert_allclose(pose.apply(camera.centre[None]), 0, atol=1e-12)
    assert np.diag(camera.K).min() > 0 and np.linalg.det(pose.rotation) == pytest.approx(1)


def test_an_origin_in_the_camera_s_plane_has_a_projection_but_no_eleven_parameters() -> None:
    pose = Transform(camera_T_world.rotation, np.zeros(3))
    xyz = CUBE + pose.inverse().apply(np.array([0.0, 0, 0.7]))
    found = direct_linear(xyz, seen(xyz, pose=pose))
    np.testing.assert_allclose(found.split().K, K, atol=1e-6)
    with pytest.raises(CalibrationError, match="another origin"):
        _ = found.parameters


def test_the_solvers_agree_on_noisy_pixels() -> None:
    noisy = seen(CUBE) + np.random.default_rng(1).normal(0, 0.3, (len(CUBE), 2))
    svd, normal = (direct_linear(CUBE, noisy, solver).projection for solver in SOLVERS)
    np.testing.assert_allclose(normal, svd, rtol=1e-9)


def test_noise_leaves_the_residuals_that_eleven_fitted_parameters_must() -> None:
    sigma_px, rng = 0.2, np.random.default_rng(2)
    freedom = 2 * len(CUBE) - 11
    sums = [
        (direct_linear(CUBE, seen(CUBE) + rng.normal(0, sigma_px, (18, 2))).residuals_px ** 2).sum() for _ in range(300)
    ]
    spread = np.sqrt(2 / (freedom * len(sums)))
    assert np.mean(sums) / (sigma_px**2 * freedom) == pytest.approx(1, abs=4 * spread)


def test_a_plane_is_refused_with_its_condition() -> None:
    plane = CUBE * [1, 1, 0] + camera_T_world.rotation[1] * 0.01
    noisy = seen(plane) + np.random.default_rng(3).normal(0, 0.2, (18, 2))
    with pytest.raises(CalibrationError, match=r"condition .*they stand .* mm \(rms\) off their common plane"):
        direct_linear(plane, noisy)


def test_a_nearly_flat_target_is_refused_too_and_a_deep_one_is_well_conditioned() -> None:
    flat = CUBE * [1, 1, 0.005]
    with pytest.raises(CalibrationError, match="0.25 mm"):
        direct_linear(flat, seen(flat))
    assert direct_linear(CUBE, seen(CUBE)).condition < MAX_CONDITION / 20


def test_too_few_unpaired_or_broken_points_are_refused() -> None:
    with pytest.raises(CalibrationError, match="5 points give 10 equations for 11 parameters"):
        direct_linear(CUBE[:5], seen(CUBE)[:5])
    with pytest.raises(CalibrationError, match="18 target points and 17 pixels"):
        direct_linear(CUBE, seen(CUBE)[:17])
    with pytest.raises(CalibrationError, match="finite"):
        direct_linear(CUBE, np.where(seen(CUBE) > 300, np.nan, 0))
    with pytest.raises(ParameterError, match="svd, normal_equations"):
        direct_linear(CUBE, seen(CUBE), "magic")


def test_a_mirrored_image_has_a_projection_but_is_no_camera() -> None:
    mirrored = direct_linear(CUBE, seen(CUBE) * [-1, 1] + [640, 0])
    assert mirrored.rms_px < 1e-6
    with pytest.raises(CalibrationError, match="mirrored"):
        mirrored.split()


def test_exchanged_pixels_are_refused_or_show_in_the_residuals() -> None:
    shuffled = seen(CUBE)[np.random.default_rng(4).permutation(18)]
    try:
        assert direct_linear(CUBE, shuffled).rms_px > 20
    except CalibrationError as error:
        assert "behind the camera" in str(error)


def test_the_linear_solvers_solve_and_name_their_condition() -> None:
    rng = np.random.default_rng(5)
    A, x = rng.normal(size=(20, 4)), np.array([1.0, -2, 3, 0.5])
    for solve in SOLVERS.values():
        noise = rng.normal(size=20)
        found = solve(A, A @ x + noise)
        np.testing.assert_allclose(A.T @ (A @ found - A @ x - noise), 0, atol=1e-12)
    assert condition(np.diag([8.0, 2.0])) == 4
    assert condition(np.ones((3, 2))) > 1e15
