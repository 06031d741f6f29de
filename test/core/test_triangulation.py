"""Triangulation against points, other formulas and chance."""

from __future__ import annotations

from dataclasses import replace

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from outlines import BASELINE_M, PARALLEL
from rigs import RIGS, SIZE_PX, random_rigs

from stereo_pick.core.arrays import Floats
from stereo_pick.core.camera import Camera
from stereo_pick.core.correspondence import Correspondences
from stereo_pick.core.refusal import Refusal, count_reasons
from stereo_pick.core.rig import StereoRig
from stereo_pick.core.triangulation import Points, Triangulator, closest_points

ANY_GAP = Triangulator(max_ray_gap_m=1.0)
SEEDS = st.integers(0, 2**31)


def points_before(rig: StereoRig, seed: int, count: int = 10) -> Floats:
    """Points (N, 3) [m] in the left frame that lie before both cameras."""
    rng = np.random.default_rng(seed)
    rays = np.c_[rig.left.normalized(rng.uniform((0, 0), SIZE_PX, (count, 2))), np.ones(count)]
    points = rays * rng.uniform(0.4, 3.0, (count, 1))
    return points[rig.right_T_left.apply(points)[:, 2] > 0.1]


def seen_at(left_px: Floats, right_px: Floats, sigma_px: float | Floats = 0.3) -> Correspondences:
    count = len(left_px)
    sigma = np.broadcast_to(sigma_px, (count, 2))
    return Correspondences(left_px, right_px, sigma, np.ones((count, 2)), np.zeros(count))


def shown(rig: StereoRig, points: Floats) -> tuple[Floats, Floats]:
    """Rectified pixels of points by P and R alone, without the lens."""
    return view(rig.left, points), view(rig.right, rig.right_T_left.apply(points))


def view(lens: Camera, points: Floats) -> Floats:
    turned = points @ lens.R.T
    return turned[:, :2] / turned[:, 2:] * lens.P[0, 0] + lens.P[:2, 2]


@given(random_rigs(), SEEDS)
def test_points_come_back_from_their_images(rig: StereoRig, seed: int) -> None:
    points = points_before(rig, seed)
    found = Triangulator().triangulate(seen_at(*shown(rig, points)), rig)
    np.testing.assert_allclose(found.xyz, points, atol=1e-8)
    np.testing.assert_allclose(found.ray_gap, 0, atol=1e-8)
    np.testing.assert_array_equal(found.row, np.arange(len(points)))


@pytest.mark.parametrize("name", RIGS)
def test_points_come_back_through_the_lenses_too(name: str) -> None:
    rig = RIGS[name]
    points = np.random.default_rng(2).uniform((-0.1, -0.1, 0.8), (0.1, 0.1, 1.0), (20, 3))
    left_px, right_px = (lens.rectified(raw) for lens, raw in zip((rig.left, rig.right), rig.project(points)))
    np.testing.assert_allclose(Triangulator().triangulate(seen_at(left_px, right_px), rig).xyz, points, atol=1e-6)


@given(st.floats(50, 600), st.floats(20, 460), st.floats(5, 200))
def test_parallel_cameras_give_equations_1_34_to_1_36(u: float, v: float, disparity_px: float) -> None:
    focal, (cx, cy) = PARALLEL.focal_px, PARALLEL.left.P[:2, 2]
    z = BASELINE_M * focal / disparity_px
    expected = ((u - cx) * z / focal, (v - cy) * z / focal, z)
    found = Triangulator().triangulate(seen_at(np.array([(u, v)]), np.array([(u - disparity_px, v)])), PARALLEL)
    np.testing.assert_allclose(found.xyz[0], expected, rtol=1e-9, atol=1e-12)


@given(random_rigs(), SEEDS)
def test_the_linear_method_of_opencv_finds_the_same_points(rig: StereoRig, seed: int) -> None:
    left_px, right_px = shown(rig, points_before(rig, seed))
    homogeneous = cv2.triangulatePoints(rig.left.P, rig.right.P, left_px.T, right_px.T).T
    rectified = homogeneous[:, :3] / homogeneous[:, 3:]
    found = Triangulator().triangulate(seen_at(left_px, right_px), rig)
    np.testing.assert_allclose(found.xyz, rectified @ rig.left.R, atol=1e-6)


@given(random_rigs(), SEEDS)
def test_the_closed_form_is_the_least_squares_solution(rig: StereoRig, seed: int) -> None:
    """Equation 3.21 solves 3.19, A [Z_R, Z_L] = T, also for rays that do not meet."""
    rng = np.random.default_rng(seed)
    p, q = (np.c_[rng.uniform(-0.3, 0.3, (8, 2)), np.ones(8)] for _ in range(2))
    left, right = closest_points(p, q, rig.right_T_left)
    left_T_right = rig.right_T_left.inverse()
    for i in range(8):
        A = np.stack([-left_T_right.rotation @ q[i], p[i]], axis=1)
        (z_right, z_left), *_ = np.linalg.lstsq(A, left_T_right.translation, rcond=None)
        np.testing.assert_allclose(left[i], z_left * p[i], rtol=1e-6, atol=1e-9)
        np.testing.assert_allclose(right[i], left_T_right.apply(z_right * q[i]), rtol=1e-6, atol=1e-9)


@given(random_rigs(), SEEDS, st.floats(-3, 3))
def test_the_gap_of_skewed_rays_is_their_distance(rig: StereoRig, seed: int, rows_px: float) -> None:
    left_px, right_px = shown(rig, points_before(rig, seed))
    right_px = right_px + (0, rows_px)
    found = ANY_GAP.triangulate(seen_at(left_px, right_px), rig)
    left_T_right = rig.right_T_left.inverse()
    p, q = rig.left.rays(left_px), rig.right.rays(right_px) @ left_T_right.rotation.T
    normal = np.cross(p, q)
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    np.testing.assert_allclose(found.ray_gap, np.abs(normal @ left_T_right.translation)[found.row], atol=1e-9)
    for origin, ray in ((np.zeros(3), p), (left_T_right.translation, q)):
        off = np.linalg.norm(np.cross(found.xyz - origin, ray[found.row]), axis=1)
        off /= np.linalg.norm(ray[found.row], axis=1)
        np.testing.assert_allclose(off, found.ray_gap / 2, atol=1e-9)


@pytest.mark.parametrize("name", RIGS)
@pytest.mark.parametrize("sigma_px", [(0.3, 0.3), (0.1, 0.6)])
def test_the_covariance_is_that_of_many_noisy_measurements(name: str, sigma_px: tuple[float, float]) -> None:
    rig, rng = RIGS[name], np.random.default_rng(9)
    point = np.array([[0.05, -0.03, 0.95]])
    left_px, right_px = shown(rig, point)
    stated = Triangulator().triangulate(seen_at(left_px, right_px, np.array(sigma_px)), rig).covariance[0]
    noisy = [px + rng.normal(0, sigma, (20000, 2)) for px, sigma in zip((left_px, right_px), sigma_px)]
    scatter = np.cov(ANY_GAP.triangulate(seen_at(*noisy), rig).xyz.T)
    np.testing.assert_allclose(stated, scatter, atol=0.1 * np.abs(scatter).max())
    np.testing.assert_allclose(np.linalg.eigvalsh(stated), np.linalg.eigvalsh(scatter), rtol=0.1)


@pytest.mark.parametrize("name", RIGS)
def test_what_moves_both_points_together_adds_to_the_covariance(name: str) -> None:
    """A point that is somewhere else in the rectified frame, and is seen there exactly."""
    rig, rng = RIGS[name], np.random.default_rng(10)
    root = rng.normal(scale=3e-4, size=(3, 3))
    moved = np.array([0.05, -0.03, 0.95]) + rng.normal(size=(20000, 3)) @ root.T @ rig.left.R
    scatter = np.cov(ANY_GAP.triangulate(seen_at(*shown(rig, moved)), rig).xyz.T)
    seen = seen_at(*shown(rig, moved[:1]), sigma_px=1e-6)
    stated = Triangulator().triangulate(replace(seen, covariance=(root @ root.T)[None]), rig).covariance[0]
    np.testing.assert_allclose(stated, scatter, atol=0.05 * np.abs(scatter).max())


def test_rays_that_meet_behind_the_cameras_are_refused() -> None:
    left_px, right_px = shown(PARALLEL, np.array([(0.0, 0.0, 0.9), (0.05, 0.0, 1.0)]))
    found = Triangulator().triangulate(seen_at(right_px, left_px), PARALLEL)
    assert len(found) == 0 and count_reasons(found.refused) == {"behind_camera": 2}
    assert found.refused[0].detail == "z = -0.900 m"


@pytest.mark.parametrize("name", RIGS)
def test_parallel_rays_are_refused(name: str) -> None:
    rig = RIGS[name]
    offset = rig.left.P[0, 2] - rig.right.P[0, 2]
    found = Triangulator().triangulate(seen_at(np.array([(300.0, 200.0)]), np.array([(300.0 - offset, 200.0)])), rig)
    assert count_reasons(found.refused) == {"behind_camera": 1}


def test_a_gap_is_refused_with_its_size_and_the_others_stay() -> None:
    points = np.array([(-0.05, 0.0, 0.9), (0.0, 0.0, 0.9), (0.05, 0.0, 0.9)])
    left_px, right_px = shown(PARALLEL, points)
    right_px[1, 1] += 20
    found = Triangulator(max_ray_gap_m=0.01).triangulate(seen_at(left_px, right_px), PARALLEL)
    (refusal,) = found.refused
    assert refusal.reason == "ray_gap"
    assert float(refusal.detail.removesuffix(" mm")) == pytest.approx(20 * 0.9 / 900 * 1000, rel=0.02)
    np.testing.assert_array_equal(refusal.left_px, left_px[1])
    np.testing.assert_array_equal(found.row, [0, 2])
    np.testing.assert_allclose(found.xyz, points[[0, 2]], atol=1e-9)


def test_what_was_refused_before_stays_refused() -> None:
    before = (Refusal("faint", np.zeros(2), None),)
    for count in (0, 1):
        pixels = np.full((count, 2), 300.0)
        correspondences = Correspondences(
            pixels, pixels - (90, 0), np.ones((count, 2)), np.ones((count, 2)), np.zeros(count), before
        )
        found = Triangulator().triangulate(correspondences, PARALLEL)
        assert len(found) == count and found.refused == before


def test_points_cannot_be_changed() -> None:
    points = Points(np.zeros((1, 3)), np.zeros((1, 3, 3)), np.zeros(1), np.zeros(1, np.int64), 0.005)
    for array in (points.xyz, points.covariance, points.ray_gap, points.row):
        assert not array.flags.writeable


def test_the_centroids_that_the_thesis_prints_are_refused_not_published() -> None:
    """Table 3.15 under the calibration of 3.4: the rays of every object miss each other by about 3 cm."""
    rig = RIGS["thesis"]
    left_raw = np.array([(62.37, 410.94), (176.12, 438.88), (303.98, 395.26), (422.89, 420.57)])
    right_raw = np.array([(143.80, 286.43), (195.9, 316.56), (375.615, 276.477), (443.94, 306.36)])
    found = Triangulator().triangulate(seen_at(rig.left.rectified(left_raw), rig.right.rectified(right_raw)), rig)
    assert len(found) == 0 and count_reasons(found.refused) == {"ray_gap": 4}
    gaps_mm = [float(refusal.detail.removesuffix(" mm")) for refusal in found.refused]
    assert min(gaps_mm) > 27 and max(gaps_mm) < 34
