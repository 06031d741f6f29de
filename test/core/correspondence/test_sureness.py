"""How sure positions are: where all edges together move the table by more than it was known, and of unknown shapes."""

from __future__ import annotations

import numpy as np
import pytest
from family_scenes import found
from hypothesis import given
from hypothesis import strategies as st
from marks import more
from outlines import disc
from rendering import Box, Scene, render_with_truth
from rendering.rigs import table_before
from rigs import RIGS

from stereo_pick.core.correspondence.sureness import seen_in_part, table_moved_m
from stereo_pick.core.pipeline import Pipeline, Steps
from stereo_pick.core.places.position import Located
from stereo_pick.core.shapes import SolidFit
from stereo_pick.core.shapes.table import Table

RIG = RIGS["thesis"]
FACING = np.array([0.0, 0.0, -1.0])


def balls(*places_m: tuple[float, float, float]) -> list[SolidFit]:
    return [SolidFit("sphere", np.array(each), np.eye(3), np.full(3, 0.04), 0.1, np.eye(3) * 1e-8) for each in places_m]


@given(st.floats(-0.01, 0.01))
def test_a_table_that_moves_by_more_than_two_of_its_sigmas_is_doubted_by_as_much(moved_m: float) -> None:
    before, after = Table(FACING, 0.9, 1e-3), Table(FACING, 0.9 + moved_m, 2e-4)
    (found_m,) = table_moved_m(balls((0.1, 0.0, 0.88)), before, after)
    if abs(moved_m) < 1.99e-3:
        assert found_m == 0
    if abs(moved_m) > 2.01e-3:
        assert found_m == pytest.approx(moved_m)


@pytest.mark.parametrize(("tilt_deg", "is_doubted"), [(0.5, False), (0.9, False), (1.3, True), (3.0, True)])
def test_a_tilt_is_doubted_for_all_if_it_is_for_one(tilt_deg: float, is_doubted: bool) -> None:
    """Half a degree is a sigma: the outer ones are moved most, and the middle one not at all."""
    tilt = np.deg2rad(tilt_deg)
    before = Table(FACING, 0.9, 1e-5)
    after = Table(np.array([np.sin(tilt), 0.0, -np.cos(tilt)]), 0.9 * float(np.cos(tilt)), 2e-4)
    moved_m = table_moved_m(balls((-0.2, 0.0, 0.9), (0.0, 0.0, 0.9), (0.2, 0.0, 0.9)), before, after)
    assert (moved_m != 0).any() == is_doubted
    if is_doubted:
        np.testing.assert_allclose(moved_m, np.sin(tilt) * np.array([-0.2, 0.0, 0.2]), atol=1e-6)


def test_without_a_table_none_has_moved() -> None:
    assert not table_moved_m(balls((0.0, 0.0, 0.9)), None, Table(FACING, 0.9, 1e-3)).any()


@pytest.mark.parametrize("radius_px", [10.0, 30.0])
@pytest.mark.parametrize("height_m", [None, 0.01, 0.5])
def test_the_centre_of_an_unknown_shape_is_anywhere_within_its_width(radius_px: float, height_m: float | None) -> None:
    """Or down to the half of its height: a top that is 10 mm above a table has its part's centre 5 mm below it."""
    ball = balls((0.05, 0.0, 0.9))[0]
    blobs = disc(*ball.centre_px(RIG.left), radius_px), disc(*ball.centre_px(RIG.right), radius_px)
    row = blobs, Located(ball.centre_px(RIG.left), ball.centre_px(RIG.right), 0.1, None)
    table = Table(FACING, 0.9 + height_m, 1e-3) if height_m else None
    _, where = seen_in_part(row, RIG, table)
    width_m = 2 * radius_px * 0.9 / RIG.focal_px
    assert where.covariance == pytest.approx(min(width_m, height_m or width_m) ** 2 / 12 * np.eye(3), rel=0.1)


def test_a_box_alone_that_is_seen_as_a_cylinder_without_ends_says_that_it_is_unsure() -> None:
    """Its sides are a little brighter than the table, and no table is known: it was 11 mm off, and sure of it."""
    box = Box(0.0753, -0.0021, (0.01931, 0.02563, 0.02205), yaw_rad=-0.0162, albedo=0.522)
    scene = Scene((box,), table_before(RIG, 0.9, 76.423), table_albedo=0.26983, ambient=0.57296)
    frame, truth = render_with_truth(RIG, scene, seed=0)
    poses = Pipeline(RIG, Steps()).run(frame).poses
    off_m = np.linalg.norm(poses.xyz - truth.centres_m[0], axis=1)
    assert (poses.confidence[off_m > 5e-3] < 0.5).all()


@more
def test_what_is_wrong_says_so() -> None:
    """A box of unknown shape, 18 mm off."""
    result = found("labels", 12)
    assert result.wrong >= 1 and result.unadmitted == 0
