"""Method ssd: centroids of the left view, found again by correlation."""

from __future__ import annotations

import numpy as np
import pytest
from outlines import PARALLEL, disc, pattern, seen
from rigs import SIZE_PX

from stereo_pick.core.correspondence.correspondences import Correspondences
from stereo_pick.core.correspondence.ssd import Ssd
from stereo_pick.core.errors import ParameterError
from stereo_pick.core.frames import RectifiedPair
from stereo_pick.core.objects import Blobs
from stereo_pick.core.refusal import count_reasons

U, V = np.meshgrid(np.arange(SIZE_PX[0], dtype=np.float64), np.arange(SIZE_PX[1], dtype=np.float64))
PLACES = ((150.3, 100.2), (320.0, 240.4), (500.7, 380.6))


def painted(*shifts_px: float, contrast: float = 40.0, noise_dn: float = 1.0) -> tuple[RectifiedPair, Blobs]:
    """Painted discs, each of its own disparity, on an even table; and their outlines."""
    grey, rng = pattern(contrast=contrast), np.random.default_rng(8)
    left, right = np.full(U.shape, 40.0), np.full(U.shape, 40.0)
    for (u, v), shift in zip(PLACES, shifts_px):
        here, there = np.hypot(U - u, V - v) < 30, np.hypot(U - u + shift, V - v) < 30
        left[here], right[there] = grey(U[here], V[here]), grey(U[there] + shift, V[there])
    images = [np.clip(np.round(x + rng.normal(0, noise_dn, x.shape)), 0, 255).astype(np.uint8) for x in (left, right)]
    outlines = [disc(u, v, 30) for u, v in PLACES[: len(shifts_px)]]
    moved = [disc(u - shift, v, 30) for (u, v), shift in zip(PLACES, shifts_px)]
    return RectifiedPair(*images, PARALLEL), seen(outlines, moved)


def reasons(found: Correspondences) -> dict[str, int]:
    return count_reasons(found.refused)


@pytest.mark.parametrize("part", [0.0, 0.25, 0.5, 0.75])
def test_each_part_is_found_at_its_own_disparity(part: float) -> None:
    shifts = (80 + part, 95 + part, 120 + part)
    found = Ssd().match(*painted(*shifts))
    np.testing.assert_allclose(found.left_px, PLACES, atol=1e-6)
    np.testing.assert_allclose(found.left_px[:, 0] - found.right_px[:, 0], shifts, atol=0.05)
    np.testing.assert_array_equal(found.left_px[:, 1], found.right_px[:, 1])


def test_textureless_is_refused_not_guessed() -> None:
    found = Ssd().match(*painted(80.0, 95.0, 120.0, contrast=0.0))
    assert len(found) == 0 and reasons(found) == {"no_texture": 3}


@pytest.mark.parametrize("noise_dn", [0.0, 1.0])
def test_a_paint_that_repeats_along_the_line_is_ambiguous(noise_dn: float) -> None:
    """Without noise, as a simulator renders, the best place and the next best both fit without any remainder."""
    stripes = 120 + 60 * np.cos(2 * np.pi * U / 10)  # a disparity of 80 is a whole number of periods
    rng = np.random.default_rng(4)
    images = [
        np.round(np.where(np.hypot(U - u, V - 240) < 30, stripes, 40.0) + rng.normal(0, noise_dn, U.shape))
        for u in (320, 240)
    ]
    pair = RectifiedPair(*(image.astype(np.uint8) for image in images), PARALLEL)
    found = Ssd(narrowest_window_px=11, widest_window_px=11).match(
        pair, seen([disc(320, 240, 30)], [disc(240, 240, 30)])
    )
    assert len(found) == 0 and reasons(found) == {"ambiguous": 1}


def striped(*others_px: tuple[float, float, float]) -> tuple[RectifiedPair, Blobs]:
    """A disc with a print that repeats and something that does not, at a disparity of 80, and the outlines that the
    right view has of others."""
    paint = 120 + 40 * np.cos(2 * np.pi * U / 12) + 4 * pattern(contrast=1.0)(U - 320, V)
    left = np.where(np.hypot(U - 320, V - 240) < 30, paint, 40.0)
    rng = np.random.default_rng(4)
    images = [np.round(each + rng.normal(0, 1.0, U.shape)).astype(np.uint8) for each in (left, np.roll(left, -80, 1))]
    return RectifiedPair(*images, PARALLEL), seen([disc(320, 240, 30)], [disc(*each) for each in others_px])


def test_a_print_that_nearly_repeats_is_ambiguous_where_its_own_outline_is_missing() -> None:
    """The next part's outline holds another period, which is all alike."""
    found = Ssd().match(*striped((272, 240, 20)))
    assert len(found) == 0 and reasons(found) == {"ambiguous": 1}


def test_who_asks_for_no_uniqueness_gets_the_best_place() -> None:
    found = Ssd(min_uniqueness=1.0).match(*striped((240, 240, 30)))
    assert float(found.right_px[0, 0]) == pytest.approx(240, abs=0.1)


def test_a_window_wider_than_the_part_is_not_compared() -> None:
    """The table behind the part would be, which has a print of its own."""
    grey = pattern()
    left = np.where(np.hypot(U - 320, V - 240) < 12, 200.0, grey(U, V))
    right = np.where(np.hypot(U - 240, V - 240) < 12, 200.0, grey(U + 60, V))
    pair = RectifiedPair(left.astype(np.uint8), right.astype(np.uint8), PARALLEL)
    blobs = seen([disc(320, 240, 12)], [disc(240, 240, 12)])
    found = Ssd(narrowest_window_px=41, widest_window_px=41).match(pair, blobs)
    assert [(each.reason, each.detail) for each in found.refused] == [
        ("no_texture", "the narrowest window, 41 px, is wider than it")
    ]


def test_a_part_that_looks_different_from_the_other_side_is_refused() -> None:
    pair, blobs = painted(80.0)
    rng = np.random.default_rng(1)
    part = np.hypot(U - PLACES[0][0] + 80, V - PLACES[0][1]) < 30
    other = np.where(part, rng.integers(60, 200, pair.right.shape), pair.right).astype(np.uint8)
    found = Ssd(max_sigma_px=2.0).match(RectifiedPair(pair.left, other, PARALLEL), blobs)
    (refusal,) = found.refused
    assert refusal.reason == "poor_match" and refusal.detail.startswith("similarity")


def test_a_match_that_leads_back_elsewhere_is_refused() -> None:
    """Two parts of the same paint, one of them paler and alone within the depth range: its match is the other's."""
    grey, images = pattern(), [np.full(U.shape, 40.0), np.full(U.shape, 40.0)]
    for image, column, strength in ((images[0], 300, 0.75), (images[0], 500, 1.0), (images[1], 200, 1.0)):
        here = np.hypot(U - column, V - 240) < 30
        image[here] = 120 + strength * (grey(U[here] - column, V[here]) - 120)
    pair = RectifiedPair(*(np.clip(np.round(image), 0, 255).astype(np.uint8) for image in images), PARALLEL)
    blobs = seen([disc(300, 240, 30), disc(500, 240, 30)], [disc(200, 240, 30)])
    within_150_px = Ssd(min_depth_m=PARALLEL.focal_px * PARALLEL.baseline_m / 150, max_sigma_px=2.0)
    found = within_150_px.match(pair, blobs)
    assert len(found) == 0
    assert [r.detail for r in found.refused if r.reason == "poor_match"] == ["leads back +200.0 px beside its start"]


def test_a_part_without_a_region_of_interest_on_its_line_is_left_only() -> None:
    pair, blobs = painted(80.0)
    assert reasons(Ssd().match(pair, seen(blobs.left, [disc(70, 400, 30)]))) == {"left_only": 1}


def test_a_match_outside_the_depth_range_is_not_looked_for() -> None:
    pair, blobs = painted(80.0)
    depth_m = PARALLEL.focal_px * PARALLEL.baseline_m / 80.0
    assert len(Ssd(min_depth_m=0.5 * depth_m).match(pair, blobs)) == 1
    assert len(Ssd(min_depth_m=2.0 * depth_m).match(pair, blobs)) == 0


def test_two_left_parts_never_share_one_place() -> None:
    pair, blobs = painted(80.0)
    twice = seen([*blobs.left, disc(PLACES[0][0] + 1, PLACES[0][1], 30)], blobs.right)
    found = Ssd().match(pair, twice)
    assert len(found) == 0 and reasons(found) == {"ambiguous": 2}


def test_the_thesiss_full_search_ends_on_a_whole_pixel() -> None:
    pair, blobs = painted(80.0, 95.5, 120.25, noise_dn=0.0)
    found = Ssd(search="full").match(pair, blobs)
    np.testing.assert_array_equal(found.right_px, np.round(found.right_px))
    whole = found.left_px[0] - found.right_px[0]
    np.testing.assert_allclose(whole, (80, 0), atol=0.5)


def test_the_full_search_leaves_the_epipolar_line_and_the_checked_one_does_not() -> None:
    pair, blobs = painted(80.0, 95.0, 120.0, contrast=2.0, noise_dn=2.0)
    full = Ssd(search="full").match(pair, blobs)
    assert np.abs(full.left_px[:, 1] - full.right_px[:, 1]).max() > 2
    checked = Ssd().match(pair, blobs)
    np.testing.assert_array_equal(checked.left_px[:, 1], checked.right_px[:, 1])


def test_more_noise_gives_a_greater_sigma() -> None:
    quiet, loud = (Ssd(max_sigma_px=2.0).match(*painted(80.0, noise_dn=noise)) for noise in (0.5, 12.0))
    assert loud.sigma_px[0, 1] > quiet.sigma_px[0, 1]


def test_an_even_window_has_no_middle() -> None:
    with pytest.raises(ParameterError, match="narrowest_window_px = 14 must be odd"):
        Ssd(narrowest_window_px=14)
