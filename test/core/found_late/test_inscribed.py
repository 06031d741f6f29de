"""Discs inscribed in outlines of several things: exact geometry of the outlines' own."""

from __future__ import annotations

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from outlines import PARALLEL, disc

from stereo_pick.core.arrays import Floats
from stereo_pick.core.found_late.inscribed import Disc, discs_within
from stereo_pick.core.matches.left_over import Unread
from stereo_pick.core.objects import Blob
from stereo_pick.core.shapes import SolidFit

RIG = PARALLEL
FOCAL_PX, CENTRE_PX = RIG.focal_px, RIG.left.P[:2, 2]


def ball(left_px: Floats, radius_px: float, depth_m: float = 0.8) -> SolidFit:
    """One that the left camera sees about there and so large."""
    centre_m = np.append((left_px - CENTRE_PX) / FOCAL_PX, 1.0) * depth_m
    size_m = np.full(3, 2 * radius_px / FOCAL_PX * depth_m)
    return SolidFit("sphere", centre_m, np.eye(3), size_m, 0.05, 1e-9 * np.eye(3))


def dumbbell(one: tuple[float, float, float], other: tuple[float, float, float]) -> Blob:
    """The outline of two discs (x, y, radius) [px] and a strip, 8 px wide, from one to the other."""
    there = np.zeros((480, 640), np.uint8)
    for x, y, radius in (one, other):
        cv2.circle(there, (round(x), round(y)), round(radius), 1, cv2.FILLED)
    cv2.line(there, (round(one[0]), round(one[1])), (round(other[0]), round(other[1])), 1, 8)
    (contour,), _ = cv2.findContours(there, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
    return Blob(contour[:, 0].astype(np.float64), 100.0, fault="merged", sharpness=np.ones(len(contour)))


@given(
    x=st.floats(120, 300),
    y=st.floats(120, 300),
    radius_px=st.floats(20, 60),
    part=st.floats(0.6, 0.95),
    is_left=st.booleans(),
)
def test_each_of_two_discs_in_one_outline_is_one(
    x: float, y: float, radius_px: float, part: float, is_left: bool
) -> None:
    larger, smaller = (x, y, radius_px), (x + 2.5 * radius_px, y + 10, part * radius_px)
    outline = dumbbell(larger, smaller)
    unread = Unread("merged", outline if is_left else None, None if is_left else outline)
    found = discs_within([unread], [], RIG)
    for each, (x_px, y_px, r_px) in zip(found, (larger, smaller)):
        np.testing.assert_allclose(each.centre_px, (x_px, y_px), atol=3)
        assert each.radius_px == pytest.approx(r_px, abs=3)
        assert each.view == (0 if is_left else 1)
        own, other = (each.unread.left, each.unread.right) if is_left else (each.unread.right, each.unread.left)
        assert own is not None and other is None
        np.testing.assert_allclose(own.centroid_px, each.centre_px, atol=1e-6)
    assert [each.radius_px for each in found] == sorted((each.radius_px for each in found), reverse=True)


def test_what_is_known_is_none_of_it() -> None:
    outline = dumbbell((200, 200, 40), (310, 200, 30))
    unread = [Unread("merged", outline, outline)]
    free = discs_within(unread, [], RIG)[0]
    np.testing.assert_allclose(free.centre_px, (200, 200), atol=2)
    first, *rest = discs_within(unread, [ball(np.array([200.0, 200.0]), 42)], RIG)
    np.testing.assert_allclose(first.centre_px, (310, 200), atol=2)
    assert all(np.linalg.norm(each.centre_px - (200, 200)) > 42 for each in rest)


def test_crumbs_and_what_is_refused_for_good_hold_none() -> None:
    assert discs_within([Unread("merged", disc(200, 200, 5.0), None)], [], RIG) == []
    assert discs_within([Unread("ambiguous", disc(200, 200, 40.0), disc(150, 200, 40.0))], [], RIG) == []


def test_of_many_outlines_the_largest_discs_are_looked_at() -> None:
    unread = [Unread("merged", disc(60 + 40 * i, 200 + 5 * i, 8.0 + i), None) for i in range(12)]
    found = discs_within(unread, [], RIG)
    assert len(found) < len(unread)
    assert min(each.radius_px for each in found) > 10


@pytest.mark.parametrize(
    ("at_px", "radius_px", "is_filled"),
    [((300, 240), 30, True), ((300, 240), 42, True), ((300, 240), 20, False), ((20, 240), 30, False)],
)
def test_a_solid_fills_a_disc_if_it_is_as_large_and_both_views_show_all_of_it(
    at_px: tuple[float, float], radius_px: float, is_filled: bool
) -> None:
    there = Disc(disc(*at_px, 28.0), 0, np.array(at_px, float), 28.0)
    assert there.is_filled_by(ball(there.centre_px, radius_px), RIG) is is_filled
