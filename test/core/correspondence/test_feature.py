"""Method feature: whole objects by their rows and areas."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from outlines import BASELINE_M, PARALLEL, blank_pair, disc, discs, grey_image, seen
from rendered_solids import PARTS, PLACED, RIG, centre_m, rectified
from rendering import Scene

from stereo_pick.core.correspondence import Correspondences
from stereo_pick.core.correspondence.feature import Feature, least_area_difference
from stereo_pick.core.frames import RectifiedPair
from stereo_pick.core.objects import Blob, Detector
from stereo_pick.core.pipeline import Steps
from stereo_pick.core.refusal import count_reasons

PAIR = blank_pair()


def match(left: list[Blob], right: list[Blob], feature: Feature | None = None) -> Correspondences:
    return (feature or Feature()).match(PAIR, seen(left, right))


def row_of(count: int, first_px: float) -> list[Blob]:
    """Discs all alike, beside each other on one row."""
    return [disc(first_px + 70 * i, 240) for i in range(count)]


@given(st.integers(1, 6))
def test_alike_objects_in_a_row_keep_their_order(count: int) -> None:
    found = match(row_of(count, 200), row_of(count, 120))
    np.testing.assert_allclose(found.left_px[:, 0] - found.right_px[:, 0], 80, atol=1e-9)
    assert len(found) == count and not found.refused


@pytest.mark.parametrize("limit", ["min_depth_m", "max_depth_m"])
def test_what_stands_beyond_a_limit_is_refused_though_others_show_the_table_below_it(limit: str) -> None:
    scene = Scene(tuple(PARTS.values()), PLACED, ambient=0.7)
    depths = sorted(centre_m(RIG, scene, part)[2] for part in PARTS.values())
    between_m = float(np.mean(depths[1:3]))
    steps = Steps(method=Feature(**{limit: between_m}))
    _, matches = steps.correspond(rectified(RIG, scene))
    found = sorted(steps.locate(matches, RIG, 0).xyz @ RIG.left.R[2])
    np.testing.assert_allclose(found, depths[:2] if limit == "max_depth_m" else depths[2:], atol=1e-3)
    assert set(count_reasons(matches.refused)) <= {"out_of_range", "left_only", "right_only"}


@pytest.mark.parametrize(("in_left", "in_right"), [(4, 3), (3, 4), (1, 2), (2, 1)])
def test_of_alike_objects_in_a_row_none_is_guessed_when_one_is_missing(in_left: int, in_right: int) -> None:
    found = match(row_of(in_left, 250), row_of(in_right, 20))
    assert len(found) == 0
    assert count_reasons(found.refused)["ambiguous"] == min(in_left, in_right)


def test_a_missing_object_makes_others_on_other_rows_no_less_sure() -> None:
    found = match([*row_of(2, 250), disc(300, 100)], [*row_of(1, 150), disc(220, 100)])
    np.testing.assert_allclose(found.left_px, [(300, 100)], atol=1e-9)


@pytest.mark.parametrize(
    ("right", "why"),
    [
        (disc(150, 245), "row"),
        (disc(150, 240, 30), "top, bottom and area"),
        (disc(230, 240), "in front of min_depth_m or behind the cameras"),
        (disc(199.5, 240), "beyond max_depth_m"),
    ],
    ids=lambda value: value if isinstance(value, str) else "",
)
def test_what_does_not_fit_is_not_matched(right: Blob, why: str) -> None:
    found = match([disc(200, 240)], [right])
    assert count_reasons(found.refused) == {"left_only": 1, "right_only": 1}, why


def test_tolerances_grow_with_the_objects_height() -> None:
    """Hollow parts look different from two sides: real tubes differ by up to 3.7 rows."""
    small, large = (disc(200, 240, 20), disc(150, 243.0, 20)), (disc(200, 240, 80), disc(150, 243.0, 80))
    assert len(match([small[0]], [small[1]])) == 0
    assert len(match([large[0]], [large[1]])) == 1
    assert len(match([small[0]], [small[1]], Feature(epipolar_tolerance_px=5.0))) == 1


@given(st.floats(1.01, 4.0))
def test_areas_may_differ_up_to_the_ratio(ratio: float) -> None:
    """Half a turned plate shows less of itself: the same rows, another width."""
    squeezed = disc(150, 240, 20).contour_px * (1 / ratio, 1) + (150 - 150 / ratio, 0)
    found = match([disc(200, 240, 20)], [Blob(squeezed, 100.0)])
    assert len(found) == (1 if ratio < 1.5 else 0)


def test_each_object_is_used_once() -> None:
    found = match([disc(200, 240), disc(205, 240.5)], [disc(150, 240)])
    assert len(found) == 0


def test_an_order_that_depth_allows_is_decided_by_the_rows() -> None:
    """A near object left of a far one in one view may stand right of it in the other."""
    near, far = (disc(300, 200), disc(140, 200)), (disc(260, 203), disc(230, 203))
    found = match([far[0], near[0]], [near[1], far[1]])
    assert sorted(map(tuple, np.round(np.c_[found.left_px[:, 0], found.right_px[:, 0]]))) == [(260, 230), (300, 140)]


@given(st.floats(0.3, 2.0), st.floats(-0.2, 0.2))
def test_the_depth_range_bounds_the_disparity(depth_m: float, x_m: float) -> None:
    near, far = 0.5, 1.5
    focal, (cx, cy) = PARALLEL.focal_px, PARALLEL.left.P[:2, 2]
    u = focal * x_m / depth_m + cx
    pair = [disc(u, cy, 30)], [disc(u - focal * BASELINE_M / depth_m, cy, 30)]
    found = match(*pair, Feature(min_depth_m=near, max_depth_m=far))
    assert len(found) == (near <= depth_m <= far)


@pytest.mark.parametrize("faults", [("merged", ""), ("", "merged"), ("merged", "merged")])
def test_a_faulty_outline_and_its_partner_are_refused_once(faults: tuple[str, str]) -> None:
    found = match([disc(200, 240, fault=faults[0])], [disc(150, 240, fault=faults[1])])
    (refusal,) = found.refused
    assert refusal.reason == "merged" and refusal.left_px is not None and refusal.right_px is not None


def test_the_thesiss_pairing_takes_the_nearest_area_even_where_it_is_wrong() -> None:
    """Equation 3.11 knows neither rows nor one-to-one: the nearest area wins, ten times over if need be."""
    left = [disc(200, 100, 20), disc(300, 300, 24)]
    right = [disc(150, 100, 24), disc(250, 300, 20)]  # each one's true partner has the other's area
    assert least_area_difference(left, right) == [(0, 1), (1, 0)]
    found = match(left, right, Feature(assignment="area"))
    assert len(found) == 2 and found.right_px[0][1] == pytest.approx(300)
    assert least_area_difference([disc(90, 90, 20)] * 3, right) == [(0, 1), (1, 1), (2, 1)]
    assert least_area_difference(left, []) == []


def test_the_size_and_direction_are_those_of_the_left_outline() -> None:
    bar = np.array([(-40, -10), (40, -10), (40, 10), (-40, 10)], np.float64)
    found = match([Blob(bar + (300, 240), 100.0)], [Blob(bar * (0.8, 1) + (200, 240), 100.0)])
    np.testing.assert_allclose(found.size_px, [(80, 20)], atol=1e-3)
    assert found.direction_rad[0] == pytest.approx(0, abs=1e-6)


@pytest.mark.parametrize(("max_concavity", "count"), [(0.15, 0), (10.0, 1)])
def test_who_allows_every_outline_gets_a_notched_part_located(max_concavity: float, count: int) -> None:
    """The limit is said once, for finding and for locating."""
    views = [
        grey_image(discs([(300.0 + shift, 240.0, 20.0), (332.0 + shift, 240.0, 20.0)]), noise_dn=1.0, seed=shift)
        for shift in (0, 60)
    ]
    blobs = Detector(max_concavity=max_concavity).detect(RectifiedPair(views[1], views[0], PARALLEL))
    whole = [blob for blob in blobs.left if blob.concavity > 0.15]
    assert len(whole) == 1
    found = Feature(max_sigma_of_width=10, flat_parts=True).match(RectifiedPair(views[1], views[0], PARALLEL), blobs)
    assert sum(extent is None for extent in found.extents) == count


def test_what_is_less_sure_than_is_asked_for_is_refused() -> None:
    views = [disc(200, 100, 20)], [disc(150, 100, 20)]
    assert len(match(*views)) == 1
    assert count_reasons(match(*views, Feature(max_sigma_of_width=0.01)).refused) == {"uncertain": 1}
