"""A calibration exchanged half by half: nothing inconsistent is ever in use or on disk, in whatever order they come."""

from __future__ import annotations

import errno
import itertools
import os
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest
from rigs import RIGS, SIZE_PX, camera

from stereo_pick.core.calibration.files import load_camera_info, load_cameras, load_rig, save_rig
from stereo_pick.core.calibration.fingerprint import calibration_hash
from stereo_pick.core.calibration.opencv_file import load_opencv
from stereo_pick.core.calibration.renewal import CalibrationKeeper
from stereo_pick.core.camera import Camera
from stereo_pick.core.errors import CalibrationError
from stereo_pick.core.rig import StereoRig

SIDES = ("left", "right")
Pair = dict[str, Camera]


def calibrator(rig: StereoRig, alpha: float = 0.0, focal: float = 1.0) -> Pair:
    """Both camera_info of a rig as ROS's camera_calibration makes them: by cv2.stereoRectify."""
    left, right, pose = rig.left, rig.right, rig.right_T_left
    K = {"left": left.K.copy(), "right": right.K.copy()}
    for each in K.values():
        each[[0, 1], [0, 1]] *= focal
    left_R, right_R, left_P, right_P, *_ = cv2.stereoRectify(
        K["left"], left.D, K["right"], right.D, SIZE_PX, pose.rotation, pose.translation, alpha=alpha
    )
    return {
        "left": replace(left, K=K["left"], R=left_R, P=left_P),
        "right": replace(right, K=K["right"], R=right_R, P=right_P),
    }


OLD, NEW, NEWER = calibrator(RIGS["verged"]), calibrator(RIGS["verged"], focal=1.001), calibrator(RIGS["parallel"])


def hash_of(pair: Pair) -> str:
    return calibration_hash(StereoRig.from_cameras(pair["left"], pair["right"]))


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    folder = tmp_path / "rig"
    save_rig(StereoRig.from_cameras(OLD["left"], OLD["right"]), folder)
    return folder


@pytest.fixture
def keeper(folder: Path) -> CalibrationKeeper:
    return CalibrationKeeper(dict(zip(SIDES, load_cameras(folder))), SIZE_PX, folder)


def assert_only_whole_ones(keeper: CalibrationKeeper, folder: Path) -> str:
    """What is in use and what stands on disk is one calibration, one of those that were given; its hash."""
    in_use = hash_of(keeper.cameras)
    assert in_use == calibration_hash(load_rig(folder)) == calibration_hash(load_opencv(folder / "stereo.yaml"))
    assert in_use in {hash_of(OLD), hash_of(NEW), hash_of(NEWER)}
    assert sorted(path.name for path in folder.iterdir()) == ["left.yaml", "right.yaml", "stereo.yaml"]
    return in_use


@pytest.mark.parametrize("order", [("left", "right"), ("right", "left")])
def test_both_halves_are_saved_and_used_together(keeper: CalibrationKeeper, folder: Path, order) -> None:
    told = keeper.take(order[0], NEW[order[0]])
    assert "neither saved nor published" in told
    assert f"{order[1]}/set_camera_info" in told
    assert assert_only_whole_ones(keeper, folder) == hash_of(OLD)
    told = keeper.take(order[1], NEW[order[1]])
    assert f"saved in {folder}" in told
    assert assert_only_whole_ones(keeper, folder) == hash_of(NEW)
    assert keeper.waiting == {}


def test_what_is_in_use_and_on_disk_is_what_was_given(keeper: CalibrationKeeper, folder: Path) -> None:
    for side in SIDES:
        keeper.take(side, NEW[side])
    for side in SIDES:
        for given in (keeper.cameras[side], load_camera_info(folder / f"{side}.yaml")):
            for name in "KDRP":
                np.testing.assert_array_equal(getattr(given, name), getattr(NEW[side], name))


@pytest.mark.parametrize("calls", list(itertools.permutations(itertools.product(SIDES, (0, 1)))))
def test_in_whatever_order_halves_come_no_mixture_is_used(calls, tmp_path: Path) -> None:
    save_rig(StereoRig.from_cameras(OLD["left"], OLD["right"]), tmp_path)
    keeper = CalibrationKeeper(dict(zip(SIDES, load_cameras(tmp_path))), SIZE_PX, tmp_path)
    for side, which in calls:
        keeper.take(side, (NEW, NEWER)[which][side])
        assert_only_whole_ones(keeper, tmp_path)


def test_one_new_half_that_fits_the_other_is_used_at_once_and_the_others_file_stays(
    keeper: CalibrationKeeper, folder: Path
) -> None:
    save_rig(StereoRig.from_cameras(NEW["left"], NEW["right"]), folder)
    keeper = CalibrationKeeper(NEW, SIZE_PX, folder)
    (folder / "right.yaml").write_text("# mine\n" + (folder / "right.yaml").read_text())
    other_lens = replace(NEW["left"], D=NEW["left"].D * 1.01)
    assert "saved" in keeper.take("left", other_lens)
    np.testing.assert_array_equal(load_camera_info(folder / "left.yaml").D, other_lens.D)
    assert (folder / "right.yaml").read_text().startswith("# mine\n")


def test_a_folder_that_was_empty_gets_both_files(tmp_path: Path) -> None:
    keeper = CalibrationKeeper({}, SIZE_PX, tmp_path)
    assert keeper.rig is None
    assert "the other is missing" in keeper.take("right", NEW["right"])
    assert list(tmp_path.iterdir()) == []
    keeper.take("left", NEW["left"])
    assert sorted(path.name for path in tmp_path.iterdir()) == ["left.yaml", "right.yaml"]
    assert calibration_hash(load_rig(tmp_path)) == hash_of(NEW)


def test_the_names_of_the_cameras_stay(folder: Path) -> None:
    named = {side: replace(OLD[side], name=f"cell1/{side}") for side in SIDES}
    keeper = CalibrationKeeper(named, SIZE_PX, folder)
    for side in SIDES:
        keeper.take(side, NEW[side])
    assert load_camera_info(folder / "left.yaml").name == "cell1/left"


def scaled(camera: Camera, factor: float) -> Camera:
    P = camera.P.copy()
    P[0, 3] *= factor
    return replace(camera, P=P)


@pytest.mark.parametrize(
    ("side", "half", "complaint"),
    [
        ("right", scaled(NEW["right"], 1000), r"baseline = \d+\.\d m is longer than 5 m: .*millimetres"),
        ("right", scaled(NEW["right"], -1), r"baseline = -0\.\d+ m is negative"),
        ("right", NEW["left"], r"baseline = 0\.000 mm is zero: .*calibrate them as a stereo pair"),
        ("left", NEW["right"], r"P\[0,3\] and P\[1,3\] of the left camera are -\d+.* must be 0"),
        ("left", camera(size_px=(320, 240)), r"left camera_info is for 320 x 240, but the images are 640 x 480"),
    ],
    ids=["millimetres", "negative", "one alone", "exchanged", "size"],
)
def test_what_cannot_be_right_is_refused_with_its_value_and_changes_nothing(
    side: str, half: Camera, complaint: str, keeper: CalibrationKeeper, folder: Path
) -> None:
    with pytest.raises(CalibrationError, match=complaint):
        keeper.take(side, half)
    assert keeper.waiting == {}
    assert assert_only_whole_ones(keeper, folder) == hash_of(OLD)


def test_two_cameras_calibrated_apart_are_never_used(keeper: CalibrationKeeper, folder: Path) -> None:
    """P of each made from its own K, as some tools do: f differs, so the pair is no rectified one."""
    keeper.take("left", camera("left", 900.0))
    told = keeper.take("right", scaled(replace(camera("right", 910.0), P=np.array(
        [[910.0, 0, 320, -91.0], [0, 910.0, 240, 0], [0, 0, 1, 0]])), 1))  # fmt: skip
    assert "fx 900.000" in told
    assert "fx 910.000" in told
    assert assert_only_whole_ones(keeper, folder) == hash_of(OLD)


def test_without_a_place_nothing_is_taken() -> None:
    keeper = CalibrationKeeper(OLD, SIZE_PX, None, "the recording's own; give a folder")
    with pytest.raises(CalibrationError, match="there is nowhere to save it: the recording's own; give a folder"):
        keeper.take("left", NEW["left"])


@pytest.mark.parametrize("written", [0, 1])
def test_where_it_cannot_be_written_the_one_before_stays_in_use(
    written: int, keeper: CalibrationKeeper, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The disk is full after so many of the files."""
    left_over = iter([None] * written)

    def fsync(_: int) -> None:
        if next(left_over, OSError) is OSError:
            raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(os, "fsync", fsync)
    keeper.take("left", NEW["left"])
    with pytest.raises(CalibrationError, match=f"{folder} cannot be written: No space left"):
        keeper.take("right", NEW["right"])
    monkeypatch.undo()
    assert assert_only_whole_ones(keeper, folder) == hash_of(OLD)
    keeper.take("right", NEW["right"])
    assert assert_only_whole_ones(keeper, folder) == hash_of(NEW)
