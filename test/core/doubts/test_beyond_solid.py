"""What an outline shows beyond a solid."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from rendered_solids import PLACED, RIG, rectified
from rendering import Scene, Sphere

from stereo_pick.core.arrays import Floats
from stereo_pick.core.doubts.beyond_solid import (
    ends_within,
    goes_on_beyond,
    is_part_of,
    is_seen_alone,
    is_seen_to_be_more,
)
from stereo_pick.core.edges.hypotheses import Images
from stereo_pick.core.matches.left_over import Unread
from stereo_pick.core.objects import Blob
from stereo_pick.core.shapes import SolidFit
from stereo_pick.core.shapes.sight import seen_px

BALL = SolidFit("sphere", np.array([0.05, 0.0, 0.9]), np.eye(3), np.full(3, 0.04), 0.1, np.eye(3) * 1e-8)
CAMERAS = RIG.left, RIG.right
OUTLINES = [BALL.silhouette_px(camera) for camera in CAMERAS]


@pytest.fixture(scope="module")
def images() -> Images:
    return Images(rectified(RIG, Scene((Sphere(0.0, 0.0, (0.04,) * 3),), PLACED)))


def blob(side: int, by: float = 1.0, moved_px: float = 0.0, sharp: bool = True) -> Blob:
    """The ball's outline in a view, larger by so much, and moved."""
    middle: Floats = OUTLINES[side].mean(axis=0)
    contour = middle + by * (OUTLINES[side] - middle) + (moved_px, 0.0)
    return Blob(contour, 100.0, sharpness=np.full(len(contour), 1.0 if sharp else 0.0))


@pytest.mark.parametrize("side", [0, 1])
def test_an_object_goes_on_where_either_outline_is_sharp_clear_of_the_solid(images: Images, side: int) -> None:
    own, larger, fading = blob(1 - side), blob(side, by=1.5), blob(side, by=1.5, sharp=False)
    assert not goes_on_beyond((blob(0), blob(1)), BALL, images)
    for other, goes_on in ((larger, True), (fading, False)):
        pair = (other, own) if side == 0 else (own, other)
        assert goes_on_beyond(pair, BALL, images) is goes_on


@pytest.mark.parametrize(
    ("by", "moved_px", "is_it"),
    [(1.0, 0.0, True), (0.5, 5.0, True), (1.5, 0.0, False), (1.0, 100.0, False)],
    ids=["all of it", "a piece", "more", "beside it"],
)
@pytest.mark.parametrize("side", [0, 1])
def test_an_outline_of_one_view_is_the_solids_where_it_is_within_it(
    images: Images, side: int, by: float, moved_px: float, is_it: bool
) -> None:
    one = blob(side, by, moved_px)
    unread = Unread("merged", one, None) if side == 0 else Unread("merged", None, one)
    assert is_seen_alone(unread, BALL, images) is is_it


@pytest.mark.parametrize(
    ("by", "moved_px", "fault", "is_more"),
    [(1.5, 0.0, "", True), (1.5, 0.0, "merged", False), (1.0, 0.0, "", False), (1.0, 100.0, "", False)],
    ids=["more", "several", "all of it", "beside it"],
)
@pytest.mark.parametrize("side", [0, 1])
def test_a_solid_is_a_piece_where_one_view_has_one_object_whole_that_is_more(
    images: Images, side: int, by: float, moved_px: float, fault: str, is_more: bool
) -> None:
    one = replace(blob(side, by, moved_px), fault=fault)
    unread = Unread("left_only", one, None) if side == 0 else Unread("right_only", None, one)
    assert is_seen_to_be_more(unread, BALL, images) is is_more
    assert not is_seen_to_be_more(Unread("other_shape", one, one), BALL, images)


@pytest.mark.parametrize(("by", "is_it"), [(1.0, True), (1.5, False)])
def test_an_outline_of_which_no_edge_was_measured_counts_wherever_it_goes(
    images: Images, by: float, is_it: bool
) -> None:
    """As what is too faint, or cut off by the border; sharpness of no points ended in a traceback."""
    unread = Unread("faint", replace(blob(0, by), sharpness=np.zeros(0)), None)
    assert is_seen_alone(unread, BALL, images) is is_it


def test_what_both_views_show_is_not_seen_alone(images: Images) -> None:
    assert not is_seen_alone(Unread("merged", blob(0), blob(1)), BALL, images)


@pytest.mark.parametrize(
    ("by", "moved_px", "is_it"),
    [(1.0, 0.0, True), (0.5, 5.0, True), (1.5, 0.0, False), (1.0, 100.0, False)],
    ids=["all of it", "a piece", "more", "beside it"],
)
def test_what_both_views_show_is_part_of_the_solid_where_it_is_within_it(
    images: Images, by: float, moved_px: float, is_it: bool
) -> None:
    assert is_part_of(Unread("merged", blob(0, by, moved_px), blob(1, by, moved_px)), BALL, images) is is_it
    assert is_part_of(Unread("merged", blob(0, by, moved_px), None), BALL, images) is is_it


def box_of(images: Images) -> tuple[SolidFit, list[Floats]]:
    """A box, and what both views show of the top of an angle that has two of its sides."""
    half_m = np.array([0.03, 0.025, 0.02])
    rotation = np.diag([1.0, -1.0, -1.0])
    fit = SolidFit("box", np.array([0.05, 0.0, 0.9]), rotation, 2 * half_m, 0.1, np.eye(3) * 1e-8)
    corners = np.array([(-1, -1), (1, -1), (1, -0.4), (-0.4, -0.4), (-0.4, 1), (-1, 1)])
    top_m = fit.centre_m + (np.c_[corners, np.ones(6)] * half_m) @ rotation.T
    return fit, [dense(seen_px(top_m, camera)) for camera in CAMERAS]


def dense(corners_px: Floats) -> Floats:
    ahead = np.roll(corners_px, -1, axis=0)
    return np.concatenate([a + np.linspace(0, 1, 40)[:, None] * (b - a) for a, b in zip(corners_px, ahead)])


def test_an_angle_ends_within_the_box_around_it_and_its_lit_top_along_its_creases(images: Images) -> None:
    fit, angle_px = box_of(images)
    corners_m = np.array([(-1, -1, 1), (1, -1, 1), (1, 1, 1), (-1, 1, 1)]) * fit.size_m / 2
    tops_px = [dense(seen_px(fit.centre_m + corners_m @ fit.rotation.T, camera)) for camera in CAMERAS]
    for outlines_px, sharpness, ends in ((angle_px, 1.0, True), (angle_px, 0.0, False), (tops_px, 1.0, False)):
        left, right = (Blob(each, 100.0, sharpness=np.full(len(each), sharpness)) for each in outlines_px)
        assert ends_within((left, right), fit, images) is ends


def test_light_that_ends_on_a_round_face_is_no_end_of_the_part(images: Images) -> None:
    lit = [0.6 * (outline - outline.mean(axis=0)) + outline.mean(axis=0) for outline in OUTLINES]
    left, right = (Blob(each, 100.0, sharpness=np.ones(len(each))) for each in lit)
    assert not ends_within((left, right), BALL, images)
