"""A flat face that is refused may be the top of a body that stands beside a solid."""

from __future__ import annotations

from dataclasses import replace

import cv2
import numpy as np
import pytest
from outlines import disc
from rigs import RIGS

from stereo_pick.core.doubts.below_face import bodies_below
from stereo_pick.core.doubts.more_of_it import as_unsure_as_whole
from stereo_pick.core.matches.left_over import Unread
from stereo_pick.core.places.position import Located
from stereo_pick.core.shapes import SolidFit

RIG = RIGS["thesis"]
FOOT = SolidFit("box", np.array([0.0, 0.0, 0.89]), np.eye(3), np.array([0.05, 0.04, 0.02]), 0.1, np.eye(3) * 1e-8)
THIN_M = 0.001


def top(x_m: float, height_m: float, kind: str = "box") -> SolidFit:
    """A face, so high above where the foot ends, of which the middle is so far beside that of the foot."""
    centre_m = np.array([x_m, 0.0, 0.9 - height_m + THIN_M / 2])
    return replace(FOOT, kind=kind, centre_m=centre_m, size_m=np.array([0.012, 0.012, THIN_M]))


def unread(face: SolidFit, reason: str = "flat") -> Unread:
    left, right = (disc(*face.centre_px(camera), 3.0) for camera in (RIG.left, RIG.right))
    return Unread(reason, left, right, face)


@pytest.mark.parametrize("kind", ["box", "cylinder", "hexprism"])
def test_it_reaches_down_to_where_the_solid_ends(kind: str) -> None:
    face = top(0.031, 0.06, kind)
    whole = replace(face, centre_m=np.array([0.031, 0.0, 0.87]), size_m=np.array([0.012, 0.012, 0.06]))
    ((left, right),) = bodies_below([unread(face)], FOOT, RIG)
    for blob, camera in zip((left, right), (RIG.left, RIG.right)):
        own = float(cv2.contourArea(whole.silhouette_px(camera).astype(np.float32)))
        assert blob.area_px2 == pytest.approx(own, rel=0.05)


def test_what_is_no_higher_or_a_rod_or_refused_otherwise_is_none() -> None:
    rod = replace(top(0.031, 0.06), kind="cylinder", size_m=np.array([0.003, 0.003, 0.05]))
    others = [unread(top(0.031, 0.0)), unread(rod), unread(top(0.031, 0.06), "merged")]
    assert bodies_below(others, FOOT, RIG) == []


@pytest.mark.parametrize(("x_m", "is_piece"), [(0.031, True), (0.06, False)])
def test_an_angle_whose_wall_shows_its_top_alone_is_not_surely_its_foot(x_m: float, is_piece: bool) -> None:
    """The wall's side was as dark as the table, and its top, 30 mm above the foot's, no neighbour of that in a view."""
    left, right = (disc(*FOOT.centre_px(camera), 15.0) for camera in (RIG.left, RIG.right))
    row = (left, right), Located(FOOT.centre_px(RIG.left), FOOT.centre_px(RIG.right), 0.1, FOOT)
    ((_, where),) = as_unsure_as_whole([row], [], [unread(top(x_m, 0.05))], RIG, None)
    assert where.covariance.any() == is_piece


def test_a_ball_beside_the_top_of_another_part_is_no_piece_of_that() -> None:
    """A finger above it was refused as flat."""
    ball = replace(FOOT, kind="sphere", size_m=np.full(3, 0.05))
    left, right = (disc(*ball.centre_px(camera), 15.0) for camera in (RIG.left, RIG.right))
    row = (left, right), Located(ball.centre_px(RIG.left), ball.centre_px(RIG.right), 0.1, ball)
    ((_, where),) = as_unsure_as_whole([row], [], [unread(top(0.031, 0.05))], RIG, None)
    assert not where.covariance.any()
