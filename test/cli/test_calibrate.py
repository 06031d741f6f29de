"""`stereo-pick calibrate`: files and report for a good recording, one clear sentence and no file for a bad one."""

from __future__ import annotations

import argparse
import io
import shutil
from collections.abc import Callable
from contextlib import redirect_stderr, redirect_stdout
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
import pytest
import yaml
from page_reading import parsed, tables, words

from stereo_pick.cli import calibrate
from stereo_pick.cli.image_pairs import disagreement, find_files, pair_files
from stereo_pick.core.calibration.boards import Chessboard
from stereo_pick.core.calibration.files import load_rig
from stereo_pick.core.calibration.record import load_record
from stereo_pick.core.errors import ParameterError, StereoPickError
from stereo_pick.core.transform import Transform

BOARD = Chessboard(7, 5, 0.03)
K = np.array([[420.0, 0, 165], [0, 425, 118], [0, 0, 1]])
right_T_left = Transform(np.eye(3), np.array([-0.06, 0, 0]))

Calibrate = Callable[..., int]


def run(*arguments: str) -> int:
    parser = argparse.ArgumentParser(prog="stereo-pick")
    calibrate.add_parser(parser.add_subparsers(required=True))
    args = parser.parse_args(["calibrate", *arguments])
    return int(args.run(args))


def run_on(folder: Path, left: str, right: str, board: str = "7x5", square: str = "0.03", depth: str = "65535") -> int:
    return run(
        *("--left", str(folder / left), "--right", str(folder / right)),
        *("--board", board, "--square", square, "--output", str(folder / "rig"), "--full-scale-16", depth),
    )


@pytest.fixture(scope="module")
def rendered(render_board, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Nine rendered pairs, left1.png to left9.png and right1.png to right9.png."""
    folder = tmp_path_factory.mktemp("rendered")
    rng = np.random.default_rng(0)
    for i in range(1, 10):
        R = cv2.Rodrigues(rng.uniform(-0.5, 0.5, 3) * [1, 1, 0.3])[0]
        centre = np.array([0.03, 0, 0.5]) + rng.uniform(-1, 1, 3) * [0.02, 0.02, 0.05]
        left_T_board = Transform(R, centre - R @ BOARD.object_points().mean(axis=0))
        cv2.imwrite(str(folder / f"left{i}.png"), render_board(BOARD, K, left_T_board, (320, 240)))
        cv2.imwrite(str(folder / f"right{i}.png"), render_board(BOARD, K, right_T_left @ left_T_board, (320, 240)))
    return folder


@dataclass(frozen=True)
class Calibrated:
    """The rendered pairs with the rig calibrated from them beside, and what the command printed and returned."""

    folder: Path
    status: int
    out: str
    err: str


@pytest.fixture(scope="module")
def good(rendered: Path, tmp_path_factory: pytest.TempPathFactory) -> Calibrated:
    folder = Path(shutil.copytree(rendered, tmp_path_factory.mktemp("good") / "images"))
    out, err = io.StringIO(), io.StringIO()
    with redirect_stdout(out), redirect_stderr(err):
        status = run_on(folder, "left*.png", "right*.png")
    return Calibrated(folder, status, out.getvalue(), err.getvalue())


@pytest.fixture
def images(rendered: Path, tmp_path: Path) -> Path:
    """A copy of the rendered pairs that a test may spoil."""
    return Path(shutil.copytree(rendered, tmp_path / "images"))


def refusal(folder: Path, left: str, right: str, board: str = "7x5", square: str = "0.03") -> str:
    with pytest.raises(StereoPickError) as caught:
        run_on(folder, left, right, board, square)
    assert not list((folder / "rig").glob("*.yaml"))
    message = str(caught.value)
    assert "\n" not in message
    return message


def test_writes_the_rig_and_reports_it(good: Calibrated) -> None:
    assert good.status == 0
    rig = load_rig(good.folder / "rig")
    assert rig.baseline_m == pytest.approx(0.06, abs=0.0005)
    assert rig.left.K[0, 0] == pytest.approx(420, abs=5)
    assert yaml.safe_load((good.folder / "rig/right.yaml").read_text())["camera_name"] == "right"
    for word in ("9 of 9 used", "findChessboardCorners", "px", "mm", "deg", "verdict", "left.yaml", "stereo.yaml"):
        assert word in good.out
    assert good.err == ""


def test_images_of_a_12_bit_camera_give_the_same_rig(good: Calibrated, tmp_path: Path) -> None:
    deep = tmp_path / "deep"
    deep.mkdir()
    for file in good.folder.glob("*.png"):
        cv2.imwrite(str(deep / file.name), cv2.imread(str(file), cv2.IMREAD_UNCHANGED).astype(np.uint16) * 16)
    assert run_on(deep, "left*.png", "right*.png", depth="4080") == good.status == 0
    assert (good.folder / "rig" / "stereo.yaml").read_text() == (deep / "rig" / "stereo.yaml").read_text()


def test_same_images_on_both_sides_are_refused(images: Path) -> None:
    assert "both cameras see from the same place" in refusal(images, "left*.png", "left*.png")


def test_swapped_images_are_refused(images: Path) -> None:
    assert "swapped" in refusal(images, "right*.png", "left*.png")


def test_square_in_millimetres_is_refused(images: Path) -> None:
    assert "give metres, 0.03" in refusal(images, "left*.png", "right*.png", square="30")


def test_pattern_without_files_is_refused(images: Path) -> None:
    assert "--right" in refusal(images, "left*.png", "recht*.png")


def test_lists_of_different_length_name_the_partnerless(images: Path) -> None:
    (images / "right4.png").unlink()
    message = refusal(images, "left*.png", "right*.png")
    assert "9 left and 8 right" in message
    assert "without a partner: left4.png" in message


def test_corrupt_image_is_named(images: Path) -> None:
    (images / "left3.png").write_bytes((images / "left3.png").read_bytes()[:700])
    assert "left3.png" in refusal(images, "left*.png", "right*.png")


def test_image_of_another_size_is_named(images: Path) -> None:
    cv2.imwrite(str(images / "right2.png"), np.zeros((120, 160), np.uint8))
    assert "right2.png is 160 x 120" in refusal(images, "left*.png", "right*.png")


def test_images_of_the_current_folder_are_named_by_their_paths(images: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    cv2.imwrite(str(images / "right2.png"), np.zeros((120, 160), np.uint8))
    monkeypatch.chdir(images)
    message = refusal(Path(), "left*.png", "right*.png")
    assert message.startswith("right2.png is 160 x 120, but left1.png is 320 x 240")


def test_wrong_board_is_named(images: Path) -> None:
    assert "no chessboard of 9x6 inner corners" in refusal(images, "left[12].png", "right[12].png", board="9x6")


def test_output_that_is_a_file_is_refused(images: Path) -> None:
    (images / "rig").write_text("precious")
    with pytest.raises(StereoPickError, match="is a file"):
        run_on(images, "left*.png", "right*.png")
    assert (images / "rig").read_text() == "precious"


def test_progress_is_shown_on_a_terminal_only(
    images: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("sys.stderr.isatty", lambda: True, raising=False)
    run_on(images, "left*.png", "right*.png")
    assert "\r4/18 images" in capsys.readouterr().err


def test_files_are_sorted_as_people_count(tmp_path: Path) -> None:
    for i in (10, 2, 1):
        (tmp_path / f"left{i}.png").touch()
    names = ["left1.png", "left2.png", "left10.png"]
    assert [file.name for file in find_files([str(tmp_path / "left*")], "--left")] == names
    as_of_the_shell = [str(tmp_path / name) for name in sorted(names)]
    assert [file.name for file in find_files(as_of_the_shell, "--left")] == names


def test_patterns_need_no_quotes(images: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The shell makes several arguments of one pattern; they were said to be unknown."""
    sides = {side: sorted(str(file) for file in images.glob(f"{side}*.png")) for side in ("left", "right")}
    board = ("--board", "7x5", "--square", "0.03", "--output", str(images / "rig"))
    assert run("--left", *sides["left"], "--right", *sides["right"], *board) == 0
    assert "verdict" in capsys.readouterr().out


def test_a_file_that_is_named_like_a_pattern_is_itself(tmp_path: Path) -> None:
    (tmp_path / "left[1].png").touch()
    (tmp_path / "left1.png").touch()
    assert find_files([str(tmp_path / "left[1].png")], "--left") == [tmp_path / "left[1].png"]


@pytest.mark.parametrize(
    ("left", "right", "agrees"),
    [
        (["left1.png", "left2.png"], ["right1.png", "right2.png"], True),
        (["left1.png", "left2.png"], ["right2.png", "right3.png"], False),
        (["left01.png", "left02.png"], ["right1.png", "right2.png"], True),
        (["0001_cam0.png", "0002_cam0.png"], ["0001_cam1.png", "0002_cam1.png"], True),
        (["pair_1/left.png", "pair_2/left.png"], ["pair_1/right.png", "pair_3/right.png"], False),
        (["a.png", "b.png"], ["a.png", "b.png"], True),
    ],
)
def test_numbers_that_disagree_are_said(left: list[str], right: list[str], agrees: bool) -> None:
    pairs = pair_files([Path(name) for name in left], [Path(name) for name in right])
    assert (disagreement(pairs) is None) == agrees


def test_help_has_an_example(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        run("--help")
    printed = capsys.readouterr().out
    assert "--board 9x6 --square 0.030" in printed
    assert "INNER" in printed


def test_bench_rig_names_its_two_bad_pairs(
    shared_data: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = shared_data / "bench_rig/calibration"
    run(
        *("--left", f"{folder}/pair_*/left.png", "--right", f"{folder}/pair_*/right.png"),
        *("--board", "9x6", "--square", "0.029", "--output", str(tmp_path)),
    )
    rig, printed = load_rig(tmp_path), capsys.readouterr().out
    assert rig.baseline_m * 1000 == pytest.approx(210.344, abs=0.05)
    rejected = [line for line in printed.splitlines() if line.startswith("rejected")]
    assert len(rejected) == 2
    assert any("pair_16" in line and "moment" in line for line in rejected)
    assert any("pair_17" in line and "over-exposed" in line for line in rejected)


def test_recording_from_one_camera_is_refused(shared_data: Path, tmp_path: Path) -> None:
    folder = shared_data / "vigir2024_same_camera"
    with pytest.raises(StereoPickError, match="both cameras see from the same place"):
        run(
            *("--left", f"{folder}/cl_calib_*", "--right", f"{folder}/cr_calib_*"),
            *("--board", "9x6", "--square", "0.025", "--output", str(tmp_path / "rig")),
        )
    assert [file.name for file in (tmp_path / "rig").iterdir()] == ["calibration_report.html"]


def test_record_beside_the_rig_reads_back(good: Calibrated) -> None:
    printed, record = good.out, load_record(good.folder / "rig")
    rig = load_rig(good.folder / "rig")
    assert record.uncertainty.parameters[0] == pytest.approx(rig.left.K[0, 0])
    assert f"verdict   {record.verdict}" in printed
    for word in ("held out", "epipolar error", "coverage", "±", "(1 sigma)", "calibration.yaml"):
        assert word in printed


def test_baseline_measured_on_the_rig_contradicts_a_wrong_square(images: Path) -> None:
    patterns = ("--left", f"{images}/left*.png", "--right", f"{images}/right*.png", "--board", "7x5")
    with pytest.raises(StereoPickError, match="is the square really 36 mm"):
        run(*patterns, "--square", "0.036", "--output", f"{images}/rig", "--baseline", "0.06")
    page = report(images)
    assert "refused" in page and "is the square really 36 mm" in page and "Rms residuals" in page
    assert not list((images / "rig").glob("*.yaml"))
    assert run(*patterns, "--square", "0.03", "--output", f"{images}/rig", "--baseline", "0.06") == 0


@pytest.mark.parametrize(
    ("baseline", "says"),
    [
        ("-0.06", "baseline = -0.06 m must be positive: measure the distance of the two lenses"),
        ("0", "baseline = 0 m must be positive"),
        ("nan", "baseline = nan m must be positive"),
        ("inf", "baseline = inf m must be positive"),
        ("60", "baseline = 60 m is larger than 5 m, so it is probably in millimetres: give metres, 0.06"),
    ],
)
def test_baseline_that_no_rig_has_is_refused_before_any_image_is_read(baseline: str, says: str, tmp_path: Path) -> None:
    with pytest.raises(ParameterError, match=says):
        run(
            *("--bag", str(tmp_path), "--board", "7x5", "--square", "0.03"), f"--baseline={baseline}", "--output", "rig"
        )


def report(folder: Path) -> str:
    return (folder / "rig/calibration_report.html").read_text(encoding="utf-8")


def test_report_page_is_written_beside_the_rig(good: Calibrated) -> None:
    assert f"written   {good.folder}/rig/calibration_report.html" in good.out
    root = parsed(report(good.folder))
    assert [row[0] for row in tables(root)["Pairs used and left out"]] == [
        f"left{i}.png + right{i}.png" for i in range(1, 10)
    ]
    assert [each.get("href")[:23] for each in root.iter("image")] == ["data:image/jpeg;base64,"] * 2


def test_refused_recording_has_a_page_that_says_why(images: Path) -> None:
    message = refusal(images, "left*.png", "left*.png")
    assert message.endswith(f"see {images}/rig/calibration_report.html")
    (reason,) = [item.text for item in parsed(report(images)).iter("li")]
    assert "both cameras see from the same place" in reason
    assert reason in message


def test_pair_with_a_hostile_name_stays_text_in_the_page(images: Path) -> None:
    (images / "left5.png").rename(images / "left5<script>alert('&amp;')<!--.png")
    run_on(images, "left*.png", "right*.png")
    root = parsed(report(images))
    assert "left5<script>alert('&amp;')<!--.png + right5.png" in words(root)
    assert list(root.iter("script")) == []


def test_refusal_is_said_also_where_its_page_cannot_be_written(images: Path) -> None:
    (images / "rig").mkdir()
    (images / "rig/calibration_report.html").mkdir()
    message = refusal(images, "left*.png", "left*.png")
    assert "both cameras see from the same place" in message
    assert "calibration_report" not in message
