"""Limbs that are as bright as what is behind them, of known shading."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from outlines import PARALLEL, grey_image
from rigs import SIZE_PX

from stereo_pick.core.arrays import Floats
from stereo_pick.core.edges.fading_limb import SIGMA_PX, fading_limbs
from stereo_pick.core.edges.hypotheses import Images
from stereo_pick.core.edges.locking import lock
from stereo_pick.core.frames import RectifiedPair
from stereo_pick.core.objects.edge_model import OFFSETS_PX
from stereo_pick.core.shapes.kinds import SPHERE
from stereo_pick.core.shapes.solids import Solids

FINE = np.arange(-12, 12, 0.01)
BLUR_PX = 0.85
BALL = Solids(SPHERE, np.array([[0.02, 0.01, 0.5]]), np.eye(3)[None], np.array([[0.03]]), np.zeros((1, 3, 0)))


def seen(light: Floats, noise_dn: float = 0.0) -> Floats:
    """One profile (1, M) of light at FINE."""
    weight = np.exp(-0.5 * ((OFFSETS_PX[:, None] - FINE) / BLUR_PX) ** 2)
    noise = np.random.default_rng(0).normal(0, noise_dn, len(OFFSETS_PX))
    return np.round(weight @ light / weight.sum(axis=1) + noise)[None]


@settings(deadline=None)
@given(st.floats(-0.6, 0.6), st.floats(0.6, 0.9), st.floats(60, 120), st.sampled_from([-1, 1]))
def test_shading_begins_where_it_does(place_px: float, power: float, rise: float, sign: int) -> None:
    """However steeply it falls off there, and whether it is brighter or darker inside."""
    light = 128 + sign * rise * (np.maximum(FINE - place_px, 0) / 4) ** power
    place, found = fading_limbs(seen(light), BLUR_PX)
    assert found[0] and abs(place[0] - place_px) < SIGMA_PX


@settings(deadline=None)
@given(st.floats(-30, 30), st.floats(-4, 4))
def test_light_that_changes_smoothly_does_not_end(slope: float, bend: float) -> None:
    assert not fading_limbs(seen(np.clip(128 + slope * FINE / 4 + bend * FINE**2 / 4, 0, 255)), BLUR_PX)[1][0]


@pytest.mark.parametrize("noise_dn", [0.5, 2.0, 8.0])
def test_nor_does_noise(noise_dn: float) -> None:
    profiles = np.random.default_rng(1).normal(90, noise_dn, (5000, len(OFFSETS_PX)))
    assert fading_limbs(profiles, BLUR_PX)[1].mean() < 0.01


@pytest.mark.parametrize("sign", [1, -1])
def test_a_ball_as_bright_at_its_limb_as_the_table_is_seen(sign: int) -> None:
    """Of metal, for instance: no part of its silhouette had an edge."""
    views = []
    v, u = np.mgrid[: SIZE_PX[1], : SIZE_PX[0]]
    for eye_m, camera in zip(PARALLEL.eyes_m, (PARALLEL.left, PARALLEL.right)):
        rays = np.stack(
            [(u - camera.P[0, 2]) / camera.P[0, 0], (v - camera.P[1, 2]) / camera.P[1, 1], u * 0 + 1.0], axis=-1
        )
        rays /= np.linalg.norm(rays, axis=-1, keepdims=True)
        centre_m = BALL.centre_m[0] - eye_m
        along = rays @ centre_m
        facing = np.sqrt(np.maximum(1 - (centre_m @ centre_m - along**2) / BALL.half_m[0, 0] ** 2, 0))
        views.append(grey_image(120 + sign * 100 * facing**1.6))
    images = Images(RectifiedPair(*views, PARALLEL))
    assert lock(BALL, images.maps, PARALLEL).shown.max() == 0
    images = images.with_fading_limbs()
    found = lock(BALL, images.maps, PARALLEL)
    assert found.shown.min() > 0.5
    np.testing.assert_allclose(found.fit.solids.centre_m, BALL.centre_m, atol=2e-3)
