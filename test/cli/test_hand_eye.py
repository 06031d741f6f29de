"""`stereo-pick hand-eye`: from a file of pairs or points to base_T_camera.yaml, or one line that says what is wrong."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
import yaml

from stereo_pick.cli.main import main
from stereo_pick.core.arrays import Image
from stereo_pick.core.calibration.boards import Chessboard
from stereo_pick.core.calibration.files import save_rig
from stereo_pick.core.calibration.fingerprint import calibration_hash
from stereo_pick.core.camera import Camera
from stereo_pick.core.errors import CalibrationError
from stereo_pick.core.hand_eye.files import FramedHandEye, load_hand_eye, save_hand_eye
from stereo_pick.core.hand_eye.rotations import rotation_matrix, to_quaternion
from stereo_pick.core.rig import StereoRig
from stereo_pick.core.transform import Transform

BOARD = Chessboard(7, 5, 0.03)
K = np.array([[420.0, 0, 165], [0, 425, 118], [0, 0, 1]])
base_T_camera = Transform(rotation_matrix(np.array([2.1, 0.3, -0.4])), np.array([0.8, 0.1, 0.9]))
flange_T_board = Transform(rotation_matrix(np.array([0.1, 0.2, -0.3])), np.array([0.02, 0.03, 0.1]))


def written(pose: Transform) -> dict[str, Any]:
    return {"xyz_m": pose.translation.tolist(), "quaternion_xyzw": to_quaternion(pose.rotation).tolist()}


def boards(count: int = 10) -> list[Transform]:
    rng = np.random.default_rng(0)
    found = []
    for _ in range(count):
        R = rotation_matrix(rng.uniform(-0.5, 0.5, 3) * [1, 1, 0.6])
        centre = rng.uniform(-0.03, 0.03, 3) + [0, 0, 0.5]
        found.append(Transform(R, centre - R @ BOARD.object_points().mean(axis=0)))
    return found


def pairs(sigma_m: float = 0.0) -> dict[str, Any]:
    rng = np.random.default_rng(1)
    entries = []
    for board in boards():
        noisy = Transform(board.rotation, board.translation + rng.normal(0, sigma_m, 3))
        base_T_flange = base_T_camera @ board @ flange_T_board.inverse()
        entries.append({"base_T_flange": written(base_T_flange), "camera_T_board": written(noisy)})
    return {"mount": "eye-to-hand", "pairs": entries}


def run(tmp_path: Path, content: object, *options: str) -> int:
    file = tmp_path / "pairs.yaml"
    file.write_text(content if isinstance(content, str) else yaml.safe_dump(content))
    return main(["hand-eye", str(file), "--output", str(tmp_path / "out" / "base_T_camera.yaml"), *options])


def complaint(tmp_path: Path, content: object, capsys: pytest.CaptureFixture[str], *options: str) -> str:
    assert run(tmp_path, content, *options) == 1
    assert not (tmp_path / "out").exists()
    text = capsys.readouterr().err
    assert text.startswith(f"stereo-pick: error: {tmp_path / 'pairs.yaml'}: ") and text.count("\n") == 1
    return text


def test_pairs_become_a_file_and_a_report(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(tmp_path, pairs(2e-4)) == 0
    framed = load_hand_eye(tmp_path / "out" / "base_T_camera.yaml")
    assert (framed.parent_frame, framed.child_frame) == ("base_link", "left_camera_optical_frame")
    found = framed.hand_eye.found
    off_mm = np.abs(found.transform.translation - base_T_camera.translation) * 1000
    assert (off_mm < 4 * found.sigma_mm).all() and off_mm.max() < 2
    text = capsys.readouterr().out
    assert "base_T_camera" in text and "pairs[9]: 0." in text and "solver    " in text


def test_json_and_frame_names_are_taken_too(tmp_path: Path) -> None:
    assert run(tmp_path, json.dumps(pairs()), "--parent-frame", "world", "--child-frame", "cam") == 0
    framed = load_hand_eye(tmp_path / "out" / "base_T_camera.yaml")
    assert (framed.parent_frame, framed.child_frame) == ("world", "cam")
    np.testing.assert_allclose(framed.hand_eye.found.transform.translation, base_T_camera.translation, atol=1e-9)


def test_touched_points_become_a_file(tmp_path: Path) -> None:
    camera = np.random.default_rng(0).uniform(-0.1, 0.1, (6, 3)) + [0, 0, 0.8]
    base = base_T_camera.apply(camera)
    points = [{"base_xyz_m": b, "camera_xyz_m": c} for b, c in zip(base.tolist(), camera.tolist())]
    assert run(tmp_path, {"points": points}) == 0
    hand_eye = load_hand_eye(tmp_path / "out" / "base_T_camera.yaml").hand_eye
    np.testing.assert_allclose(hand_eye.found.transform.rotation, base_T_camera.rotation, atol=1e-9)
    assert [residual.name for residual in hand_eye.residuals][-1] == "points[5]"


def test_images_of_the_board_are_enough(tmp_path: Path, render_board: Callable[..., Image]) -> None:
    camera = Camera("left", 320, 240, K, np.zeros(5), np.eye(3), np.eye(3, 4))
    rig = StereoRig.from_extrinsics(camera, camera, Transform(np.eye(3), np.array([-0.06, 0, 0])))
    save_rig(rig, tmp_path / "rig")
    content = pairs()
    for number, (entry, board) in enumerate(zip(content["pairs"], boards())):
        cv2.imwrite(str(tmp_path / f"{number}.png"), render_board(BOARD, K, board, (320, 240)))
        del entry["camera_T_board"]
        entry["image"] = f"{number}.png"
    options = ("--calibration", str(tmp_path / "rig"), "--board", "7x5", "--square", "0.03")
    assert run(tmp_path, content, *options) == 0
    found = load_hand_eye(tmp_path / "out" / "base_T_camera.yaml").hand_eye.found
    off_mm = np.abs(found.transform.translation - base_T_camera.translation) * 1000
    assert (off_mm < 4 * found.sigma_mm).all() and off_mm.max() < 3


def test_the_file_survives_a_round_trip(tmp_path: Path) -> None:
    run(tmp_path, pairs(2e-4))
    first, second = tmp_path / "out" / "base_T_camera.yaml", tmp_path / "second.yaml"
    framed = load_hand_eye(first)
    save_hand_eye(framed, second)
    again = load_hand_eye(second)
    np.testing.assert_allclose(
        again.hand_eye.found.transform.rotation, framed.hand_eye.found.transform.rotation, atol=1e-15
    )
    np.testing.assert_array_equal(again.hand_eye.found.covariance, framed.hand_eye.found.covariance)
    assert again.hand_eye.residuals == framed.hand_eye.residuals and again.hand_eye.attempts == framed.hand_eye.attempts


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (
            {"pose": {"xyz_m": [500.0, 100.0, 1000.0], "quaternion_xyzw": [0, 0, 0, 1]}},
            "camera is 1122 m from the base",
        ),
        ({"name": "camera_T_base"}, "camera_T_base: the pose must be the camera's, .* invert it"),
        ({"parent_frame": None}, "frames '' and 'left_camera_optical_frame'"),
    ],
)
def test_a_file_that_was_edited_wrongly_is_refused(tmp_path: Path, change: dict[str, Any], message: str) -> None:
    """Poses a kilometre off, or in the frame None, went to the robot."""
    run(tmp_path, pairs())
    file = tmp_path / "out" / "base_T_camera.yaml"
    file.write_text(yaml.safe_dump({**yaml.safe_load(file.read_text()), **change}))
    with pytest.raises(CalibrationError, match=rf"base_T_camera\.yaml: .*{message}"):
        load_hand_eye(file)


def test_a_file_of_something_else_is_refused_by_name(tmp_path: Path) -> None:
    file = tmp_path / "other.yaml"
    file.write_text("image_width: 640")
    with pytest.raises(CalibrationError, match="other.yaml: field 'name' is missing"):
        load_hand_eye(file)
    with pytest.raises(CalibrationError, match="absent.yaml: cannot be read"):
        load_hand_eye(tmp_path / "absent.yaml")
    run(tmp_path, pairs(2e-4))
    data = yaml.safe_load((tmp_path / "out" / "base_T_camera.yaml").read_text())
    good = data["covariance"]
    data["covariance"] = [[-1.0, *good[0][1:]], *good[1:]]
    file.write_text(yaml.safe_dump(data))
    with pytest.raises(CalibrationError, match="other.yaml: covariance has the negative variance"):
        load_hand_eye(file)
    data["covariance"] = [[good[i][j] * (1e-6 if i == j else 1) for j in range(6)] for i in range(6)]
    file.write_text(yaml.safe_dump(data))
    with pytest.raises(CalibrationError, match="other.yaml: covariance is none: its covariances are larger"):
        load_hand_eye(file)
    with pytest.raises(CalibrationError, match="two different names"):
        FramedHandEye(load_hand_eye(tmp_path / "out" / "base_T_camera.yaml").hand_eye, "map", "map")


@pytest.mark.parametrize("rows", [[{"name": "pair 1", "off_mm": 0.1}], ["pair 1"], 7])
def test_a_file_whose_lists_hold_something_else_is_refused_by_their_name(rows: object, tmp_path: Path) -> None:
    run(tmp_path, pairs(2e-4))
    file = tmp_path / "out" / "base_T_camera.yaml"
    data = yaml.safe_load(file.read_text())
    for field in ("residuals", "attempts"):
        file.write_text(yaml.safe_dump({**data, field: rows}))
        with pytest.raises(CalibrationError, match=f"yaml: field '{field}' is no list of what stereo-pick hand-eye"):
            load_hand_eye(file)


def spoilt(change: Callable[[dict[str, Any]], object]) -> dict[str, Any]:
    content = pairs()
    change(content)
    return content


@pytest.mark.parametrize(
    ("content", "says"),
    [
        ("- 1\n- 2", "holds no names with values"),
        ("mount: [", "is no YAML"),
        ({"mount": "eye-to-hand"}, "'pairs' is missing"),
        ({"mount": "on-a-stick", "pairs": []}, "mount 'on-a-stick' must be one of: eye-to-hand, eye-in-hand"),
        ({"mount": "eye-to-hand", "pairs": 3}, "pairs must be a list"),
        ({"mount": "eye-to-hand", "pairs": ["a"]}, "pairs[0]: must hold names"),
        (spoilt(lambda c: c["pairs"][2].pop("camera_T_board")), "pairs[2]: needs either image or camera_T_board"),
        (spoilt(lambda c: c["pairs"][2].update(image="a.png")), "pairs[2]: needs either image or camera_T_board"),
        (spoilt(lambda c: c["pairs"][3].update(flange=1)), "pairs[3]: 'flange' is unknown"),
        (spoilt(lambda c: c["pairs"][4]["base_T_flange"].pop("xyz_m")), "pairs[4]: base_T_flange: 'xyz_m' is missing"),
        (spoilt(lambda c: c["pairs"][4]["base_T_flange"].update(xyz_m=[1, 2])), "base_T_flange: xyz_m has shape (2,)"),
        (spoilt(lambda c: c["pairs"][5]["base_T_flange"].update(xyz_m=["a", 1, 2])), "pairs[5]: base_T_flange: holds"),
        (spoilt(lambda c: c["pairs"][6]["base_T_flange"].update(quaternion_xyzw=[1, 1, 0, 0])), "length 1.414"),
        (spoilt(lambda c: c.update(pairs=c["pairs"][:2])), "2 pairs of robot pose and board view"),
        (spoilt(lambda c: c.update(mount="eye-in-hand")), "they fit as eye-to-hand"),
        ({"points": [{"base_xyz_m": [0, 0, 0]}]}, "points[0]: 'camera_xyz_m' is missing"),
        ({"points": [{"base_xyz_m": [0, 0, 0], "camera_xyz_m": [0, 0, 1]}]}, "1 touched points"),
    ],
)
def test_what_is_wrong_is_said_with_file_and_entry(
    content: object, says: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert says in complaint(tmp_path, content, capsys)


def test_the_recording_and_the_calibration_are_not_overwritten(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    camera = Camera("left", 320, 240, K, np.zeros(5), np.eye(3), np.eye(3, 4))
    save_rig(StereoRig.from_extrinsics(camera, camera, Transform(np.eye(3), np.array([-0.06, 0, 0]))), tmp_path / "rig")
    recording = tmp_path / "pairs.yaml"
    recording.write_text(yaml.safe_dump(pairs()))
    for output in (recording, tmp_path / "rig" / "left.yaml"):
        before = output.read_bytes()
        arguments = ["hand-eye", str(recording), "--calibration", str(tmp_path / "rig"), "--output", str(output)]
        assert main(arguments) == 1
        assert f"--output {output} is one of the files it is made from: give another" in capsys.readouterr().err
        assert output.read_bytes() == before


def test_images_need_the_board_and_must_show_it(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    content = pairs()
    content["pairs"][0] = {"base_T_flange": content["pairs"][0]["base_T_flange"], "image": "empty.png"}
    assert "give --calibration, --board and --square" in complaint(tmp_path, content, capsys)
    camera = Camera("left", 320, 240, K, np.zeros(5), np.eye(3), np.eye(3, 4))
    rig = StereoRig.from_extrinsics(camera, camera, Transform(np.eye(3), np.array([-0.06, 0, 0])))
    save_rig(rig, tmp_path / "rig")
    options = ("--calibration", str(tmp_path / "rig"), "--board", "7x5", "--square", "0.03")
    assert "no such image file" in complaint(tmp_path, content, capsys, *options)
    cv2.imwrite(str(tmp_path / "empty.png"), np.zeros((240, 320), np.uint8))
    assert "empty.png: no 7x5 board found" in complaint(tmp_path, content, capsys, *options)


def test_the_calibration_that_was_given_is_recorded(tmp_path: Path) -> None:
    rig = StereoRig.from_extrinsics(
        Camera("left", 320, 240, K, np.zeros(5), np.eye(3), np.eye(3, 4)),
        Camera("right", 320, 240, K, np.zeros(5), np.eye(3), np.eye(3, 4)),
        Transform(np.eye(3), np.array([-0.1, 0, 0])),
    )
    save_rig(rig, tmp_path / "rig")
    assert run(tmp_path, pairs(), "--calibration", str(tmp_path / "rig")) == 0
    made = load_hand_eye(tmp_path / "out" / "base_T_camera.yaml")
    assert made.calibration_hash == calibration_hash(rig)
    assert run(tmp_path, pairs()) == 0
    assert load_hand_eye(tmp_path / "out" / "base_T_camera.yaml").calibration_hash == ""
