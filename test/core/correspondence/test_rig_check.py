"""Exchanged images and a wrong calibration are noticed by the objects alone."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from outlines import PARALLEL, seen
from rendering import Scene, balls, render
from rigs import RIGS, rotation

from stereo_pick.core.arrays import Image
from stereo_pick.core.correspondence.rig_check import rig_fault
from stereo_pick.core.frames import RectifiedPair, StereoFrame
from stereo_pick.core.objects import Blob, Blobs, Detector
from stereo_pick.core.pipeline import Steps
from stereo_pick.core.rectification import Rectifier
from stereo_pick.core.refusal import RIG_FAULTS
from stereo_pick.core.rig import StereoRig
from stereo_pick.core.transform import Transform

SCENES = {
    "several": balls((-0.07, -0.03, 0.04), (0.0, 0.04, 0.05), (0.06, -0.02, 0.045)),
    "alike": balls((-0.06, 0.0, 0.04), (0.0, 0.0, 0.04), (0.06, 0.0, 0.04)),
    "one": balls((0.02, 0.03, 0.05)),
}


@cache
def rendered(rig_name: str, scene_name: str) -> StereoFrame:
    return render(RIGS[rig_name], Scene(SCENES[scene_name]))


def fault(rig: StereoRig, left: Image, right: Image) -> str:
    return rig_fault(Detector().detect(Rectifier(rig).rectify(StereoFrame(left, right))), rig)


@pytest.mark.parametrize("scene_name", SCENES)
@pytest.mark.parametrize("rig_name", RIGS)
def test_images_in_their_order_are_not_taken_for_exchanged(rig_name: str, scene_name: str) -> None:
    frame = rendered(rig_name, scene_name)
    assert fault(RIGS[rig_name], frame.left, frame.right) == ""


@pytest.mark.parametrize("scene_name", SCENES)
@pytest.mark.parametrize("rig_name", ["verged", "parallel", "rolled", "thesis"])
def test_exchanged_images_are_noticed(rig_name: str, scene_name: str) -> None:
    frame = rendered(rig_name, scene_name)
    assert fault(RIGS[rig_name], frame.right, frame.left) == "swapped"


def test_nothing_seen_says_nothing() -> None:
    assert rig_fault(seen([], []), RIGS["verged"]) == ""


@pytest.mark.parametrize("pitch_deg", [-1.0, 1.0])
@pytest.mark.parametrize("rig_name", ["verged", "parallel", "thesis"])
def test_nothing_is_believed_when_the_right_camera_has_tilted(rig_name: str, pitch_deg: float) -> None:
    rig = RIGS[rig_name]
    tilt = Transform(rotation((np.deg2rad(pitch_deg), 0, 0)), np.zeros(3))
    stale = StereoRig.from_extrinsics(rig.left, rig.right, tilt @ rig.right_T_left)
    frame = rendered(rig_name, "several")
    assert fault(stale, frame.left, frame.right) in RIG_FAULTS


Ends = tuple[float, float]
"""The rows at which an outline begins and ends [px]."""

WHOLE: tuple[Ends, ...] = ((60, 130), (120, 180), (200, 290), (240, 300), (330, 400))


def outline(column_px: float, ends: Ends) -> Blob:
    top, bottom = ends
    return Blob(np.array([(column_px - 25, top), (column_px + 25, top), (column_px, bottom)]), contrast=100.0)


def fault_of(left: Sequence[Ends], right: Sequence[Ends], faults: str = "") -> str:
    one, other = (
        [replace(outline(80 + 100 * i - shift_px, ends), fault=faults) for i, ends in enumerate(side)]
        for shift_px, side in ((0, left), (30, right))
    )
    return rig_fault(seen(one, other), PARALLEL)


@pytest.mark.parametrize("faults", ["", "merged"])
@pytest.mark.parametrize("seed", range(8))
def test_outlines_cut_short_or_drawn_out_at_one_end_each_are_no_sign_of_a_moved_camera(seed: int, faults: str) -> None:
    random = np.random.default_rng(seed)
    at_top, by_px = random.random(len(WHOLE)) < 0.5, random.uniform(-25, 25, len(WHOLE))
    right = [(a + by * top, b + by * (not top)) for (a, b), top, by in zip(WHOLE, at_top, by_px)]
    assert fault_of(WHOLE, right, faults) == ""


def test_prints_that_look_different_from_two_sides_do_not_outweigh_parts_that_fit() -> None:
    """Unless the parts do not fit either."""
    outlines_of = [[outline(80 + 100 * i - by, ends) for i, ends in enumerate(WHOLE)] for by in (0, 30)]
    prints = [replace(outline(300, (a + 100 * i, b + 100 * i)), fault="merged") for i, (a, b) in enumerate(WHOLE)]
    others = [replace(outline(270, (a + 20, b + 45)), fault="merged") for a, b in WHOLE]
    left, right = outlines_of[0][:2], outlines_of[1][:2]
    assert rig_fault(seen(left + prints[:3], right + others[:3]), PARALLEL) == ""
    assert rig_fault(seen(left[:1] + prints[:3], right[:1] + others[:3]), PARALLEL) == "misaligned"
    assert rig_fault(seen(left + prints[:3], outlines_of[1][2:4] + others[:3]), PARALLEL) == "misaligned"


SHADOWS: tuple[tuple[Ends, ...], ...] = (((60, 130), (200, 290)), ((75, 160), (215, 240)))


def moved(which: int, by_px: float) -> Ends:
    top, bottom = WHOLE[which]
    return top + by_px, bottom + by_px


def shadows() -> Blobs:
    """Two, in which the views differ."""
    sides = [[replace(outline(80 + 100 * i, ends), fault="merged") for i, ends in enumerate(side)] for side in SHADOWS]
    return seen(*sides)


@pytest.mark.parametrize("by_px", [-40.0, -8.0, -3.0, -2.0, 2.0, 3.0, 8.0, 40.0])
def test_outlines_that_are_all_off_to_one_side_are(by_px: float) -> None:
    random = np.random.default_rng(1)
    right = [(a + by_px + random.normal(0, 0.2), b + by_px + random.normal(0, 0.2)) for a, b in WHOLE]
    assert fault_of(WHOLE, right) == "misaligned"


def test_outlines_that_are_off_to_both_sides_a_little_are_not() -> None:
    right = [(a + by, b + by) for (a, b), by in zip(WHOLE, (-1.9, 1.6, 0.2, 1.8, -1.7))]
    assert fault_of(WHOLE, right) == ""


@pytest.mark.parametrize("pitch_deg", [-0.25, 0.25])
@pytest.mark.parametrize("rig_name", ["verged", "parallel", "thesis"])
def test_a_tilt_by_a_few_pixels_is_noticed(rig_name: str, pitch_deg: float) -> None:
    rig = RIGS[rig_name]
    assert 2 < rig.focal_px * np.deg2rad(abs(pitch_deg)) < 6
    tilt = Transform(rotation((np.deg2rad(pitch_deg), 0, 0)), np.zeros(3))
    stale = StereoRig.from_extrinsics(rig.left, rig.right, tilt @ rig.right_T_left)
    frame = rendered(rig_name, "several")
    assert fault(stale, frame.left, frame.right) in RIG_FAULTS


def upright(x_px: float, top_px: float, height_px: float) -> Blob:
    """A tall outline, or the upper part of one."""
    corners = [(-20, 0), (20, 0), (20, height_px), (-20, height_px)]
    return Blob(np.array(corners, np.float64) + (x_px, top_px), 100.0)


@pytest.mark.parametrize(("shown_px", "expected"), [(20.0, ""), (12.0, "misaligned")])
def test_the_top_of_a_tall_part_fits_the_whole_of_it_in_the_other_view(shown_px: float, expected: str) -> None:
    """One of two parts of which the left view shows no more."""
    left = [upright(300, 100, 85), upright(420, 260, shown_px)]
    right = [upright(240, 100, 85), upright(360, 260, 85)]
    assert rig_fault(seen(left, right), PARALLEL) == expected


@pytest.mark.parametrize(("fault", "expected"), [("merged", ""), ("", "misaligned")])
def test_an_outline_of_several_fits_each_of_them_in_the_other_view(fault: str, expected: str) -> None:
    """However much larger it is, if it begins or ends where one of them does."""
    left = [upright(80, 100, 60), replace(upright(300, 200, 260), fault=fault)]
    right = [upright(50, 100, 60), upright(270, 200, 40), upright(240, 262, 45), upright(280, 330, 50)]
    assert rig_fault(seen(left, right), PARALLEL) == expected


@pytest.mark.parametrize(("by_px", "expected"), [(0.0, ""), (15.0, "misaligned")])
def test_what_the_border_cuts_in_one_view_is_asked_of_neither(by_px: float, expected: str) -> None:
    """Two parts fit; of two others the left view shows the upper halves, and marks elsewhere."""
    parts = [upright(300, 100, 60), upright(380, 160, 70)]
    marks = [upright(60, 20, 25), upright(560, 330, 20)]
    cut = [replace(upright(x_px, 400, 80), fault="cut_by_border") for x_px in (160, 460)]
    right = [upright(240, 100, 60), upright(320, 160, 70)]
    right += [upright(x_px, 400 + by_px, 130) for x_px in (100, 400)]
    assert rig_fault(seen([*parts, *marks, *cut], right), PARALLEL) == expected


@pytest.mark.parametrize(("by_px", "expected"), [(0.0, ""), (12.0, "misaligned")])
def test_shadows_that_do_not_fit_are_no_sign_where_lit_parts_do(by_px: float, expected: str) -> None:
    """What is in a shadow of one view is beside a part in the other, and none of it need fit."""
    left = [outline(80, WHOLE[0]), outline(280, WHOLE[2])]
    right = [outline(50, moved(0, by_px)), outline(250, moved(2, by_px))]
    assert rig_fault(replace(shadows(), others=seen(left, right)), PARALLEL) == expected


def test_shadows_that_do_not_fit_accuse_nobody_beside_one_lit_part() -> None:
    alone = seen([outline(80, WHOLE[0])], [outline(50, WHOLE[0])])
    assert rig_fault(shadows(), PARALLEL) == "misaligned"
    assert rig_fault(replace(alone, others=shadows()), PARALLEL) == ""


def test_a_fault_of_the_rig_is_told_where_all_outlines_have_notches() -> None:
    """Nothing was refused, and nothing found."""
    black = np.zeros(PARALLEL.left.frame_size[::-1], np.uint8)
    found = Steps().matched(RectifiedPair(black, black, PARALLEL), shadows())
    assert len(found) == 0 and [each.reason for each in found.refused] == ["misaligned"] * 2
