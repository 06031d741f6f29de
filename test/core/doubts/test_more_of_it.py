"""What touches an object and is refused may be more of the same object."""

from __future__ import annotations

import numpy as np
import pytest
from marks import first_of
from outlines import disc
from rendered_solids import PLACED, RIG, rectified
from rendering import Box, Cylinder, Scene
from rigs import RIGS

from stereo_pick.core.arrays import Floats
from stereo_pick.core.correspondence.feature import Feature
from stereo_pick.core.doubts.more_of_it import as_unsure_as_whole
from stereo_pick.core.matches.left_over import Unread
from stereo_pick.core.pipeline import Steps
from stereo_pick.core.places.position import Located
from stereo_pick.core.shapes import SolidFit

PARALLEL = RIGS["thesis"]
BALL = SolidFit("sphere", np.array([0.05, 0.0, 0.9]), np.eye(3), np.full(3, 0.04), 0.1, np.eye(3) * 1e-8)
PLACES = [BALL.centre_px(camera) for camera in (PARALLEL.left, PARALLEL.right)]
RADIUS_PX = 0.02 * PARALLEL.focal_px / 0.9


def added(away: tuple[float, float], radius: float = 1.0) -> Floats:
    """Of a ball beside which something round, of so many radii, was refused, so many radii away in each view."""
    blobs = disc(*PLACES[0], RADIUS_PX), disc(*PLACES[1], RADIUS_PX)
    others = [disc(x + off * RADIUS_PX, y, radius * RADIUS_PX) for (x, y), off in zip(PLACES, away)]
    row = blobs, Located(*PLACES, 0.1, BALL)
    ((_, where),) = as_unsure_as_whole([row], [], [Unread("merged", *others)], PARALLEL, None)
    return where.covariance


@pytest.mark.parametrize("radius", [0.5, 1.0, 2.0])
def test_the_centre_may_be_that_of_both_together(radius: float) -> None:
    apart_m = (1 + radius) * 0.02 * radius**2 / (1 + radius**2)
    ends_m = 0.05 * 0.04
    assert added((1 + radius, 1 + radius), radius) == pytest.approx((apart_m**2 + ends_m**2) * np.eye(3), rel=0.05)


@pytest.mark.parametrize("away", [(2.0, 2.5), (2.5, 2.0), (3.0, 3.0)])
def test_what_does_not_touch_in_both_views_is_something_else(away: tuple[float, float]) -> None:
    assert not added(away).any()


@pytest.mark.parametrize(("away", "is_piece"), [(2.0, True), (2.5, False)])
def test_what_touches_the_solid_where_an_outline_lacks_a_face_of_it_may_be_more_of_it(
    away: float, is_piece: bool
) -> None:
    """As the sides of a dark part do, of which one view does not tell the top from the table."""
    (x, y), (right_x, right_y) = PLACES
    blobs = disc(x - 0.5 * RADIUS_PX, y, 0.5 * RADIUS_PX), disc(right_x, right_y, RADIUS_PX)
    others = disc(x + away * RADIUS_PX, y, RADIUS_PX), disc(right_x + away * RADIUS_PX, right_y, RADIUS_PX)
    row = blobs, Located(*PLACES, 0.1, BALL)
    ((_, where),) = as_unsure_as_whole([row], [], [Unread("merged", *others)], PARALLEL, None)
    assert where.covariance.any() == is_piece


@pytest.mark.parametrize(("down", "is_piece"), [(0.0, True), (1.5, True), (2.2, False)])
def test_what_each_view_alone_shows_beside_it_is_one_thing_if_that_is_on_the_same_rows(
    down: float, is_piece: bool
) -> None:
    """Its outlines differ too much to be matched: in one view half of it is in a shadow."""
    blobs = disc(*PLACES[0], RADIUS_PX), disc(*PLACES[1], RADIUS_PX)
    beside = [(x + 1.7 * RADIUS_PX, y + by * RADIUS_PX) for (x, y), by in zip(PLACES, (-down / 2, down / 2))]
    left, right = disc(*beside[0], RADIUS_PX), disc(*beside[1], RADIUS_PX)
    alone = [Unread("merged", left, None), Unread("right_only", None, right)]
    ((_, where),) = as_unsure_as_whole([(blobs, Located(*PLACES, 0.1, BALL))], [], alone, PARALLEL, None)
    assert where.covariance.any() == is_piece
    ((_, where),) = as_unsure_as_whole([(blobs, Located(*PLACES, 0.1, BALL))], [], alone[:1], PARALLEL, None)
    assert not where.covariance.any()


@pytest.mark.parametrize(("gap_px", "is_piece"), [(4.0, True), (6.0, False)])
def test_where_outlines_were_cut_apart_blur_is_left_between_them(gap_px: float, is_piece: bool) -> None:
    away = 2 + gap_px / RADIUS_PX
    assert added((away, away)).any() == is_piece


def test_a_piece_of_what_the_solid_explains_moves_nothing() -> None:
    assert not added((0.5, 0.5), 0.5).any()


@pytest.mark.parametrize("is_sure", [True, False])
def test_what_is_flush_with_a_piece_is_as_unsure_however_sure_that_is(is_sure: bool) -> None:
    """The stem and the bar of a T."""
    blobs = disc(*PLACES[0], RADIUS_PX), disc(*PLACES[1], RADIUS_PX)
    stem, bar = (
        SolidFit("box", np.array([x, 0.0, 0.9]), np.eye(3), np.array(size), 0.1, np.eye(3) * 1e-8)
        for x, size in ((0.0, (0.04, 0.02, 0.02)), (0.025, (0.01, 0.05, 0.02)))
    )
    row, other = ((blobs, Located(*PLACES, 0.1, fit)) for fit in (stem, bar))
    sure, unsure = ([row, other], []) if is_sure else ([row], [other])
    (_, where), *_ = as_unsure_as_whole(sure, unsure, [], PARALLEL, None)
    assert where.covariance == pytest.approx((0.025 * 10 / 26) ** 2 * np.eye(3))
    assert not as_unsure_as_whole([row], [], [], PARALLEL, None)[0][1].covariance.any()


def solids(kind: str, x_m: float, size_m: tuple[float, float, float], z_m: float = 0.9) -> SolidFit:
    return SolidFit(kind, np.array([x_m, 0.0, z_m]), np.eye(3), np.array(size_m), 0.1, np.eye(3) * 1e-8)


@pytest.mark.parametrize(
    ("other", "sigma_m", "beside_px", "is_one"),
    [
        (solids("cylinder", 0.04, (0.02, 0.02, 0.05)), 0.006, 0.0, True),
        (solids("cylinder", 0.04, (0.02, 0.02, 0.05)), 0.001, 0.0, False),
        (solids("cylinder", 0.04, (0.02, 0.02, 0.05)), 0.006, 20.0, False),
        (solids("cylinder", 0.0, (0.02, 0.02, 0.02), 0.84), 0.001, 20.0, True),
    ],
    ids=["touches it", "touches it, but is known, as in a stack", "beside it", "on its axis, as the end of a shank"],
)
def test_where_no_table_is_known_another_may_be_a_piece_of_it(
    other: SolidFit, sigma_m: float, beside_px: float, is_one: bool
) -> None:
    """The stem of an L passed for a lying cylinder, 21 mm off the middle of both, and both were sure of it."""
    one = solids("hexprism", 0.0, (0.04, 0.035, 0.02))
    left, right = (disc(*one.centre_px(camera), 20.0) for camera in (PARALLEL.left, PARALLEL.right))
    beside = (
        disc(*(left.centroid_px + (40.0 + beside_px, 0.0)), 20.0),
        disc(*(right.centroid_px + (40.0 + beside_px, 0.0)), 20.0),
    )
    unsure = Located(*PLACES, 0.1, other, covariance=sigma_m**2 * np.eye(3))
    rows = [((left, right), Located(*PLACES, 0.1, one)), (beside, unsure)]
    assert as_unsure_as_whole(rows, [], [], PARALLEL, None)[0][1].covariance.any() == is_one


@pytest.mark.parametrize(
    ("thick_m", "yaw_rad"),
    [
        *first_of(*((0.008, yaw_rad) for yaw_rad in (0.3, 1.2, 2.1, 2.9))),
        *first_of(*((0.012, yaw_rad) for yaw_rad in (1.2, 2.1, 0.3, 2.9))),
    ],
)
def test_an_angle_bracket_is_not_placed_surely_at_one_of_its_flanges(thick_m: float, yaw_rad: float) -> None:
    """Nor at both, where both are found as boxes: these are flush."""
    along, across = np.array([np.cos(yaw_rad), np.sin(yaw_rad)]), 0.04
    foot, wall = (0.06, across, thick_m), (thick_m, across, 0.04)
    x, y = (foot[0] + thick_m) / 2 * along
    bracket = Box(0.0, 0.0, foot, yaw_rad=yaw_rad, albedo=0.7), Box(x, y, wall, yaw_rad=yaw_rad, albedo=0.7)
    others = Cylinder(-0.09, 0.05, (0.04, 0.04, 0.05), albedo=0.7), Cylinder(0.1, -0.07, (0.04, 0.04, 0.04), albedo=0.7)
    scene = Scene((*bracket, *others), PLACED, ambient=0.6)
    _, matches = (steps := Steps(method=Feature())).correspond(rectified(RIG, scene))
    poses = steps.locate(matches, RIG, 0)
    centres = scene.positions_m()
    volumes = np.array([np.prod(each) for each in (foot, wall)])
    whole = volumes @ centres[:2] / volumes.sum()
    near = np.linalg.norm(poses.xyz - whole, axis=1) < 0.05
    off = poses.xyz[near] - whole
    surprise = [each @ np.linalg.solve(spread, each) for each, spread in zip(off, poses.covariance[near])]
    assert max(surprise, default=0.0) < 16 and len(poses) == 2 + near.sum()


@pytest.mark.parametrize("yaw_rad", first_of(0.4, 0.2, 0.6, 0.9))
def test_a_cross_is_not_placed_surely_at_its_arms(yaw_rad: float) -> None:
    """Two bars that go through each other: where both are found, neither may take the other one's outline along."""
    long, thick, high = 0.05, 0.014, 0.03
    arm, off = (long - thick) / 2, (long + thick) / 4
    bar = Box(0.0, 0.0, (long, thick, high), yaw_rad=yaw_rad, albedo=0.7)
    arms = (
        Box(-side * np.sin(yaw_rad), side * np.cos(yaw_rad), (thick, arm, high), yaw_rad=yaw_rad, albedo=0.7)
        for side in (-off, off)
    )
    scene = Scene((bar, *arms), PLACED, ambient=0.6)
    _, matches = (steps := Steps(method=Feature())).correspond(rectified(RIG, scene))
    poses = steps.locate(matches, RIG, 0)
    off_m = poses.xyz - scene.positions_m()[0]
    surprise = [each @ np.linalg.solve(spread, each) for each, spread in zip(off_m, poses.covariance)]
    assert max(surprise, default=0.0) < 16
