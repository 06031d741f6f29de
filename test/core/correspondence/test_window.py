"""Windows compared to a part of a pixel."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from outlines import pattern

from stereo_pick.core.arrays import Floats
from stereo_pick.core.correspondence.window import Grey, refine, ssd_along_row, window_at

U, V = np.meshgrid(np.arange(640.0), np.arange(360.0))
SHIFTS = np.linspace(20, 21, 11)


@cache
def textured(shift_px: float) -> Floats:
    return pattern()(U + shift_px, V)


def views(shift_px: float, noise_dn: float = 1.0) -> tuple[Grey, Grey]:
    """A textured plane in two views; what the left one shows at u the right one shows at u - shift."""
    rng = np.random.default_rng(2)
    left, right = (np.round(textured(s) + rng.normal(0, noise_dn, U.shape)) for s in (0.0, shift_px))
    return left.astype(np.float32), right.astype(np.float32)


@pytest.mark.parametrize("shift_px", SHIFTS)
def test_a_known_sub_pixel_shift_is_found(shift_px: float) -> None:
    left, right = views(float(shift_px))
    for here in ((200.0, 100.0), (333.3, 240.7), (500.5, 300.5)):
        fit = refine(left, right, np.array(here), np.round(here[0] - 20.5), 15)
        assert fit.column_px == pytest.approx(here[0] - shift_px, abs=0.05)


def test_the_shift_does_not_lock_to_whole_pixels() -> None:
    """A parabola through three SSD values pulls every match towards the nearest whole pixel."""
    errors = []
    for shift_px in SHIFTS:
        left, right = views(float(shift_px))
        at = [np.array([u, v]) for u in range(100, 560, 60) for v in range(60, 320, 60)]
        errors.append(np.mean([refine(left, right, p, p[0] - 20, 15).column_px - p[0] + shift_px for p in at]))
    assert np.abs(errors).max() < 0.02


def test_the_stated_sigma_is_that_of_the_noise() -> None:
    left, right = views(20.4, noise_dn=4.0)
    at = [np.array([u, v]) for u in range(60, 600, 20) for v in range(30, 340, 20)]
    fits = [refine(left, right, p, p[0] - 20, 15) for p in at]
    scatter = np.std([fit.column_px - p[0] + 20.4 for fit, p in zip(fits, at)])
    assert np.sqrt(np.mean([fit.sigma_px**2 for fit in fits])) == pytest.approx(scatter, rel=0.35)


def test_the_same_window_explains_all_and_another_one_nothing() -> None:
    left, right = views(20.0, noise_dn=0.0)
    other = np.round(pattern(seed=9)(U, V)).astype(np.float32)
    here = np.array([300.0, 200.0])
    assert refine(left, right, here, 280.0, 15).similarity > 0.99
    assert refine(left, other, here, 280.0, 15).similarity < 0.5


def test_a_window_without_texture_has_no_certain_place() -> None:
    even = 90 + np.random.default_rng(0).normal(0, 1, U.shape)
    fit = refine(even.astype(np.float32), even[:, ::-1].astype(np.float32), np.array([300.0, 200.0]), 280.0, 15)
    assert fit.sigma_px > 0.15


@pytest.mark.parametrize("window_px", [3, 9, 15])
def test_the_ssd_is_equation_3_8(window_px: int) -> None:
    left, right = views(20.0)
    here, half = np.array([300.0, 200.0]), window_px // 2
    cost = ssd_along_row(left, right, here, window_px)
    assert cost.shape == (640,) and int(cost[half:-half].argmin()) + half == 280
    one = left[200 - half : 201 + half, 300 - half : 301 + half]
    for column in (half, 100, 280, 639 - half):
        other = right[200 - half : 201 + half, column - half : column + half + 1]
        expected = float(((one.astype(np.float64) - other) ** 2).sum())
        assert cost[column] == pytest.approx(expected, rel=1e-3, abs=2.0)


def test_a_window_between_pixels_is_bilinear() -> None:
    image = np.arange(400, dtype=np.float32).reshape(20, 20)
    assert window_at(image, np.array([5.25, 7.5]), 1)[0, 0] == pytest.approx(7.5 * 20 + 5.25)
    assert window_at(image, np.array([8.0, 9.0]), 5, 3).shape == (3, 5)
