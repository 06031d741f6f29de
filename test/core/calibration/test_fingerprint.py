"""The hash of a rig: one for all forms in which a rig travels, another for every other rig."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest
from hypothesis import given
from rigs import RIGS, camera, looking_at, random_rigs

from stereo_pick.core.calibration.files import load_rig, save_rig
from stereo_pick.core.calibration.fingerprint import calibration_hash
from stereo_pick.core.camera import Camera
from stereo_pick.core.rig import StereoRig
from stereo_pick.core.transform import Transform


def of_cameras(left: Camera, right: Camera) -> str:
    return calibration_hash(StereoRig.from_cameras(left, right))


def drivers(decimals: int = 16) -> tuple[Camera, Camera]:
    """The thesis's rig with R and P as OpenCV makes them (alpha 0), rounded as text files are."""
    rig = RIGS["thesis"]
    left, right, pose = rig.left, rig.right, rig.right_T_left
    left_R, right_R, left_P, right_P, *_ = cv2.stereoRectify(
        left.K, left.D, right.K, right.D, left.frame_size, pose.rotation, pose.translation, alpha=0
    )
    return (
        replace(left, R=np.round(left_R, decimals), P=np.round(left_P, decimals)),
        replace(right, R=np.round(right_R, decimals), P=np.round(right_P, decimals)),
    )


@given(random_rigs())
def test_a_rig_made_of_its_own_camera_info_keeps_its_hash(rig: StereoRig) -> None:
    assert of_cameras(rig.left, rig.right) == calibration_hash(rig)


def test_another_rectification_of_the_same_cameras_has_the_same_hash() -> None:
    assert of_cameras(*drivers()) == calibration_hash(RIGS["thesis"])


@pytest.mark.parametrize("decimals", [4, 5, 6, 8])
def test_rounded_camera_info_has_one_hash_before_and_after_rectification(decimals: int) -> None:
    raw = StereoRig.from_cameras(*drivers(decimals))
    assert of_cameras(raw.left, raw.right) == calibration_hash(raw)


@pytest.mark.parametrize("form", ["left.yaml", "stereo.yaml"])
def test_both_forms_of_file_have_the_hash_of_the_rig(form: str, tmp_path: Path) -> None:
    for path in save_rig(RIGS["rolled"], tmp_path):
        if (path.name == "stereo.yaml") != (form == "stereo.yaml"):
            path.unlink()
    assert calibration_hash(load_rig(tmp_path)) == calibration_hash(RIGS["rolled"])


def test_coefficients_that_are_zero_do_not_change_the_camera() -> None:
    pose = Transform(np.eye(3), np.array([-0.1, 0, 0]))
    hashes = {
        calibration_hash(StereoRig.from_extrinsics(camera(D=D), camera("right", D=D), pose))
        for D in ((-0.1, 0.02, 0, 0), (-0.1, 0.02, 0, 0, 0), (-0.1, 0.02, -0.0, 0, 0))
    }
    assert len(hashes) == 1


def test_every_other_rig_has_another_hash() -> None:
    right_T_left = looking_at((0.2, 0, 0), (0, 0, 1))
    nearer = Transform(right_T_left.rotation, right_T_left.translation + [1e-6, 0, 0])
    turned = Transform(looking_at((0.2, 0, 0), (0, 0, 1), roll_deg=1e-4).rotation, right_T_left.translation)
    left, right = camera(), camera("right")
    rigs = [
        StereoRig.from_extrinsics(left, right, right_T_left),
        StereoRig.from_extrinsics(left, right, nearer),
        StereoRig.from_extrinsics(left, right, turned),
        StereoRig.from_extrinsics(camera(focal_px=900.0001), right, right_T_left),
        StereoRig.from_extrinsics(left, camera("right", D=(0, 0, 1e-6, 0, 0)), right_T_left),
        StereoRig.from_extrinsics(camera(size_px=(641, 480)), camera("right", size_px=(641, 480)), right_T_left),
    ]
    hashes = [calibration_hash(rig) for rig in rigs]
    assert len(set(hashes)) == len(rigs)
    assert {len(each) for each in hashes} == {12}
