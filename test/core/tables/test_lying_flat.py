"""What lies on a table looks the same in both views once one is warped by its plane; what rises from it does not."""

from __future__ import annotations

from dataclasses import replace

import cv2
import numpy as np
import pytest
from family_scenes import found
from grain_on_planes import columns_in_left, plane, seen
from outlines import disc
from rigs import RIGS

from stereo_pick.core.frames import RectifiedPair
from stereo_pick.core.objects import Blob
from stereo_pick.core.shapes import SolidFit
from stereo_pick.core.shapes.sight import normalized
from stereo_pick.core.shapes.table import Table
from stereo_pick.core.tables.lying_flat import WarpedViews
from stereo_pick.core.windows.window_planes import as_table, of_table

RIG = RIGS["thesis"]
TABLE = plane(35, 0, 0.9)
MEASURED = Table(TABLE.normal, TABLE.offset_m, 5e-4)
MIDDLE, RADIUS_PX = (320.0, 240.0), 60.0


def raised(height_m: float, radius_px: float = RADIUS_PX) -> RectifiedPair:
    """A print on a table, but for a disc of it that is so much higher."""
    above = Table(TABLE.normal, TABLE.offset_m - height_m, 0.0)
    low, high = seen(RIG, TABLE, 20.0, 0), seen(RIG, above, 20.0, 1)
    height, width = low.left.shape
    columns, rows = np.meshgrid(np.arange(width, dtype=float), np.arange(height, dtype=float))
    there = ((columns - MIDDLE[0]) ** 2 + (rows - MIDDLE[1]) ** 2 < radius_px**2).astype(np.float32)
    at = columns_in_left(RIG, above, columns, rows).astype(np.float32)
    there_right = cv2.remap(there, at, rows.astype(np.float32), cv2.INTER_LINEAR) > 0.5
    left, right = np.where(there > 0.5, high.left, low.left), np.where(there_right, high.right, low.right)
    return RectifiedPair(left, right, RIG, 0)


def outline(radius_px: float) -> Blob:
    return disc(*MIDDLE, radius_px)


def test_a_print_lies_on_its_table() -> None:
    warped = WarpedViews(raised(0.0), MEASURED)
    assert warped.is_all_of(outline(100), []) and warped.rising(outline(100), []) == []


@pytest.mark.parametrize("height_m", [0.004, 0.01, 0.04])
def test_what_rises_from_a_print_is_seen_where_it_is(height_m: float) -> None:
    warped = WarpedViews(raised(height_m), MEASURED)
    assert not warped.is_all_of(outline(100), [])
    largest = max(warped.rising(outline(140), []), key=lambda hull: cv2.contourArea(hull.astype(np.float32)))
    (x, y), radius_px = cv2.minEnclosingCircle(largest.astype(np.float32))
    assert np.hypot(x - MIDDLE[0], y - MIDDLE[1]) < RADIUS_PX / 4
    assert radius_px == pytest.approx(RADIUS_PX, rel=0.3)


@pytest.mark.parametrize(("sigma_m", "may", "surely"), [(2e-4, False, False), (2e-3, True, True), (1e-2, True, False)])
def test_what_may_lie_on_a_table_that_is_hardly_known_does_not_surely(sigma_m: float, may: bool, surely: bool) -> None:
    """All of it is 3 mm above where the table seems to be, and 0.2 m wide."""
    seems = Table(TABLE.normal, TABLE.offset_m + 0.003, sigma_m)
    warped, beside = WarpedViews(raised(0.0), seems), ball(RADIUS_PX)
    assert (warped.is_all_of(outline(100), []), warped.is_surely_all_of(beside, outline(100), [])) == (may, surely)


@pytest.mark.parametrize(("thick_m", "surely"), [(0.03, True), (0.008, False)])
def test_what_lies_beside_a_thin_solid_may_be_as_thin_a_piece_of_it(thick_m: float, surely: bool) -> None:
    """The foot of an angle bracket, as thick as its wall, rose by less than was open of a table known to 2 mm."""
    seems = Table(TABLE.normal, TABLE.offset_m, 2e-3)
    wall = replace(ball(RADIUS_PX), kind="box", size_m=np.array([0.04, thick_m, 0.04]))
    assert WarpedViews(raised(0.0), seems).is_surely_all_of(wall, outline(100), []) == surely


def ball(radius_px: float, away_px: float = 0.0) -> SolidFit:
    """A ball so far beside the middle of the disc."""
    ray = np.append(normalized(np.array([MIDDLE]) - (away_px, 0.0), RIG.left)[0], 1.0)
    depth_m = TABLE.offset_m / -float(TABLE.normal @ ray)
    size_m = 2 * radius_px * depth_m / RIG.focal_px
    return SolidFit("sphere", ray * depth_m, np.eye(3), np.full(3, size_m), 0.1, np.eye(3) * 1e-8)


def test_beside_a_solid_that_rises_the_rest_of_a_print_lies() -> None:
    """A ball around the disc: what is clear of it in both views is print."""
    warped = WarpedViews(raised(0.01), MEASURED)
    print_ = outline(140.0)
    assert not warped.is_all_of(print_, [])
    assert warped.is_all_of(print_, [ball(RADIUS_PX + 10)])


@pytest.mark.parametrize(
    ("away_px", "sigma_m", "lies"), [(180.0, 5e-4, True), (180.0, 1e-2, False), (95.0, 5e-4, False)]
)
def test_what_rises_far_from_a_solid_is_no_piece_of_it(away_px: float, sigma_m: float, lies: bool) -> None:
    """One outline holds them both, as that of a board on which several parts stand."""
    warped = WarpedViews(raised(0.01), replace(MEASURED, sigma_m=sigma_m))
    one, board = ball(25.0, away_px), outline(220.0)
    assert not warped.is_surely_all_of(one, board, [one])
    assert warped.is_surely_all_beside(one, board, [one]) == lies


@pytest.mark.parametrize("height_m", [0.0, 0.01])
def test_what_rises_may_be_a_piece_of_it_however_little_of_the_outline_it_is(height_m: float) -> None:
    """The stem of a T, whose outline ran into that of a large print."""
    warped, one, board = WarpedViews(raised(height_m, 30.0), MEASURED), ball(20.0, 75.0), outline(150.0)
    assert warped.is_all_of(board, [one])
    assert (
        warped.is_surely_all_of(one, board, [one]) == warped.is_surely_all_beside(one, board, [one]) == (not height_m)
    )


@pytest.mark.parametrize(("long", "lies"), [(1.0, True), (2.4, False)])
def test_a_piece_of_a_long_solid_may_be_as_far_from_it_as_that_is_long(long: float, lies: bool) -> None:
    """Of a bracket's foot, as black as its wall, the nearest edge that showed was the one on which it stood."""
    warped, middle = WarpedViews(raised(0.01), MEASURED), ball(25.0, 180.0)
    wall = replace(middle, kind="box", size_m=middle.size_m * (long, 0.6, 0.6))
    assert warped.is_surely_all_beside(wall, outline(220.0), [wall]) == lies


@pytest.mark.parametrize(("height_m", "through"), [(0.0, True), (0.004, False), (0.04, False)])
def test_the_table_shows_through_what_is_no_solid(height_m: float, through: bool) -> None:
    warped = WarpedViews(raised(height_m), MEASURED)
    assert warped.shows_through(ball(RADIUS_PX - 5)) == through


@pytest.mark.parametrize(("height_m", "in_place"), [(0.0, True), (0.04, False)])
def test_the_table_is_seen_in_place_of_what_is_too_slim_for_a_window_that_is_clear_of_its_outline(
    height_m: float, in_place: bool
) -> None:
    assert WarpedViews(raised(height_m), MEASURED).is_seen_in_place_of(ball(10.0)) == in_place


@pytest.mark.parametrize(("radius_px", "is_told"), [(2.0, False), (10.0, True)])
def test_what_rises_by_less_than_a_pixel_of_disparity_is_not_told_from_marks(radius_px: float, is_told: bool) -> None:
    assert WarpedViews(raised(0.0), MEASURED).is_told_from_marks(ball(radius_px)) == is_told


@pytest.mark.parametrize(
    ("height_m", "sigma_m", "nothing"), [(0.0, 5e-4, True), (0.01, 5e-4, False), (0.0, 1e-2, False)]
)
def test_nothing_rises_from_a_print_on_a_table_that_is_known(height_m: float, sigma_m: float, nothing: bool) -> None:
    warped = WarpedViews(raised(height_m), replace(MEASURED, sigma_m=sigma_m))
    assert warped.shows_nothing_rise(outline(100), []) == nothing


def test_where_nothing_is_seen_something_may_rise() -> None:
    blank = np.full((480, 640), 110, np.uint8)
    assert not WarpedViews(RectifiedPair(blank, blank, RIG, 0), MEASURED).shows_nothing_rise(outline(100), [])


def test_a_table_is_seen_through_the_end_of_a_tube() -> None:
    """Of a cylinder that points to the camera nothing but an end is seen."""
    there = ball(RADIUS_PX - 5)
    towards = there.centre_m / -np.linalg.norm(there.centre_m)
    rotation = np.linalg.svd(towards[None])[2][[1, 2, 0]].T
    tube = replace(there, kind="cylinder", rotation=rotation * np.sign(np.linalg.det(rotation)))
    warped = WarpedViews(raised(0.0), MEASURED)
    assert warped.shows_through(there) and not warped.shows_through(tube)


def test_the_halo_of_an_outline_is_no_table_behind_a_solid() -> None:
    """Within a dark disc on the table nothing is seen, but beside its edge what is left without even light."""
    width, height = RIG.left.frame_size
    columns, rows = np.meshgrid(np.arange(width, dtype=float), np.arange(height, dtype=float))
    off_px = np.hypot(columns - MIDDLE[0], rows - MIDDLE[1]) - RADIUS_PX
    dark = np.clip(0.5 - off_px / 2, 0, 1).astype(np.float32)
    at = columns_in_left(RIG, TABLE, columns, rows).astype(np.float32)
    dark_right = cv2.remap(dark, at, rows.astype(np.float32), cv2.INTER_LINEAR)
    noise = np.random.default_rng(0).normal(0, 0.7, (2, height, width))
    left, right = (np.rint(200 - 180 * each + more).astype(np.uint8) for each, more in zip((dark, dark_right), noise))
    assert not WarpedViews(RectifiedPair(left, right, RIG, 0), MEASURED).shows_through(ball(RADIUS_PX - 2))


def test_the_shading_of_a_ball_is_no_table_behind_it() -> None:
    """Seen from above; it was found, with edges all around, and refused as flat."""
    result = found("elevation_30_to_90", 355)
    assert len(result.missed) == 0 and result.wrong == 0


def test_nothing_shows_through_a_solid_where_nothing_is_seen_at_all() -> None:
    blank = np.full((480, 640), 110, np.uint8)
    assert not WarpedViews(RectifiedPair(blank, blank, RIG, 0), MEASURED).shows_through(ball(RADIUS_PX))


def test_where_nothing_shows_it_is_not_known_to_lie() -> None:
    blank = np.full((480, 640), 110, np.uint8)
    assert not WarpedViews(RectifiedPair(blank, blank, RIG, 0), MEASURED).is_all_of(outline(100), [])


@pytest.mark.parametrize("scale", [1.0, 0.5, 0.37])
@pytest.mark.parametrize("turn_deg", [0.0, 40.0, 200.0])
def test_a_table_as_a_plane_of_disparities_is_that_table(scale: float, turn_deg: float) -> None:
    table = plane(35, turn_deg, 0.9)
    there = as_table(of_table(table, RIG, scale), RIG, scale, np.array([320.0, 240.0]) * scale, 0.1)
    assert there is not None
    np.testing.assert_allclose(there.normal, table.normal, atol=1e-9)
    assert there.offset_m == pytest.approx(table.offset_m, rel=1e-9)
