"""Exchanged images and a wrong calibration are noticed by the objects alone."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from outlines import seen
from rendering import Scene, balls, render
from rigs import RIGS, rotation

from stereo_pick.core.arrays import Image
from stereo_pick.core.correspondence.rig_check import rig_fault
from stereo_pick.core.frames import StereoFrame
from stereo_pick.core.objects import Detector
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
