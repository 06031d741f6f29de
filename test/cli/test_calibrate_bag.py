"""`stereo-pick calibrate --bag`: the same result out of a recording in which a board is moved about."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
import pytest
from board_bags import GREY, K, Pairs, rendered_pairs, right_T_left, write_bag

from stereo_pick.cli.main import main
from stereo_pick.core.calibration.charuco import CharucoBoard
from stereo_pick.core.calibration.files import load_rig
from stereo_pick.core.transform import Transform


@pytest.fixture(scope="module")
def rendered(render_board) -> Pairs:
    return rendered_pairs(render_board)


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


def test_pairs_of_a_camera_that_hung_are_not_looked_at(
    rendered: Pairs, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    hung = [(rendered[4][0], right) for _, right in rendered[5:7]]
    assert run(write_bag(tmp_path / "bag", [*rendered[:5], *hung, *rendered[7:], *rendered[5:7]])) == 0
    said = capsys.readouterr()
    assert "10 taken, the board in 10 of 10 that were looked at" in said.out and "10 of 10 used" in said.out
    assert "2 of 12 pairs, the first of them number 6, are refused: /left/image_raw repeats" in said.err


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
