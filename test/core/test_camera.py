"""One camera: raw pixels, rays and rectified pixels, there and back."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from rigs import RIGS, camera, rotation

from stereo_pick.core.camera import Camera
from stereo_pick.core.errors import CalibrationError

LENSES = {
    "none": camera(),
    "plumb_bob": camera(D=(-0.26, 0.12, 0.002, -0.001, 0.01)),
    "plumb_bob without k3": camera(D=(-0.26, 0.12, 0.002, -0.001)),
    "the thesis's": RIGS["thesis"].left,
    "rational": camera(D=(0.9, 0.3, 0.001, -0.001, 0.02, 1.2, 0.5, 0.05), model="rational_polynomial"),
    "thin prism": camera(
        D=(0.3, 0.1, 0.001, 0.001, 0.02, 0.5, 0.1, 0.01, 1e-3, 1e-3, -1e-3, 1e-3), model="rational_polynomial"
    ),
    "equidistant": camera(focal_px=420.0, D=(0.05, -0.01, 0.002, -0.001), model="equidistant"),
}
TURNED = {
    name: replace(lens, R=rotation((0.05, -0.2, 0.1)), P=np.array([[700.0, 0, 250, 0], [0, 710, 260, 0], [0, 0, 1, 0]]))
    for name, lens in LENSES.items()
}


def grid(lens: Camera) -> np.ndarray:
    u, v = np.meshgrid(np.linspace(0, lens.width_px - 1, 17), np.linspace(0, lens.height_px - 1, 13))
    return np.c_[u.ravel(), v.ravel()]


@pytest.mark.parametrize("name", LENSES)
def test_every_pixel_comes_back_from_its_ray(name: str) -> None:
    lens, pixels = LENSES[name], grid(LENSES[name])
    rays = np.c_[lens.normalized(pixels), np.ones(len(pixels))]
    np.testing.assert_allclose(lens.project(2.5 * rays), pixels, atol=1e-4)


@pytest.mark.parametrize("name", TURNED)
def test_every_pixel_comes_back_from_the_rectified_view(name: str) -> None:
    lens, pixels = TURNED[name], grid(TURNED[name])
    np.testing.assert_allclose(lens.unrectified(lens.rectified(pixels)), pixels, atol=1e-4)


@pytest.mark.parametrize("name", TURNED)
def test_a_point_is_rectified_as_R_and_P_say(name: str) -> None:
    lens = TURNED[name]
    points = np.random.default_rng(3).uniform((-0.2, -0.15, 0.8), (0.2, 0.15, 1.2), (20, 3))
    homogeneous = np.c_[points @ lens.R.T, np.ones(20)] @ lens.P.T
    np.testing.assert_allclose(lens.rectified(lens.project(points)), homogeneous[:, :2] / homogeneous[:, 2:], atol=1e-4)


@pytest.mark.parametrize("name", TURNED)
def test_the_ray_of_a_rectified_pixel_passes_through_the_point(name: str) -> None:
    lens = TURNED[name]
    points = np.random.default_rng(4).uniform((-0.2, -0.15, 0.8), (0.2, 0.15, 1.2), (20, 3))
    rays = lens.rays(lens.rectified(lens.project(points)))
    assert np.abs(np.cross(rays, points)).max() < 1e-6


@given(st.floats(-0.4, 0.4), st.floats(-0.3, 0.3))
def test_plumb_bob_is_the_thesiss_equations_3_2_and_3_3(x: float, y: float) -> None:
    k1, k2, p1, p2, k3 = LENSES["plumb_bob"].D
    r2 = x * x + y * y
    radial = 1 + k1 * r2 + k2 * r2**2 + k3 * r2**3
    tangential = np.array([2 * p1 * x * y + p2 * (r2 + 2 * x * x), p1 * (r2 + 2 * y * y) + 2 * p2 * x * y])
    expected = 900 * (radial * np.array([x, y]) + tangential) + (319.5, 239.5)
    np.testing.assert_allclose(LENSES["plumb_bob"].project([(x, y, 1.0)])[0], expected, atol=1e-6)


def test_equidistant_without_coefficients_is_proportional_to_the_angle() -> None:
    lens = camera(focal_px=400.0, D=(0.0,) * 4, model="equidistant")
    angle = np.linspace(0.05, 1.2, 8)
    pixels = lens.project(np.stack([np.sin(angle), np.zeros(8), np.cos(angle)], axis=1))
    np.testing.assert_allclose(pixels[:, 0] - 319.5, 400 * angle, atol=1e-6)


def test_no_points_give_no_points() -> None:
    lens, none = LENSES["plumb_bob"], np.zeros((0, 2))
    assert lens.normalized(none).shape == lens.rectified(none).shape == lens.unrectified(none).shape == (0, 2)
    assert lens.project(np.zeros((0, 3))).shape == (0, 2)


def test_a_camera_info_without_coefficients_has_no_distortion() -> None:
    np.testing.assert_array_equal(camera(D=()).D, np.zeros(5))


@pytest.mark.parametrize(
    ("wrong", "complaint"),
    [
        ({"width_px": 0}, "image size 0 x 480"),
        ({"width_px": 1000000}, "image size 1000000 x 480 .* in pixels"),
        ({"height_px": 1000000, "K": np.diag([1e6, 1e6, 1.0])}, "image size 640 x 1000000 .* in pixels"),
        ({"K": np.zeros((3, 3))}, r"K\[0,0\] = 0"),
        ({"P": np.zeros((3, 4))}, r"P\[0,0\] = 0"),
        ({"K": np.diag([4.5, 4.5, 1.0])}, r"K\[0,0\] = 4.5 px is no lens's for an image of 640 x 480.* millimetres"),
        ({"K": np.diag([1e7, 1e7, 1.0])}, r"K\[0,0\] = 1e\+07 px is no lens's"),
        ({"K": np.diag([0.0045, 0.0045, 1.0])}, r"K\[0,0\] = 0.0045 px is no lens's"),
        ({"K": np.full((3, 3), np.nan)}, "K holds nan"),
        (
            {"K": camera().K.T},
            "K = .* is not of the form fx, 0, cx, 0, fy, cy, 0, 0, 1: transpose it if it is Matlab's",
        ),
        ({"K": camera().K + [[0, 2, 0], [0, 0, 0], [0, 0, 0]]}, "K = .* is not of the form .* without skew"),
        ({"K": 2 * camera().K}, "K = .*, 2 is not of the form"),
        ({"K": np.eye(2)}, r"K has shape \(2, 2\)"),
        ({"D": np.array([0.1, np.inf, 0, 0, 0])}, "D holds inf"),
        ({"D": np.zeros(3)}, "3 distortion coefficients do not fit 'plumb_bob'"),
        ({"D": np.zeros(5), "distortion_model": "equidistant"}, "5 distortion coefficients"),
        ({"distortion_model": "fov"}, "unknown distortion model 'fov'; known are plumb_bob"),
        ({"R": np.zeros((3, 3))}, r"R is not a rotation.*R R' - I.* = 1, must be at most 0.001; det = 0, must be 1"),
        ({"R": 1.01 * np.eye(3)}, r"R is not a rotation.*R R' - I.* = 0\.0201, .*det = 1.03,"),
        ({"R": np.diag([1.0, 1.0, -1.0])}, r"R is not a rotation.*R R' - I.* = 0, .*det = -1,"),
    ],
    ids=lambda value: value if isinstance(value, str) else "",
)
def test_what_no_real_camera_has_is_refused_by_name(wrong: dict[str, Any], complaint: str) -> None:
    with pytest.raises(CalibrationError, match=f"left camera: .*{complaint}"):
        replace(camera(), **wrong)
