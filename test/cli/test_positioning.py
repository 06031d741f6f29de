"""--calibration-file, --hand-eye, and the calibration.yaml that stands beside the cameras' files."""

from __future__ import annotations

import json
import shutil
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
import rigs
from recordings import DEMO_RIG, demo_pairs
from rig_files import write_hand_eye, write_record

from stereo_pick.cli.main import main
from stereo_pick.core.calibration.files import load_rig
from stereo_pick.core.calibration.fingerprint import calibration_hash
from stereo_pick.core.transform import Transform

BASE_T_CAMERA = Transform(rigs.rotation((2.2, 0.2, -0.3)), np.array([0.6, -0.2, 0.9]))
RIG = load_rig(DEMO_RIG)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """The demo's calibration and its first pair."""
    shutil.copytree(DEMO_RIG, tmp_path / "rig")
    for side, picture in zip(("left", "right"), demo_pairs(1)[0]):
        cv2.imwrite(str(tmp_path / f"{side}.png"), picture)
    return tmp_path


def located(folder: Path, *options: object) -> tuple[int, list[str]]:
    images = [str(folder / f"{side}.png") for side in ("left", "right")]
    return main(["locate", *images, "--calibration", str(folder / "rig"), *map(str, options)]), images


def json_of(folder: Path, capsys: pytest.CaptureFixture[str], *options: object) -> dict[str, Any]:
    assert located(folder, "--json", *options)[0] == 0
    captured = capsys.readouterr()
    assert captured.err == ""
    return dict(json.loads(captured.out))


def variances(found: dict[str, Any]) -> np.ndarray:
    return np.array([np.diag(each["covariance_m2"]) for each in found["objects"]])


def test_the_record_beside_the_cameras_grows_the_covariance(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    before = json_of(folder, capsys)
    assert before["covariance_of"] == ["image"]
    assert before["calibration_hash"] == calibration_hash(RIG)
    write_record(RIG, folder / "rig", focal_sigma_px=3.0)
    after = json_of(folder, capsys)
    assert after["covariance_of"] == ["image", "calibration"]
    assert len(after["objects"]) == len(before["objects"]) >= 2
    assert (variances(after)[:, 2] > variances(before)[:, 2]).all()
    (folder / "rig" / "calibration.yaml").rename(folder / "elsewhere.yaml")
    assert json_of(folder, capsys, "--calibration-file", folder / "elsewhere.yaml") == after
    assert json_of(folder, capsys) == before


def test_confidence_is_of_the_tolerance_in_use_and_of_the_whole_covariance(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    tight = ("--param", "triangulation.tolerance_m=0.0003")
    generous, surer = json_of(folder, capsys), json_of(folder, capsys, *tight)
    write_record(RIG, folder / "rig", focal_sigma_px=3.0)
    whole = json_of(folder, capsys, *tight)
    assert [found["tolerance_m"] for found in (generous, surer, whole)] == [0.005, 0.0003, 0.0003]
    stated = [[each["confidence"] for each in found["objects"]] for found in (whole, surer, generous)]
    assert (np.diff(stated, axis=0) > 0).all()


def test_a_record_of_another_calibration_is_left_out_with_a_warning_and_refused_where_it_was_named(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = write_record(rigs.RIGS["parallel"], folder / "rig")
    assert located(folder)[0] == 0
    captured = capsys.readouterr()
    assert captured.err.startswith("stereo-pick: warning: covariance without the calibration's part: ")
    assert "is of another calibration" in captured.err
    assert "uncertainty of" not in captured.out
    assert located(folder, "--calibration-file", path)[0] == 1
    assert f"{path} is of another calibration" in capsys.readouterr().err


def test_poses_in_the_robots_frame(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    before = json_of(folder, capsys)
    file = write_hand_eye(folder / "hand_eye.yaml", BASE_T_CAMERA, calibration_hash=calibration_hash(RIG))
    after = json_of(folder, capsys, "--hand-eye", file)
    assert after["frame"] == "base_link"
    assert after["covariance_of"] == ["image", "hand_eye"]
    for one, other in zip(before["objects"], after["objects"]):
        np.testing.assert_allclose(BASE_T_CAMERA.apply(one["position_m"]), other["position_m"], atol=1e-9)
        assert one["left_px"] == other["left_px"]
    assert located(folder, "--hand-eye", file)[0] == 0
    assert "in base_link; uncertainty of: image, hand_eye" in capsys.readouterr().out


def test_a_hand_eye_of_another_calibration_is_refused(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = write_hand_eye(folder / "hand_eye.yaml", BASE_T_CAMERA, calibration_hash="0123456789ab")
    assert located(folder, "--hand-eye", file)[0] == 1
    captured = capsys.readouterr()
    assert captured.out == ""
    assert "made with another calibration (0123456789ab)" in captured.err


def test_a_file_that_is_no_hand_eye_is_named(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert located(folder, "--hand-eye", folder / "rig" / "left.yaml")[0] == 1
    error = capsys.readouterr().err
    assert "left.yaml: field 'name' is missing: is it a file of stereo-pick hand-eye?" in error
