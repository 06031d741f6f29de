"""The model of the empty work surface."""

from __future__ import annotations

import numpy as np
import pytest
from rigs import SIZE_PX

from stereo_pick.core.arrays import Floats
from stereo_pick.core.objects.background import fit_background

EVERYWHERE = np.ones(SIZE_PX[::-1], bool)


def surface() -> Floats:
    u, v = np.meshgrid(np.linspace(-0.5, 0.5, SIZE_PX[0]), np.linspace(-0.5, 0.5, SIZE_PX[1]))
    return np.asarray(100 + 30 * u - 20 * v - 40 * u * u + 10 * u * v - 25 * v * v)


def noisy(sigma: float, seed: int = 0) -> Floats:
    return surface() + np.random.default_rng(seed).normal(0, sigma, SIZE_PX[::-1])


@pytest.mark.parametrize("sigma", [1.0, 2.5, 6.0])
def test_a_quadratic_fall_off_and_its_noise_are_found(sigma: float) -> None:
    background = fit_background(noisy(sigma).astype(np.float32), EVERYWHERE)
    np.testing.assert_allclose(background.level, surface(), atol=0.35 * sigma)
    assert background.sigma == pytest.approx(sigma, rel=0.06)


@pytest.mark.parametrize("contrast", [-80.0, 15.0, 100.0])
def test_parts_over_a_third_of_the_view_do_not_bend_it(contrast: float) -> None:
    image = noisy(1.0)
    image[100:400, 100:440] += contrast
    background = fit_background(image.astype(np.float32), EVERYWHERE)
    np.testing.assert_allclose(background.level, surface(), atol=0.5)


@pytest.mark.parametrize("ends_at", [0.45, 0.5, 0.55])
@pytest.mark.parametrize("seed", range(3))
def test_where_the_table_ends_half_way_it_or_the_floor_is_found(seed: int, ends_at: float) -> None:
    table, image = noisy(1.0, seed), noisy(1.0, seed) - 70
    end = int(ends_at * SIZE_PX[0])
    image[:, end:] = table[:, end:]
    image[100:250, 30:130] += 120.0
    image[100:250, 450:600] += 60.0
    background = fit_background(image.astype(np.float32), EVERYWHERE)
    assert background.sigma < 1.5
    off = min((image - background.level)[300:, part].std() for part in (np.s_[:end], np.s_[end:]))
    assert off < 1.5


def test_what_lies_outside_the_raw_image_does_not_count() -> None:
    image, inside = noisy(1.0), EVERYWHERE.copy()
    inside[:, 420:] = False
    image[~inside] = 0.0
    level = fit_background(image.astype(np.float32), inside).level
    np.testing.assert_allclose(level[:, :420], surface()[:, :420], atol=1.0)


def test_the_spread_of_a_perfect_image_is_that_of_rounding() -> None:
    assert 0.2 <= fit_background(np.full(SIZE_PX[::-1], 70.0, np.float32), EVERYWHERE).sigma <= 1.0


@pytest.mark.parametrize("window", [np.s_[80:81, :], np.s_[120:121, 100:600], np.s_[80:86, :]])
def test_what_shows_a_single_line_of_it_says_no_more_of_it(window: tuple[slice, slice]) -> None:
    """Many of the few samples there are in a line: no surface goes through them alone."""
    line = np.zeros_like(EVERYWHERE)
    line[window] = True
    level = fit_background(noisy(1.0).astype(np.float32), line).level
    np.testing.assert_allclose(level[window], surface()[window], atol=2.0)
