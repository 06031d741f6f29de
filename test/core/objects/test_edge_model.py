"""Profiles of grey levels whose edge is known."""

from __future__ import annotations

import numpy as np
import pytest

from stereo_pick.core.arrays import Floats
from stereo_pick.core.objects.edge_model import BLURS_PX, OFFSETS_PX, best_blur_px, find_edges, nearest_blur_px

FINE = np.arange(-12, 14, 0.01)
PLACES = np.linspace(-1.0, 1.0, 21)


def blurred(light: Floats, blur_px: float) -> Floats:
    """What is seen at OFFSETS_PX of light (len(FINE),)."""
    weight = np.exp(-0.5 * ((OFFSETS_PX[:, None] - FINE) / blur_px) ** 2)
    return np.asarray(weight @ light / weight.sum(axis=1))


def step(place_px: float, blur_px: float, inside: float = 180.0, outside: float = 50.0) -> Floats:
    return blurred(np.where(place_px < FINE, inside, outside), blur_px)


def limb(place_px: float, blur_px: float, radius_px: float = 25.0) -> Floats:
    """A ball's: half of its light is the room's, half grows with the square root of the depth behind the limb."""
    depth = np.clip(FINE - place_px, 0, radius_px) / radius_px
    lit = 75 * np.sqrt(depth * (2 - depth))
    return blurred(np.where(place_px < FINE, 120 + lit, 50.0), blur_px)


@pytest.mark.parametrize("blur_px", [0.6, 0.9, 1.4])
@pytest.mark.parametrize("inside", [180.0, 10.0])
def test_a_step_is_found_where_it_is(blur_px: float, inside: float) -> None:
    found = find_edges(np.array([step(place, blur_px, inside) for place in PLACES]), blur_px)
    np.testing.assert_allclose(found.place_px, PLACES, atol=0.02)
    np.testing.assert_allclose(found.step, inside - 50, rtol=0.1)
    np.testing.assert_allclose(found.sharpness, np.sign(inside - 50), atol=0.15)


@pytest.mark.parametrize("blur_px", [0.6, 0.9, 1.4])
def test_a_limb_is_found_where_it_is_and_not_half_way_up(blur_px: float) -> None:
    profiles = np.array([limb(place, blur_px) for place in PLACES])
    found = find_edges(profiles, blur_px)
    assert np.abs(found.place_px - PLACES).max() < 0.12
    half = (profiles[:, :1] + profiles[:, -1:]) / 2
    half_way = np.array([np.interp(level, row, OFFSETS_PX) for level, row in zip(half[:, 0], profiles)])
    assert np.abs(half_way - PLACES).mean() > 2 * np.abs(found.place_px - PLACES).mean()
    assert (found.sharpness > 0.4).all() and (found.sharpness < 0.95).all()


def in_shade(place_px: float, blur_px: float, width_px: float) -> Floats:
    """A black part on white paper that it darkens, most so at its foot."""
    before = np.clip(place_px - FINE, 0, width_px) / width_px
    return blurred(np.where(place_px < FINE, 20.0, 90 + 110 * np.sqrt(before)), blur_px)


@pytest.mark.parametrize("blur_px", [0.6, 0.9, 1.4])
@pytest.mark.parametrize("width_px", [8.0, 12.0, 25.0])
def test_a_dark_part_ends_where_its_shadow_begins(blur_px: float, width_px: float) -> None:
    found = find_edges(np.array([in_shade(place, blur_px, width_px) for place in PLACES]), blur_px)
    assert np.abs(found.place_px - PLACES).max() < 0.15
    assert (found.step < 0).all() and (found.sharpness < -0.3).all()


@pytest.mark.parametrize("blur_px", [0.6, 0.9, 1.4])
def test_shade_tells_the_blur_as_well(blur_px: float) -> None:
    found = best_blur_px(np.array([in_shade(place, blur_px, 10.0) for place in PLACES]))
    assert abs(np.log(found / blur_px)) < 2 * np.log(BLURS_PX[1] / BLURS_PX[0])


def test_light_that_only_fades_is_not_sharp() -> None:
    ramps = np.array([np.clip((OFFSETS_PX - start) / width, 0, 1) * 60 + 50 for start in (-3, -1) for width in (7, 15)])
    assert (np.abs(find_edges(ramps, 0.8).sharpness) < 0.25).all()


def test_noise_alone_is_not_sharp() -> None:
    noise = np.random.default_rng(0).normal(90, 3, (500, len(OFFSETS_PX)))
    sharpness = np.abs(find_edges(noise, 0.8).sharpness)
    assert np.median(sharpness) < 0.3 and (sharpness > 0.6).mean() < 0.02


@pytest.mark.parametrize("blur_px", [0.6, 0.9, 1.4])
@pytest.mark.parametrize("shape", [step, limb])
def test_profiles_tell_their_own_blur(blur_px: float, shape: object) -> None:
    make = step if shape is step else limb
    found = best_blur_px(np.array([make(place, blur_px) for place in PLACES]))
    grid = np.array(BLURS_PX)
    assert abs(np.log(found / blur_px)) < 1.6 * np.log(grid[1] / grid[0])


@pytest.mark.parametrize(("blur_px", "index"), [(0.0, 0), (0.3, 0), (BLURS_PX[5] * 1.01, 5), (40.0, -1)])
def test_any_blur_has_a_nearest_one(blur_px: float, index: int) -> None:
    """That of an outline on even ground is zero."""
    assert nearest_blur_px(blur_px) == BLURS_PX[index]
