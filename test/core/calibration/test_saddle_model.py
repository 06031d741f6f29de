"""Corners by a model of crossing edges: where they are in blurred, noisy, unevenly lit pictures; never far off."""

from __future__ import annotations

import cv2
import numpy as np
import pytest

from stereo_pick.core.calibration.saddle_model import fitted_corners

SHAPE = (150, 190)
TILT = np.array([[26.0, 4.0], [-3.0, 24.0]])  # [px] along a row, down a column


def grid_px(shift: tuple[float, float]) -> np.ndarray:
    return np.mgrid[0:5, 0:4].T @ TILT + [38, 20] + shift


def picture(shift: tuple[float, float], noise: float, seed: int = 0) -> np.ndarray:
    """A board with those corners, drawn 8 times as fine, blurred by about a pixel, brighter to the right."""
    fine = 8
    v, u = ((np.arange(n * fine) + 0.5) / fine - 0.5 for n in SHAPE)
    on_board = (np.stack(np.meshgrid(u, v), axis=-1) - [38, 20] - shift) @ np.linalg.inv(TILT)
    white = np.floor(on_board).sum(axis=-1) % 2
    sharp = cv2.resize(np.where(white > 0, 190.0, 50.0), SHAPE[::-1], interpolation=cv2.INTER_AREA)
    lit = cv2.GaussianBlur(sharp, (0, 0), 0.8) + 0.1 * np.arange(SHAPE[1])
    return np.clip(np.round(lit + np.random.default_rng(seed).normal(0, noise, SHAPE)), 0, 255).astype(np.uint8)


@pytest.mark.parametrize("shift", [(0.0, 0.0), (0.3, -0.4), (0.5, 0.5)])
def test_corners_are_where_the_edges_cross(shift: tuple[float, float]) -> None:
    truth = grid_px(shift)
    found = fitted_corners(picture(shift, noise=0), truth + [0.3, -0.3])
    np.testing.assert_allclose(found, truth, atol=0.02)


def test_noise_is_less_than_half_of_the_gradient_method_on_the_same_window() -> None:
    errors_px = np.zeros((2, 10, 20, 2))
    criteria = (cv2.TERM_CRITERIA_COUNT + cv2.TERM_CRITERIA_EPS, 100, 1e-4)
    for seed in range(10):
        seen, truth = picture((0.2, 0.1), noise=4, seed=seed), grid_px((0.2, 0.1))
        errors_px[0, seed] = (fitted_corners(seen, truth) - truth).reshape(-1, 2)
        start = truth.reshape(-1, 1, 2).astype(np.float32)
        errors_px[1, seed] = cv2.cornerSubPix(seen, start, (7, 7), (-1, -1), criteria)[:, 0] - truth.reshape(-1, 2)
    model, gradient = np.sqrt(np.mean(errors_px**2, axis=(1, 2, 3)))
    assert model < gradient / 2


def test_corner_that_is_none_or_has_no_room_stays_where_it_was_found() -> None:
    grid = grid_px((0, 0))
    flat = np.full(SHAPE, 120, np.uint8)
    found = fitted_corners(flat, grid)
    assert np.linalg.norm(found - grid, axis=-1).max() <= 1.0
    outside = grid - [36, 18]
    moved = fitted_corners(picture((-36, -18), noise=0), outside)
    np.testing.assert_array_equal(moved[0, 0], outside[0, 0])
