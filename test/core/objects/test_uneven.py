"""The model of an empty work surface in which a lamp mirrors, or that one stands close to."""

from __future__ import annotations

import numpy as np
import pytest
from outlines import PARALLEL
from rigs import SIZE_PX

from stereo_pick.core.arrays import Bools, Floats
from stereo_pick.core.frames import RectifiedPair
from stereo_pick.core.objects import Detector
from stereo_pick.core.objects.background import fit_background
from stereo_pick.core.objects.uneven import UnevenBackground, fit_uneven

EVERYWHERE = np.ones(SIZE_PX[::-1], bool)
PARTS = (np.s_[300:360, 120:190], np.s_[90:150, 470:540], np.s_[340:400, 400:450])
PARTS_GREY = 25.0


def lamp(brightness: float = 190.0, at: tuple[float, float] = (330.0, 120.0), reach_px: float = 130.0) -> Floats:
    """A grey table in which a lamp mirrors, as far as a lacquer scatters it."""
    x, y = np.meshgrid(np.arange(SIZE_PX[0]), np.arange(SIZE_PX[1]))
    off2 = ((x - at[0]) ** 2 + (y - at[1]) ** 2) / reach_px**2
    return np.asarray(50 + 0.03 * x + brightness * np.exp(-off2 / 2))


def seen(surface: Floats, noise: float = 1.0, seed: int = 0) -> Floats:
    """The surface with parts on it, as a camera sees them."""
    image = surface + np.random.default_rng(seed).normal(0, noise, surface.shape)
    for i, part in enumerate(PARTS):
        image[part] += PARTS_GREY * (-1) ** i
    return np.clip(image, 0, 255)


def fitted(image: Floats, valid: Bools = EVERYWHERE) -> UnevenBackground | None:
    grey = image.astype(np.float32)
    return fit_uneven(grey, valid, fit_background(grey, valid))


@pytest.mark.parametrize("at", [(330.0, 120.0), (200.0, 240.0), (320.0, -60.0)])
@pytest.mark.parametrize("reach_px", [130.0, 170.0])
def test_a_lamp_that_mirrors_in_the_table_is_followed_and_parts_are_not(
    at: tuple[float, float], reach_px: float
) -> None:
    surface = lamp(at=at, reach_px=reach_px)
    found = fitted(seen(surface))
    assert found is not None and found.sigma < 2
    off = np.abs(found.at(np.s_[:, :]) - surface)
    assert np.percentile(off, 90) < 3
    assert max(float(np.median(off[part])) for part in PARTS) < PARTS_GREY / 10


def test_where_it_is_clipped_nothing_is_brighter() -> None:
    surface = lamp(brightness=400.0)
    found = fitted(seen(surface))
    assert found is not None and found.at(np.s_[:, :]).max() <= 255
    dim = surface < 200
    assert np.percentile(np.abs(found.at(np.s_[:, :]) - surface)[dim], 90) < 3


def test_it_is_raised_and_cut_out_as_any_background() -> None:
    found = fitted(seen(lamp()))
    assert found is not None
    window = np.s_[40:60, 100:130]
    np.testing.assert_array_equal(found.at(window, 7.5), found.at(np.s_[:, :])[window] + np.float32(7.5))


def test_what_an_even_surface_explains_needs_no_other() -> None:
    assert fitted(seen(lamp(brightness=0.0))) is None


def test_grain_is_no_light() -> None:
    draw = np.random.default_rng(1)
    grain = np.kron(draw.normal(0, 25, (SIZE_PX[1] // 4, SIZE_PX[0] // 4)), np.ones((4, 4)))
    assert fitted(np.clip(120 + grain, 0, 255)) is None


def test_a_view_that_is_mostly_clipped_says_nothing() -> None:
    assert fitted(seen(lamp(brightness=2000.0, reach_px=250.0))) is None


def test_parts_beside_a_glaring_lamp_are_outlined() -> None:
    """An even background leaves so much of the lamp that nothing darker than it stands out."""
    image = np.round(seen(lamp())).astype(np.uint8)
    left = Detector(polarity="dark").detect(RectifiedPair(image, image, PARALLEL)).left
    sizes = [float(np.ptp(blob.contour_px[:, 0])) for blob in left if not blob.fault]
    assert sizes == [pytest.approx(70, abs=2)]
