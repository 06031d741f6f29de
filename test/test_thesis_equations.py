"""The thesis's equations as it prints them, against the code that stands for them (docs/thesis.md)."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from rigs import camera, random_rigs, thesis_cameras

from stereo_pick.core.arrays import Floats
from stereo_pick.core.correspondence.feature import least_area_difference
from stereo_pick.core.errors import CalibrationError
from stereo_pick.core.hand_eye.rotations import rotation_matrix
from stereo_pick.core.objects import Blob
from stereo_pick.core.rays import closest_points
from stereo_pick.core.rig import StereoRig
from stereo_pick.core.transform import Transform

ANGLES = st.floats(-3.0, 3.0)
LATERAL = st.floats(-0.3, 0.3)
DEPTHS = st.floats(0.3, 3.0)
POINTS = st.tuples(LATERAL, LATERAL, DEPTHS).map(np.array)


@given(POINTS, st.floats(300, 2000))
def test_a_pinhole_is_equations_1_1_to_1_3(x: Floats, f: float) -> None:
    """The thesis's image is upside down behind the aperture, the code's upright before it: -y."""
    y = np.array([-f * x[0] / x[2], -f * x[1] / x[2]])
    np.testing.assert_allclose(y, -f / x[2] * x[:2], rtol=1e-12)
    centre_px = (311.0, 237.0)
    np.testing.assert_allclose(camera(focal_px=f, centre_px=centre_px).project(x)[0], centre_px - y, atol=1e-9)


@given(ANGLES)
def test_one_axis_is_equations_1_7_to_1_12(angle: float) -> None:
    c, s = np.cos(angle), np.sin(angle)
    Z = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    X = np.array([[1, 0, 0], [0, c, -s], [0, s, c]])
    Y = np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]])
    for axis, printed in zip(np.eye(3), (X, Y, Z)):
        np.testing.assert_allclose(rotation_matrix(axis * angle), printed, atol=1e-12)


@given(st.tuples(ANGLES, ANGLES, ANGLES), POINTS, POINTS)
def test_a_displacement_is_equations_1_4_to_1_17(vector: tuple[float, ...], T: Floats, point: Floats) -> None:
    R = rotation_matrix(np.array(vector))
    rotated, translated = np.eye(4), np.eye(4)
    rotated[:3, :3], translated[:3, 3] = R, T
    both = np.block([[R, T[:, None]], [np.zeros((1, 3)), np.ones((1, 1))]])
    np.testing.assert_allclose(translated @ rotated, both, atol=1e-12)
    for printed, ours in ((rotated, Transform(R, np.zeros(3))), (translated, Transform(np.eye(3), T)),
                          (both, Transform(R, T))):  # fmt: skip
        np.testing.assert_allclose(ours.apply(point), (printed @ np.append(point, 1.0))[:3], atol=1e-12)


@given(random_rigs(), POINTS)
def test_equation_1_43_holds_without_its_second_T(rig: StereoRig, point: Floats) -> None:
    """T is where the right camera stands, in the left one's frame."""
    R, T = rig.right_T_left.rotation, rig.right_T_left.inverse().translation
    np.testing.assert_allclose(rig.right_T_left.apply(point), R @ (point - T), atol=1e-12)


@given(POINTS)
def test_the_camera_is_equations_3_1_to_3_6(point: Floats) -> None:
    """With the thesis's own left camera, whose alpha_c is 0."""
    left, _, _ = thesis_cameras()
    kc, fc, cc, alpha_c = left.D, left.K[[0, 1], [0, 1]], left.K[:2, 2], 0.0
    x, y = x_n = point[:2] / point[2]
    r2 = x**2 + y**2
    d_x = np.array([2 * kc[2] * x * y + kc[3] * (r2 + 2 * x**2), kc[2] * (r2 + 2 * y**2) + 2 * kc[3] * x * y])
    x_d = (1 + kc[0] * r2 + kc[1] * r2**2 + kc[4] * r2**3) * x_n + d_x
    x_p = np.array([fc[0] * (x_d[0] + alpha_c * x_d[1]) + cc[0], fc[1] * x_d[1] + cc[1]])
    KK = np.array([[fc[0], alpha_c * fc[0], cc[0]], [0, fc[1], cc[1]], [0, 0, 1]])
    np.testing.assert_allclose(KK @ [*x_d, 1], [*x_p, 1], rtol=1e-12)
    np.testing.assert_array_equal(left.K, KK)
    np.testing.assert_allclose(left.project(point)[0], x_p, rtol=1e-9)


@given(random_rigs(), POINTS)
def test_the_projection_matrix_is_equation_3_9(rig: StereoRig, point: Floats) -> None:
    """KK and T of the rectified cameras: there R is the same for both, and T is the baseline along x."""
    rectified = rig.left.R @ point
    for side, T in ((rig.left, np.zeros(3)), (rig.right, np.array([-rig.baseline_m, 0, 0]))):
        KK = side.P[:, :3]
        PPM = KK @ np.c_[np.eye(3), T]
        np.testing.assert_allclose(side.P, PPM, atol=1e-9 * rig.focal_px)
        u, v, w = PPM @ np.append(rectified, 1.0)
        seen = side.rectified(rig.project(point)[0 if side is rig.left else 1])[0]
        np.testing.assert_allclose(seen, (u / w, v / w), atol=1e-4)


@given(random_rigs(distorted=False), POINTS)
def test_the_rays_are_equations_3_15_and_3_16(rig: StereoRig, point: Floats) -> None:
    P_R = rig.right_T_left.apply(point)
    left_px, right_px = rig.project(point)
    for side, px, P in ((rig.left, left_px, point), (rig.right, right_px, P_R)):
        ray = side.rays(side.rectified(px))[0]
        np.testing.assert_allclose(ray / ray[2], P / P[2], atol=1e-8)


@given(random_rigs(), POINTS, st.floats(-0.01, 0.01))
def test_the_right_depth_is_equation_3_21(rig: StereoRig, point: Floats, skew: float) -> None:
    """R and T from right to left, as eq. 3.14 has them; rays that need not meet."""
    left_T_right = rig.right_T_left.inverse()
    R, T = left_T_right.rotation, left_T_right.translation
    P_R = rig.right_T_left.apply(point)
    p_l, p_r = point / point[2] + (0, skew, 0), P_R / P_R[2]
    alpha = -R @ p_r
    A = np.stack([alpha, p_l], axis=1)
    Z_R = ((p_l @ p_l) * (alpha @ T) - (alpha @ p_l) * (p_l @ T)) / ((alpha @ alpha) * (p_l @ p_l) - (alpha @ p_l) ** 2)
    least_squares = np.linalg.inv(A.T @ A) @ A.T @ T
    np.testing.assert_allclose(Z_R, least_squares[0], rtol=1e-6)
    on_left, on_right = closest_points(p_l[None], p_r[None], rig.right_T_left)
    np.testing.assert_allclose(rig.right_T_left.apply(on_right)[0, 2], Z_R, rtol=1e-6)
    np.testing.assert_allclose(on_left[0, 2], least_squares[1], rtol=1e-6)


def test_the_printed_direction_of_equation_3_14_is_no_rig() -> None:
    left, right, right_T_left = thesis_cameras()
    assert StereoRig.from_extrinsics(left, right, right_T_left).baseline_m == pytest.approx(0.21034, abs=1e-5)
    with pytest.raises(CalibrationError, match="negative: the right camera stands left of the left one"):
        StereoRig.from_extrinsics(left, right, right_T_left.inverse())


@pytest.mark.parametrize(
    ("left", "right"),
    [
        ((1677, 1319), (1830, 1399)),  # table 3.6
        ((1078, 1341, 898), (1023, 1334, 948)),  # 3.9
        ((1688, 953, 1453, 2004), (1489, 906, 1433, 2068)),  # 3.11, the right ones as 3.12 has them
    ],
)
def test_the_printed_areas_pair_as_the_thesis_says(left: tuple[int, ...], right: tuple[int, ...]) -> None:
    square = np.array([(0, 0), (1, 0), (1, 1), (0, 1)])
    views = [[Blob(square * np.sqrt(area), contrast=1.0) for area in areas] for areas in (left, right)]
    assert least_area_difference(*views) == [(i, i) for i in range(len(left))]
