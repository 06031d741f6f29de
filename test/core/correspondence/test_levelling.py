"""A right camera that has turned since its calibration: its turn is found in the outlines, undone and told."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from outlines import seen
from rendered_solids import PLACED, centre_m
from rendered_solids import RIG as RENDERED
from rendering import Box, Cylinder, Scene, Sensor, Sphere, render
from rigs import rotation
from solid_outlines import Part, contour_px
from solids_on_table import MIXED, RIG, Standing, part_on_table

from stereo_pick.core.arrays import Floats
from stereo_pick.core.correspondence.correspondences import Correspondences, Match, collect
from stereo_pick.core.correspondence.levelling import turn_of
from stereo_pick.core.correspondence.method import Method
from stereo_pick.core.frames import RectifiedPair
from stereo_pick.core.objects import Blob, Blobs
from stereo_pick.core.pipeline import Pipeline, Result, Steps
from stereo_pick.core.places.extent import Extent
from stereo_pick.core.rig import StereoRig
from stereo_pick.core.transform import Transform

EYE_M = np.array([RIG.baseline_m, 0.0, 0.0])
EMPTY = np.zeros(RIG.right.frame_size[::-1], np.uint8)

turns_rad = st.floats(-0.0015, 0.0015)


def blobs_of(turn_rad: Sequence[float], parts: Sequence[Standing] = tuple(MIXED)) -> Blobs:
    """Exact outlines of parts before a right camera that has turned about all its axes."""
    solids = [part_on_table(50.0, each) for each in parts]
    left = [_blob(contour_px(part.seen_from(np.zeros(3)), RIG.left)) for part in solids]
    return seen(left, [_blob(_turned_px(part, turn_rad)) for part in solids])


def _turned_px(part: Part, turn_rad: Sequence[float]) -> Floats:
    return contour_px(part.seen_from(EYE_M) @ rotation(turn_rad), RIG.right)


def _blob(contour: Floats) -> Blob:
    return Blob(contour, contrast=100.0)


def rows_apart_px(blobs: Blobs) -> Floats:
    """By how many rows tops and bottoms of the outlines differ."""
    return np.abs(np.subtract([each.rows_px for each in blobs.left], [each.rows_px for each in blobs.right]))


@given(turns_rad, turns_rad)
def test_a_turn_is_found_and_undone(pitch_rad: float, roll_rad: float) -> None:
    blobs = blobs_of((pitch_rad, 0.0, roll_rad))
    before_px = rows_apart_px(blobs)
    turn = turn_of(blobs, RIG)
    if turn is None:
        assert before_px.mean() < 0.2  # less than noise may do
        return
    assert turn.offset_px == pytest.approx(np.sqrt((before_px**2).mean()), abs=0.1)
    pair, level = turn.undone(RectifiedPair(EMPTY, EMPTY, RIG), blobs)
    assert rows_apart_px(level).max() < 0.08
    assert pair.rig is RIG


def test_what_is_undone_lies_where_it_was_before_the_turn() -> None:
    """Also along the rows, where roll moves what is high or low in the view."""
    before, turned = blobs_of((0, 0, 0)), blobs_of((0.001, 0, 0.0015))
    turn = turn_of(turned, RIG)
    assert turn is not None
    _, level = turn.undone(RectifiedPair(EMPTY, EMPTY, RIG), turned)
    for one, other, off in zip(before.right, level.right, turned.right):
        np.testing.assert_allclose(other.centroid_px, one.centroid_px, atol=0.1)
        assert np.linalg.norm(off.centroid_px - one.centroid_px) > 0.5


@pytest.mark.parametrize("seed", range(20))
def test_noise_of_light_is_no_turn(seed: int) -> None:
    random = np.random.default_rng(seed)
    blobs = blobs_of((0, 0, 0))
    right = [replace(blob, contour_px=_stretched(blob.contour_px, random.normal(0, 0.1, 2))) for blob in blobs.right]
    assert turn_of(replace(blobs, right=tuple(right)), RIG) is None


def _stretched(contour_px: Floats, by_px: Floats) -> Floats:
    """With its top and its bottom moved by so many rows."""
    top, bottom = contour_px[:, 1].min(), contour_px[:, 1].max()
    moved = contour_px.copy()
    moved[:, 1] += np.interp(contour_px[:, 1], (top, bottom), by_px)
    return moved


def test_one_part_in_another_light_does_not_hide_a_turn() -> None:
    turned = blobs_of((0.001, 0, 0))
    odd = replace(turned.right[0], contour_px=_stretched(turned.right[0].contour_px, np.array([2.0, -2.0])))
    turn = turn_of(replace(turned, right=(odd, *turned.right[1:])), RIG)
    assert turn is not None
    assert (turn.pitch_rad, turn.roll_rad) == (pytest.approx(0.001, abs=1e-4), pytest.approx(0, abs=3e-4))


def test_a_few_parts_that_are_off_alike_are_no_turn_of_the_camera() -> None:
    whole, turned = blobs_of((0, 0, 0)), blobs_of((0.001, 0, 0))
    assert turn_of(replace(whole, right=(*turned.right[:1], *whole.right[1:])), RIG) is None


@pytest.mark.parametrize("ends_px", [[(0.5, 3.0), (-3.0, 0.5)], [(0.5, 3.0), (0.5, -3.0)]])
def test_two_ends_of_two_parts_tell_no_turn(ends_px: Sequence[tuple[float, float]]) -> None:
    """Of two unknowns: one end each agrees on one whatever it is, as half-lit parts have it."""
    whole = blobs_of((0, 0, 0), MIXED[:2])
    moved_px = [_stretched(each.contour_px, np.array(by)) for each, by in zip(whole.right, ends_px)]
    right = [replace(each, contour_px=contour) for each, contour in zip(whole.right, moved_px)]
    assert turn_of(replace(whole, right=tuple(right)), RIG) is None


@pytest.mark.parametrize("part", MIXED)
def test_a_lone_part_tells_of_pitch(part: Standing) -> None:
    turn = turn_of(blobs_of((0.001, 0, 0), [part]), RIG)
    assert turn is not None and turn.offset_px == pytest.approx(0.001 * RIG.focal_px, rel=0.15)


def test_ends_that_fade_or_are_cut_say_nothing() -> None:
    turned = blobs_of((0.001, 0, 0))
    faded = [replace(blob, sharpness=np.zeros(len(blob.contour_px))) for blob in turned.left]
    assert turn_of(replace(turned, left=tuple(faded)), RIG) is None


def test_nothing_seen_is_no_turn() -> None:
    assert turn_of(seen([], []), RIG) is None


SCENE = Scene(
    (
        Cylinder(-0.16, 0.03, (0.04, 0.04, 0.05)),
        Box(0.15, -0.02, (0.05, 0.036, 0.045), yaw_rad=0.4),
        Sphere(0.02, 0.09, (0.04, 0.04, 0.04)),
        Cylinder(0.0, -0.08, (0.03, 0.03, 0.06), yaw_rad=0.5, lying=True),
    ),
    PLACED,
    ambient=0.6,
)


def located(turn_rad: Sequence[float]) -> tuple[Result, Floats]:
    """What becomes of a scene when the calibration is from before the right camera has turned so, and the truth."""
    sensor = Sensor(noise_dn=1.0)
    frame = render(RENDERED, SCENE, sensor, sensor, seed=0)
    turned = Transform(rotation(turn_rad), np.zeros(3)) @ RENDERED.right_T_left
    stale = StereoRig.from_extrinsics(RENDERED.left, RENDERED.right, turned)
    truth = np.array([RENDERED.left.R.T @ centre_m(RENDERED, SCENE, part) for part in SCENE.solids])
    return Pipeline(stale, Steps()).run(frame), truth


@pytest.mark.parametrize("turn_rad", [(0.0008, 0, 0), (-0.0012, 0, 0), (0, 0, 0.0015), (0.0005, 0, -0.001)])
def test_positions_hardly_suffer_and_the_covariance_knows(turn_rad: Sequence[float]) -> None:
    result, truth = located(turn_rad)
    poses, told_px = result.poses, result.correspondences.turned_px
    nearest = np.linalg.norm(poses.xyz[:, None] - truth, axis=2).argmin(axis=1)
    assert sorted(nearest) == [0, 1, 2, 3]
    error_m = poses.xyz - truth[nearest]
    depth_m = error_m[:, 2] - error_m[:, 2].mean()
    assert np.linalg.norm(error_m, axis=1).max() < 0.0012 and np.abs(depth_m).max() < 0.0006
    off = np.einsum("ni,nij,nj->n", error_m, np.linalg.inv(poses.covariance), error_m)
    assert off.max() < 7.8
    assert 0.1 < told_px < 2.0 and "calibrate again" in result.correspondences.notice


def test_cameras_that_stand_as_calibrated_are_told_nothing_of() -> None:
    result, _ = located((0, 0, 0))
    assert result.correspondences.turned_px == 0 and result.correspondences.notice == ""


def test_a_turn_after_which_depths_are_anybodys_guess_is_refused() -> None:
    result, _ = located((0, 0, 0.004))
    assert len(result.poses) == 0
    assert {(each.reason, each.detail) for each in result.poses.refused} == {("misaligned", "turned by 0.23 deg")}


@dataclass(frozen=True)
class Explaining(Method):
    """Explains all outlines by solids but those that were moved, of which it leaves out so many."""

    left_out: int = 0
    as_seen: Blobs | None = None

    def match(self, pair: RectifiedPair, blobs: Blobs) -> Correspondences:
        """As many matches as outlines, the first of which are of no known shape where they were moved."""
        open_ = self.left_out if blobs is not self.as_seen else 0
        solid = Extent("box", np.eye(3), np.full(3, 0.04))
        extents = [None if i < open_ else solid for i in range(len(blobs.left))]
        places = [(left.centroid_px, right.centroid_px) for left, right in zip(blobs.left, blobs.right)]
        return collect([Match(*px, (0.1, 0.1), (9.0, 9.0), 0.0, extent) for px, extent in zip(places, extents)], [])


@pytest.mark.parametrize(("turn_rad", "told"), [((0.001, 0, 0.0005), True), ((0, 0, 0.004), False)])
@pytest.mark.parametrize("left_out", [0, 1, 3])
def test_after_what_is_no_turn_solids_would_explain_less(turn_rad: Sequence[float], told: bool, left_out: int) -> None:
    """Ends of shadows can lie as if a camera had turned; whole outlines cannot."""
    blobs = blobs_of(turn_rad)
    steps = Steps(method=Explaining(left_out=left_out, as_seen=blobs))
    found = steps.matched(RectifiedPair(EMPTY, EMPTY, RIG), blobs)
    assert turn_of(blobs, RIG) is not None
    assert (found.turned_px > 0) == (told and not left_out)
    assert len(found) == (0 if not told and not left_out else len(blobs.left))
    assert {each.reason for each in found.refused} == (set() if len(found) else {"misaligned"})
