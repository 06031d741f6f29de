"""`stereo-pick calibrate --bag`: the same result out of a recording in which a board is moved about."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore

from stereo_pick.cli.main import main
from stereo_pick.core.arrays import Image
from stereo_pick.core.calibration.boards import Chessboard
from stereo_pick.core.calibration.charuco import CharucoBoard
from stereo_pick.core.calibration.files import load_rig
from stereo_pick.core.transform import Transform

ROS2 = get_typestore(Stores.ROS2_JAZZY)
BOARD = Chessboard(7, 5, 0.03)
K = np.array([[420.0, 0, 165], [0, 425, 118], [0, 0, 1]])
right_T_left = Transform(np.eye(3), np.array([-0.06, 0, 0]))
GREY = np.full((240, 320), 128, np.uint8)

Pairs = Sequence[tuple[Image, Image]]


def write_bag(path: Path, pairs: Pairs, topics: tuple[str, str] = ("/left/image_raw", "/right/image_raw")) -> Path:
    types, interval_ns = ROS2.types, 200_000_000
    with Writer(path, version=9, storage_plugin=StoragePlugin.MCAP) as writer:
        connections = [writer.add_connection(topic, "sensor_msgs/msg/Image", typestore=ROS2) for topic in topics]
        for i, pair in enumerate(pairs):
            stamp_ns = 10**18 + i * interval_ns
            for connection, picture in zip(connections, pair):
                writer.write(connection, stamp_ns, ROS2.serialize_cdr(message(types, stamp_ns, picture), IMAGE))
    return path


IMAGE = "sensor_msgs/msg/Image"


def message(types: Any, stamp_ns: int, picture: Image) -> Any:
    header = types["std_msgs/msg/Header"](
        stamp=types["builtin_interfaces/msg/Time"](*divmod(stamp_ns, 10**9)), frame_id="camera"
    )
    height, width = picture.shape
    return types[IMAGE](
        header=header, height=height, width=width, encoding="mono8", is_bigendian=0, step=width, data=picture.ravel()
    )


@pytest.fixture(scope="module")
def rendered(render_board) -> Pairs:
    rng = np.random.default_rng(0)
    pairs = []
    for _ in range(10):
        R = cv2.Rodrigues(rng.uniform(-0.5, 0.5, 3) * [1, 1, 0.3])[0]
        centre = np.array([0.03, 0, 0.5]) + rng.uniform(-1, 1, 3) * [0.03, 0.03, 0.05]
        pose = Transform(R, centre - R @ BOARD.object_points().mean(axis=0))
        left, right = (render_board(BOARD, K, camera, (320, 240)) for camera in (pose, right_T_left @ pose))
        pairs.append((left, right))
    return pairs


def run(bag: Path, *more: str) -> int:
    output = str(bag.parent / "rig")
    return main(["calibrate", "--bag", str(bag), "--board", "7x5", "--square", "0.03", "--output", output, *more])


def test_takes_each_view_once_and_leaves_out_the_blurred(
    rendered: Pairs, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    held = [pair for pair in rendered for _ in range(3)]
    blurred = [tuple(cv2.GaussianBlur(picture[:, ::-1], (0, 0), 3) for picture in pair) for pair in rendered[:3]]
    bag = write_bag(tmp_path / "bag", [(GREY, GREY)] * 3 + held + blurred)
    assert run(bag) == 0
    printed = capsys.readouterr().out
    assert "10 taken" in printed
    assert "of 36 that were looked at" in printed
    assert "10 of 10 used" in printed
    rig = load_rig(tmp_path / "rig")
    assert rig.baseline_m == pytest.approx(0.06, abs=0.0005)
    assert rig.left.K[0, 0] == pytest.approx(420, abs=5)


@pytest.mark.skipif(not hasattr(cv2, "aruco"), reason="this OpenCV has no aruco module")
def test_a_charuco_board_may_leave_the_image(
    render_charuco, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    board = CharucoBoard(8, 6, 0.035, 0.75, "4X4_50")
    rng = np.random.default_rng(3)
    pairs = []
    for _ in range(16):
        R = cv2.Rodrigues(rng.uniform(-0.5, 0.5, 3))[0]
        centre = np.array([0.03, 0, 0.4]) + rng.uniform(-1, 1, 3) * [0.1, 0.08, 0.05]
        pose = Transform(R, centre - R @ board.object_points().mean(axis=0))
        pairs.append(tuple(render_charuco(board, K, camera, (320, 240)) for camera in (pose, right_T_left @ pose)))
    bag = str(write_bag(tmp_path / "bag", pairs))
    output = tmp_path / "rig"
    options = ["--board", "charuco:8x6:0.75:4X4_50", "--square", "0.035", "--output", str(output)]
    assert main(["calibrate", "--bag", bag, *options]) == 0
    assert "ChArUco board of 8x6 squares (markers of 0.75 squares from 4X4_50), " in capsys.readouterr().out
    assert load_rig(output).baseline_m == pytest.approx(0.06, abs=0.0005)
    assert "ChArUco board of 8x6 squares" in (output / "calibration_report.html").read_text(encoding="utf-8")


def test_topics_may_be_named(rendered: Pairs, tmp_path: Path) -> None:
    bag = write_bag(tmp_path / "bag", rendered, ("/a/image_raw", "/b/image_raw"))
    assert run(bag) == 1
    assert run(bag, "--left-topic", "/a/image_raw", "--right-topic", "/b/image_raw") == 0


def test_a_bad_pair_is_named_by_its_time(rendered: Pairs, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    shifted = (rendered[4][0], np.roll(rendered[4][1], 4, axis=0))
    assert run(write_bag(tmp_path / "bag", [*rendered[:4], shifted, *rendered[5:]])) == 0
    assert "rejected  pair at 0.80 s: " in capsys.readouterr().out


@pytest.mark.parametrize("case", ["no board", "no bag", "one camera", "few"])
def test_what_gives_no_rig_is_refused(
    case: str, rendered: Pairs, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    pairs, message = {
        "no board": ([(GREY, GREY)] * 4, "no chessboard of 7x5 inner corners found in both images of any of 4 pairs"),
        "no bag": ([], "no such bag"),
        "one camera": ([(left, left) for left, _ in rendered], "both cameras see from the same place"),
        "few": ([rendered[0]] * 9, "1 usable pairs of the 7x5 board are too few"),
    }[case]
    if pairs:
        write_bag(tmp_path / "bag", pairs)
    assert run(tmp_path / "bag") == 1
    assert message in capsys.readouterr().err
    assert list((tmp_path / "rig").glob("*.yaml")) == []


@pytest.mark.parametrize(
    ("options", "status"),
    [
        (["--bag", "bag", "--right", "right*"], 1),
        (["--left", "left*"], 1),
        (["--left", "left*", "--right", "right*", "--left-topic", "/left"], 1),
        (["--bag", "bag", "--left", "left*"], 2),
        ([], 2),
    ],
)
def test_inputs_that_contradict_each_other_are_refused(
    options: list[str], status: int, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    arguments = ["calibrate", *options, "--board", "7x5", "--square", "0.03", "--output", str(tmp_path / "rig")]
    if status == 2:
        with pytest.raises(SystemExit):
            main(arguments)
    else:
        assert main(arguments) == status
    assert "--bag" in capsys.readouterr().err
