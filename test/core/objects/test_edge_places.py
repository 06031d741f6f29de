"""Profiles of grey levels whose edge is known, and beside which both sides shade."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from stereo_pick.core.arrays import Floats
from stereo_pick.core.objects.edge_model import OFFSETS_PX, find_edges
from stereo_pick.core.objects.edge_places import places_px

FINE = np.arange(-12, 14, 0.01)
PLACES = np.linspace(-0.9, 0.9, 19)
BLUR_PX = 0.85


def seen(place_px: float, blur_px: float, inside: float, behind: float, before: float) -> Floats:
    """A table of level 60 at the edge and a part of that level; away from it both change by so much on 6 px."""
    away = np.abs(FINE - place_px)
    part, table = inside + behind * np.minimum(away / 6, 1), 60 + before * np.minimum(away / 6, 1)
    light = np.where(place_px < FINE, part, table)
    weight = np.exp(-0.5 * ((OFFSETS_PX[:, None] - FINE) / blur_px) ** 2)
    return np.asarray(weight @ light / weight.sum(axis=1))


def profiles(blur_px: float, inside: float, behind: float, before: float) -> Floats:
    return np.array([seen(place, blur_px, inside, behind, before) for place in PLACES])


@pytest.mark.parametrize("blur_px", [0.65, 0.85, 1.2])
@pytest.mark.parametrize("inside", [180.0, 20.0])
def test_a_step_is_found_where_it_is(blur_px: float, inside: float) -> None:
    place_px, spread_px = places_px(profiles(blur_px, inside, 0, 0), blur_px)
    np.testing.assert_allclose(place_px, PLACES, atol=0.03)
    assert spread_px.max() < 0.2 * blur_px


@pytest.mark.parametrize("inside", [180.0, 110.0])
@pytest.mark.parametrize("behind", [0.0, 20.0])
def test_the_foot_of_a_part_that_darkens_its_table_is_where_it_is(inside: float, behind: float) -> None:
    """With shading behind the edge alone it seems to lie far inside."""
    grey = profiles(BLUR_PX, inside, behind, 30)
    place_px, _ = places_px(grey, BLUR_PX)
    assert np.abs(place_px - PLACES).max() < 0.07
    assert np.mean(find_edges(grey, BLUR_PX).place_px - PLACES) > 0.1


@given(st.floats(-30, 30), st.floats(-30, 30), st.floats(100, 190))
def test_inside_and_outside_are_told_apart_by_nothing(behind: float, before: float, inside: float) -> None:
    """A profile read the other way round has its edge at the other place."""
    grey = profiles(BLUR_PX, inside, behind, before)
    there, spread_px = places_px(grey, BLUR_PX)
    back, as_sure_px = places_px(grey[:, ::-1], BLUR_PX)
    np.testing.assert_allclose(back, -there, atol=1e-9)
    np.testing.assert_allclose(as_sure_px, spread_px, atol=1e-6)


@given(st.floats(-40, 60))
def test_places_do_not_depend_on_how_dark_all_of_it_is(by: float) -> None:
    grey = profiles(BLUR_PX, 150, 10, 20)
    np.testing.assert_allclose(places_px(grey + by, BLUR_PX), places_px(grey, BLUR_PX), atol=1e-9)


@pytest.mark.parametrize(("inside", "noise"), [(160.0, 1.0), (160.0, 3.0), (90.0, 2.0), (75.0, 2.0)])
def test_a_place_is_as_sure_as_it_says(inside: float, noise: float) -> None:
    """Places err by no more than their sigma, however weak the edge; and a weaker one is less sure."""
    random = np.random.default_rng(7)
    places = random.uniform(-0.4, 0.4, 400)
    grey = np.array([seen(place, BLUR_PX, inside, 8, 12) for place in places])
    place_px, spread_px = places_px(grey + random.normal(0, noise, grey.shape), BLUR_PX)
    off_px = place_px - places
    assert 0.4 < np.sqrt(np.mean((off_px / spread_px) ** 2)) < 1.15
    clear_px = places_px(grey, BLUR_PX)[1]
    assert np.median(spread_px) > np.median(clear_px)
