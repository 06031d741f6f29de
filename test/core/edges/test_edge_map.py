"""What noise, and light that is more than white, leave of edges."""

from __future__ import annotations

from dataclasses import replace

import cv2
import numpy as np
import pytest
from rendered_solids import RIG

from stereo_pick.core.arrays import Floats, Image
from stereo_pick.core.edges.edge_map import USUAL_BLUR_PX, EdgeMap
from stereo_pick.core.edges.locking import trust
from stereo_pick.core.objects.edge_model import OFFSETS_PX, Edges
from stereo_pick.core.sampling import sampled

SIZE = 400, 400
EDGE_PX = 200.3
NOISE_DN = 8.0


def step_of(height_dn: float, noise_dn: float) -> Image:
    across = np.arange(SIZE[1], dtype=np.float64)
    sharp = np.clip(across - EDGE_PX + 0.5, 0, 1) * height_dn + 100
    view = cv2.GaussianBlur(np.tile(sharp, (SIZE[0], 1)), (0, 0), USUAL_BLUR_PX)
    return grey(view + np.random.default_rng(0).normal(0, noise_dn, SIZE))


def grey(levels: Floats) -> Image:
    return np.clip(np.round(levels), 0, 255).astype(np.uint8)


def edges_in(view: EdgeMap) -> Edges:
    rows = np.arange(20.0, SIZE[0] - 20)
    places = np.stack(np.broadcast_arrays(EDGE_PX + OFFSETS_PX, rows[:, None]), axis=-1)
    return view.edges(sampled(view.image, places))


def trusted(view: EdgeMap) -> float:
    """The part of the edge's points that are trusted."""
    return float((trust(edges_in(view), view.noise) > 0).mean())


def as_it_is(image: Image) -> EdgeMap:
    """Without what is done against noise; how steep that is, as a part of its sigma, is the same for every noise."""
    quiet = EdgeMap.of(step_of(0.0, 1.0), RIG.left)
    return EdgeMap(image, quiet.noise * NOISE_DN, RIG.left, USUAL_BLUR_PX)


@pytest.mark.parametrize("height", [1.5, 2.5])
def test_more_is_seen_of_an_edge_as_weak_as_noise_than_there_would_be(height: float) -> None:
    image, nothing = step_of(height * NOISE_DN, NOISE_DN), step_of(0.0, NOISE_DN)
    gained = trusted(EdgeMap.of(image, RIG.left)) - trusted(as_it_is(image))
    assert gained > 0.05 > trusted(EdgeMap.of(nothing, RIG.left)) - trusted(as_it_is(nothing))


def test_in_noise_and_there_alone_neighbours_on_each_line_are_looked_at_together() -> None:
    quiet, noisy = (EdgeMap.of(step_of(0.0, noise), RIG.left) for noise in (1.0, NOISE_DN))
    noise = np.random.default_rng(0).normal(0, NOISE_DN, (2, 500, len(OFFSETS_PX)))
    profiles = (noise + np.array([50.0, 150.0])[:, None, None]).reshape(-1, len(OFFSETS_PX))
    assert quiet.together(profiles, 500) is profiles and quiet.noise_together == quiet.noise
    left = noisy.together(profiles, 500).reshape(noise.shape)
    assert left.std(axis=1).mean() / NOISE_DN == pytest.approx(noisy.noise_together / noisy.noise, rel=0.05)
    assert left.mean(axis=(1, 2)) == pytest.approx([50.0, 150.0], abs=0.5)


@pytest.mark.parametrize("noise_dn", [0.5, 1.0, 2.0])
def test_the_noise_of_ordinary_light_is_left_as_it_is(noise_dn: float) -> None:
    image = step_of(20.0, noise_dn)
    assert EdgeMap.of(image, RIG.left).image is image


def test_the_grain_of_a_table_is_left_as_it_is() -> None:
    """It has slopes as steep as those of much noise, but not from pixel to pixel."""
    grain = cv2.GaussianBlur(np.random.default_rng(0).normal(0, 1, SIZE), (0, 0), 2.0)
    image = grey(120 + grain * 15 / grain.std())
    noisy = EdgeMap.of(grey(120 + np.random.default_rng(0).normal(0, 2 * NOISE_DN, SIZE)), RIG.left)
    seen = EdgeMap.of(image, RIG.left)
    assert seen.noise > noisy.noise and seen.image is image and noisy.blur_px > USUAL_BLUR_PX


@pytest.mark.parametrize("height_dn", [180.0, 230.0, 310.0, 390.0])
def test_an_edge_beside_what_is_clipped_is_farther_out_than_it_seems_but_within_its_sigma(height_dn: float) -> None:
    """From a tenth more light than white stands for up to almost twice as much."""
    exact, clipped = (
        edges_in(replace(EdgeMap.of(step_of(height, 0.5), RIG.left), is_exact=True)) for height in (140.0, height_dn)
    )
    assert abs(exact.place_px.mean()) < 0.05 and np.max(exact.spread_px) < 0.15
    assert clipped.place_px.max() < -0.1 and (np.abs(clipped.place_px) < 2 * clipped.spread_px).all()
