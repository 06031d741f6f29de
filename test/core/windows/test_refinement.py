"""Windows placed to a part of a pixel, on textures that are known everywhere."""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache

import numpy as np
import pytest
from outlines import pattern

from stereo_pick.core.arrays import Floats
from stereo_pick.core.windows.refinement import WindowFits, refine
from stereo_pick.core.windows.window import COSTS, Grey

SHAPE = (360, 640)
SHIFTS = np.linspace(20, 21, 11)
Texture = Callable[[Floats, Floats], Floats]

both_costs = pytest.mark.parametrize("cost", COSTS)


def dots(seed: int = 4, radius_px: float = 1.6, share: float = 0.12) -> Texture:
    """Bright round dots at random places, soft as a lens leaves them."""
    rng = np.random.default_rng(seed)
    fine = 0.25
    grid = rng.uniform(size=(int(SHAPE[0] / fine / 4) + 60, int(SHAPE[1] / fine / 4) + 200)) < share

    def grey(u: Floats, v: Floats) -> Floats:
        light = np.zeros(np.broadcast(u, v).shape)
        column, row = np.floor(u).astype(int), np.floor(v).astype(int)
        near = range(-4, 5)
        across, down = (
            [np.exp(-(((at - whole) - by) ** 2) / radius_px**2) for by in near] for at, whole in ((u, column), (v, row))
        )
        for dv, by_row in zip(near, down):
            y = np.clip(row + dv + 8, 0, grid.shape[0] - 1)
            for du, by_column in zip(near, across):
                light += grid[y, np.clip(column + du + 8, 0, grid.shape[1] - 1)] * (by_row * by_column)
        return 60 + 70 * light

    return grey


TEXTURES = {"waves": pattern(), "dots": dots()}


def views(texture: Texture, shift: Callable[[Floats, Floats], Floats], noise_dn: float = 1.0) -> tuple[Grey, Grey]:
    """What the left view shows at (u, v) the right one shows at u - shift(u, v)."""
    v, u = np.indices(SHAPE, np.float64)
    rng = np.random.default_rng(2)
    source = u
    for _ in range(60):
        source = u + shift(source, v)
    images = [np.clip(np.round(texture(x, v) + rng.normal(0, noise_dn, SHAPE)), 0, 255) for x in (u, source)]
    return images[0].astype(np.float32), images[1].astype(np.float32)


@lru_cache(maxsize=8)
def shifted(name: str, shift_px: float, noise_dn: float = 1.0) -> tuple[Grey, Grey]:
    """Views of a texture whose shift is the same everywhere; both costs are tried on them."""
    return views(TEXTURES[name], lambda u, v: np.full_like(u, shift_px), noise_dn)


def points(step_px: int = 40) -> Floats:
    v, u = np.meshgrid(np.arange(40.0, 330, step_px), np.arange(90.0, 600, step_px))
    return np.stack([u.ravel(), v.ravel()], axis=1)


def fitted(pair: tuple[Grey, Grey], at: Floats, start_px: float, window_px: int = 15, cost: str = "zncc") -> WindowFits:
    return refine(pair, at, at[:, 0] - start_px, window_px, cost)


@both_costs
@pytest.mark.parametrize("shift_px", SHIFTS)
def test_a_known_sub_pixel_shift_is_found_from_between_pixels_too(cost: str, shift_px: float) -> None:
    pair = shifted("waves", shift_px)
    at = np.array([(200.0, 100.0), (333.3, 240.7), (500.5, 300.5)])
    np.testing.assert_allclose(fitted(pair, at, 20.5, cost=cost).column_px, at[:, 0] - shift_px, atol=0.06)


@both_costs
@pytest.mark.parametrize("texture", TEXTURES)
def test_the_shift_does_not_lock_to_whole_pixels(cost: str, texture: str) -> None:
    """A parabola through three SSD values pulls every match towards the nearest whole pixel."""
    errors, at = [], points()
    for shift_px in SHIFTS[::2]:
        pair = shifted(texture, shift_px)
        fit = fitted(pair, at, round(float(shift_px)), cost=cost)
        good = fit.sigma_px < 0.15
        assert good.mean() > 0.8
        errors.append(np.mean((fit.column_px - at[:, 0] + shift_px)[good]))
    assert np.abs(errors).max() < 0.02


@both_costs
@pytest.mark.parametrize("slant", [(0.2, 0.0), (-0.2, 0.0), (0.0, 0.3), (0.15, -0.25)], ids=str)
def test_a_slanted_face_is_found_without_bias(cost: str, slant: tuple[float, float]) -> None:
    along, across = slant

    def shift(u: Floats, v: Floats) -> Floats:
        return 60 + along * (u - 320) + across * (v - 180)

    at = points()
    pair = views(pattern(), shift)
    start_px = np.round(shift(*at.T))
    fit = refine(pair, at, at[:, 0] - start_px, 11, cost)
    inside = (fit.column_px > 20) & (fit.column_px < 620)
    error = (fit.column_px - at[:, 0] + shift(*at.T))[inside]
    assert np.abs(np.median(error)) < 0.02 and np.abs(error).max() < 0.3
    assert np.median(fit.similarity[inside]) > 0.97


@both_costs
@pytest.mark.parametrize("noise_dn", [2.0, 6.0])
def test_the_stated_sigma_is_that_of_the_noise(cost: str, noise_dn: float) -> None:
    pair = shifted("waves", 20.4, noise_dn)
    at = points(20)
    fit = fitted(pair, at, 20, cost=cost)
    squared = ((fit.column_px - at[:, 0] + 20.4) / fit.sigma_px) ** 2
    assert 0.7 < np.sqrt(np.mean(squared)) < 1.4


def test_gain_and_offset_move_zncc_nowhere() -> None:
    left, right = views(pattern(), lambda u, v: np.full_like(u, 20.3))
    at = points()
    fit = fitted((left, np.round(0.7 * right + 25)), at, 20)
    assert np.abs(np.mean(fit.column_px - at[:, 0] + 20.3)) < 0.02 and fit.sigma_px.max() < 0.15


@both_costs
def test_a_window_without_texture_has_no_certain_place(cost: str) -> None:
    rng = np.random.default_rng(0)
    even = tuple((90 + rng.normal(0, 1, SHAPE)).astype(np.float32) for _ in range(2))
    for window_px in (7, 15, 23):
        fit = fitted(even, points(), 20, window_px, cost)
        assert np.mean(fit.sigma_px > 0.15) > 0.95
        assert not ((fit.sigma_px < 0.15) & (fit.similarity > 0.5)).any()


def test_an_even_slope_of_grey_levels_is_no_texture_for_zncc() -> None:
    """Offset and shift cannot be told apart there."""
    u = np.indices(SHAPE)[1] * 0.3
    rng = np.random.default_rng(0)
    ramp = tuple((u + rng.normal(0, 1, SHAPE)).astype(np.float32) for _ in range(2))
    assert np.mean(fitted(ramp, points(), 0).sigma_px > 0.15) > 0.95


def test_another_texture_explains_nothing() -> None:
    left, _ = views(pattern(), lambda u, v: np.full_like(u, 20.0))
    other, _ = views(pattern(seed=9), lambda u, v: np.full_like(u, 20.0))
    assert np.median(fitted((left, other), points(), 20).similarity) < 0.5
