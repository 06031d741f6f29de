"""Hand-eye from touched points: the rigid fit, its uncertainty, and what is refused."""

from __future__ import annotations

import numpy as np
import pytest

from stereo_pick.core.errors import ArrayError, CalibrationError
from stereo_pick.core.hand_eye.rotations import from_quaternion, rotation_matrix, rotation_vector, to_quaternion
from stereo_pick.core.hand_eye.touched import TouchedPoint, solve_touched
from stereo_pick.core.transform import Transform

base_T_camera = Transform(rotation_matrix(np.array([2.1, 0.3, -0.4])), np.array([0.8, 0.1, 0.9]))
CORNERS = np.array(
    [[-0.1, -0.1, 0.8], [0.1, -0.1, 0.8], [0.1, 0.1, 0.75], [-0.1, 0.1, 0.8], [0, 0, 0.7], [0.05, 0, 0.82]]
)


def touched(camera: np.ndarray, sigma_m: float = 0.0, seed: int = 0) -> list[TouchedPoint]:
    base = base_T_camera.apply(camera) + np.random.default_rng(seed).normal(0, sigma_m, camera.shape)
    return [TouchedPoint(f"point{i}", b, c) for i, (b, c) in enumerate(zip(base, camera))]


def error(found: Transform) -> np.ndarray:
    turn = rotation_vector(base_T_camera.rotation @ found.rotation.T)
    return np.r_[turn, base_T_camera.translation - found.translation]


@pytest.mark.parametrize("count", [3, 6])
def test_exact_points_give_the_exact_place(count: int) -> None:
    result = solve_touched(touched(CORNERS[:count]))
    np.testing.assert_allclose(error(result.found.transform), 0, atol=1e-12)
    assert result.name == "base_T_camera" and result.rms_deg is None and result.rms_mm < 1e-9
    assert [text[:28] for text in result.warnings] == ["the points lie in one plane,"] * (count == 3)


@pytest.mark.parametrize("mirrored", [(1, -1, 1), (1, 1, -1)])
def test_a_left_handed_frame_is_refused_where_the_points_tell(mirrored: tuple[int, int, int]) -> None:
    low = CORNERS * (1, 1, 0.2)  # hardly off one plane
    points = [TouchedPoint(p.name, p.base_xyz * mirrored, p.camera_xyz) for p in touched(low, 5e-4)]
    with pytest.raises(CalibrationError, match="with one frame mirrored: is one left-handed"):
        solve_touched(points)


@pytest.mark.parametrize(("mirrored", "stands_mm"), [((1, 1, 1), 900), ((1, -1, 1), -860)])
def test_points_in_one_plane_cannot_tell_and_what_would_is_said(mirrored: tuple[int, int, int], stands_mm: int) -> None:
    """Those of a level table, 20 mm up, seen from above."""
    table = np.array([(x, y, 0.02) for x in (0.3, 0.4, 0.5) for y in (-0.2, 0.1)])
    points = [
        TouchedPoint(str(i), base * mirrored, camera)
        for i, (base, camera) in enumerate(zip(table, base_T_camera.inverse().apply(table)))
    ]
    (warning,) = solve_touched(points).warnings
    assert f"the camera stands at z = {stands_mm} mm of the base, and they at 20 mm" in warning


def test_the_stated_uncertainty_covers_the_truth_as_often_as_it_claims() -> None:
    ratios = []
    for seed in range(200):
        camera = np.random.default_rng(seed + 1000).uniform(-0.15, 0.15, (12, 3)) + [0, 0, 0.8]
        found = solve_touched(touched(camera, 5e-4, seed)).found
        ratios.append(np.abs(error(found.transform)) / np.sqrt(np.diag(found.covariance)))
    assert np.mean(np.array(ratios) < 1) == pytest.approx(0.68, abs=0.05)
    assert np.mean(np.array(ratios) < 2) == pytest.approx(0.95, abs=0.03)


def test_each_point_has_its_residual_and_an_outlier_its_name() -> None:
    points = touched(CORNERS, 2e-4)
    points[3] = TouchedPoint("point3", points[3].base_xyz + [0, 0.008, 0], points[3].camera_xyz)
    result = solve_touched(points)
    assert [residual.name for residual in result.residuals] == [f"point{i}" for i in range(6)]
    assert max(result.residuals, key=lambda each: each.translation_mm).name == "point3"
    assert len(result.warnings) == 1 and result.warnings[0].startswith("point3 is ")
    miss_mm = float(result.warnings[0].split()[2])
    assert miss_mm == pytest.approx(8, abs=1)


def test_honest_noise_is_no_outlier() -> None:
    assert sum(bool(solve_touched(touched(CORNERS, 5e-4, seed)).warnings) for seed in range(100)) <= 1


def test_points_on_a_line_are_refused_with_the_measured_distance() -> None:
    line = np.array([[0, 0, 0.8], [0.1, 0.001, 0.8], [0.2, 0, 0.8], [0.3, 0, 0.8]])
    with pytest.raises(CalibrationError, match=r"lie on a line: 0\.4\d mm \(rms\) off it, 111\.\d mm along it"):
        solve_touched(touched(line))
    with pytest.raises(CalibrationError, match="lie on a line: 0.00 mm"):
        solve_touched(touched(line * [1, 0, 1]))


def test_what_cannot_be_fitted_is_refused() -> None:
    with pytest.raises(CalibrationError, match="2 touched points: at least 3"):
        solve_touched(touched(CORNERS[:2]))
    with pytest.raises(CalibrationError, match="1000 times as far apart"):
        solve_touched([TouchedPoint(p.name, p.base_xyz, p.camera_xyz * 1000) for p in touched(CORNERS)])
    with pytest.raises(CalibrationError, match=r"point0, as touched, is 888 m from the base: .* give metres"):
        solve_touched([TouchedPoint(p.name, p.base_xyz * 1000, p.camera_xyz * 1000) for p in touched(CORNERS)])
    with pytest.raises(CalibrationError, match="do not fit together"):
        solve_touched(
            [TouchedPoint(p.name, p.base_xyz, q.camera_xyz) for p, q in zip(touched(CORNERS), touched(CORNERS[::-1]))]
        )
    with pytest.raises(ArrayError, match="point: base_xyz holds nan"):
        TouchedPoint("point", np.array([0, np.nan, 0]), np.zeros(3))


def test_one_place_touched_again_and_again_is_refused() -> None:
    with pytest.raises(CalibrationError):
        solve_touched(touched(np.full((4, 3), 0.5)))


@pytest.mark.parametrize("vector", [[0, 0, 0], [0.3, -1, 2], [3.14159265, 0, 0], [0, 2.2, -2.2], [1e-9, 0, 0]])
def test_quaternions_there_and_back(vector: list[float]) -> None:
    rotation = rotation_matrix(np.array(vector, float))
    quaternion = to_quaternion(rotation)
    assert np.linalg.norm(quaternion) == pytest.approx(1)
    np.testing.assert_allclose(from_quaternion(np.zeros(3), quaternion).rotation, rotation, atol=1e-14)
    if np.linalg.norm(vector) < 3:
        np.testing.assert_allclose(rotation_vector(rotation), vector, rtol=1e-12, atol=1e-15)


def test_several_rotations_at_once_are_what_each_is_by_itself() -> None:
    several = np.array([rotation_matrix(np.array(each)) for each in ([0, 0, 0], [0.3, -1, 2], [0, 2.2, -2.2])])
    np.testing.assert_array_equal(to_quaternion(several), [to_quaternion(each) for each in several])
    np.testing.assert_array_equal(rotation_vector(several), [rotation_vector(each) for each in several])


def test_a_quaternion_is_x_y_z_w_and_has_length_one() -> None:
    quarter = from_quaternion([1, 2, 3], [0, 0, np.sqrt(0.5), np.sqrt(0.5)])
    np.testing.assert_allclose(quarter.apply(np.array([1.0, 0, 0])), [1, 3, 3], atol=1e-12)
    with pytest.raises(ArrayError, match="length 2"):
        from_quaternion([0, 0, 0], [0, 0, 0, 2])
