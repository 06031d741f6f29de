"""An outline of one view, where the other one would have it: exact geometry before random rigs."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from outlines import PARALLEL, disc
from rendered_solids import table_of
from rendering.rigs import table_before
from rigs import RIGS

from stereo_pick.core.arrays import Floats
from stereo_pick.core.found_late.carried import as_predicted, carried
from stereo_pick.core.matches.left_over import Unread
from stereo_pick.core.objects import Blob
from stereo_pick.core.objects.blob import CUT
from stereo_pick.core.rig import StereoRig
from stereo_pick.core.shapes import SolidFit
from stereo_pick.core.shapes.table import Table

RIG = RIGS["thesis"]


def table_seen_from(rig: StereoRig, elevation_deg: float) -> Table:
    return table_of(rig, table_before(rig, 0.9, elevation_deg=elevation_deg))


def points_m(rig: StereoRig, left: Blob, right: Blob) -> Floats:
    """The points (N, 3) [m] of which two outlines of as many points are the images."""
    focal, (cx, cy) = rig.focal_px, rig.left.P[:2, 2]
    disparity_px = left.contour_px[:, 0] - cx - (right.contour_px[:, 0] - rig.right.P[0, 2])
    assert np.allclose(left.contour_px[:, 1], right.contour_px[:, 1])  # on the same rows
    depth_m = focal * rig.baseline_m / disparity_px
    return np.column_stack([(left.contour_px - (cx, cy)) / focal * depth_m[:, None], depth_m])


@given(
    name=st.sampled_from(sorted(RIGS)),
    elevation_deg=st.floats(30, 90),
    radius_px=st.floats(8, 60),
    is_left=st.booleans(),
)
def test_it_lies_level_as_high_as_half_its_width_on_the_table(
    name: str, elevation_deg: float, radius_px: float, is_left: bool
) -> None:
    rig = RIGS[name]
    table = table_seen_from(rig, elevation_deg)
    foot_m = np.array([0.0, 0.0, table.offset_m / -table.normal[2]])  # where the left camera looks
    at_px = foot_m[0] * rig.focal_px / foot_m[2] + rig.left.P[:2, 2]
    away_px = rig.baseline_m * rig.focal_px / foot_m[2]
    middle = at_px if is_left else at_px + (rig.right.P[0, 2] - rig.left.P[0, 2] - away_px, 0)
    blob = disc(*middle, radius_px)
    pair = carried(Unread("merged", blob if is_left else None, None if is_left else blob), rig, table)
    assume(pair is not None)  # the other camera looks there
    assert pair is not None
    assert pair[0 if is_left else 1] is blob and (pair[1 if is_left else 0].sharpness == CUT).all()
    points = points_m(rig, *pair)
    height_m = table.height_m(points)
    assert np.ptp(height_m) < 1e-9
    eye_up_m = float(table.height_m(rig.eyes_m[0 if is_left else 1]))
    on_table_m = float(np.median(points[:, 2])) * eye_up_m / (eye_up_m - height_m[0])  # as far as rays reach down there
    assert height_m[0] == pytest.approx(radius_px / rig.focal_px * on_table_m, rel=0.01)


def test_what_both_views_show_is_not_carried() -> None:
    assert carried(Unread("merged", disc(300, 200), disc(250, 200)), RIG, table_seen_from(RIG, 50)) is None


@pytest.mark.parametrize("is_left", [True, False])
def test_where_the_other_camera_does_not_look_nothing_is_carried(is_left: bool) -> None:
    width, height = PARALLEL.left.frame_size
    blob = disc(5.0 if is_left else width - 5.0, height / 2)
    unread = Unread("merged", blob, None) if is_left else Unread("merged", None, blob)
    assert carried(unread, PARALLEL, table_seen_from(PARALLEL, 50)) is None


def test_what_reaches_above_the_horizon_of_the_table_is_not_carried() -> None:
    low = Table(np.array([0.0, -np.sqrt(1 - 0.1**2), -0.1]), 0.3, 1e-3)
    horizon_px = float(RIG.left.P[1, 2] - 0.1 / np.sqrt(1 - 0.1**2) * RIG.focal_px)
    blob = disc(300.0, horizon_px, 30.0)
    assert carried(Unread("left_only", blob, None), RIG, low) is None


def test_what_is_as_high_as_the_camera_is_not_carried() -> None:
    straight_down = Table(np.array([0.0, 0.0, -1.0]), 0.5, 1e-3)
    blob = disc(*RIG.left.P[:2, 2], 1.05 * RIG.focal_px)
    assert carried(Unread("left_only", blob, None), RIG, straight_down) is None


@pytest.mark.parametrize("is_left", [True, False])
def test_once_its_solid_is_found_it_is_the_solids_silhouette(is_left: bool) -> None:
    ball = SolidFit("sphere", np.array([0.05, 0.0, 0.9]), np.eye(3), np.full(3, 0.04), 0.1, np.eye(3) * 1e-8)
    blobs = disc(300, 200), disc(200, 200)
    unread = Unread("merged", blobs[0], None) if is_left else Unread("merged", None, blobs[1])
    pair = as_predicted(unread, blobs, ball, RIG)
    own, other = (0, 1) if is_left else (1, 0)
    assert pair[own] is blobs[own]
    camera = (RIG.left, RIG.right)[other]
    assert np.allclose(pair[other].centroid_px, ball.centre_px(camera), atol=0.5)
    assert len(pair[other].sharpness) == len(pair[other].contour_px)
