"""The command `stereo-pick` as a process: what it prints and writes, its exit status, and what signals do to it."""

from __future__ import annotations

import json
import os
import re
import signal
import subprocess
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from marks import first_of
from recordings import DEMO_RIG, Recording, demo_pairs, write_images
from ros_tools import Done, System, is_prompt, stereo_pick, stereo_pick_here
from rosbags.highlevel import AnyReader

from stereo_pick.cli import demo, run
from stereo_pick.cli.main import main
from stereo_pick.cli.run import Outcome
from stereo_pick.core.calibration.files import load_rig
from stereo_pick.core.confidence import within
from stereo_pick.core.frames import StereoFrame
from stereo_pick.core.images import ImageBuffer
from stereo_pick.core.pipeline import Pipeline
from stereo_pick.core.places.extent import KINDS
from stereo_pick.core.refusal import REASONS

RIG = load_rig(DEMO_RIG)
COUNT = 3


@pytest.fixture(scope="module")
def images(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_images(tmp_path_factory.mktemp("command") / "images", demo_pairs(COUNT))


@pytest.fixture(scope="module")
def bag(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return Recording.of(RIG, *demo_pairs(COUNT)).write(tmp_path_factory.mktemp("command") / "bag")


@pytest.fixture(scope="module")
def offline(bag: Path) -> list[dict[str, Any]]:
    """The lines that `stereo-pick replay` prints."""
    done = stereo_pick("replay", bag)
    assert (done.status, done.stderr) == (0, "")
    return [json.loads(line) for line in done.stdout.splitlines()]


def locate(images: Path, index: int, *more: str | Path, command: Callable[..., Done] = stereo_pick_here) -> str:
    files = [images / f"{side}{index:02}.png" for side in ("left", "right")]
    done = command("locate", *files, "--calibration", DEMO_RIG, *more)
    assert (done.status, done.stderr) == (0, "")
    return done.stdout


def is_numbers(value: Any, *shape: int) -> bool:
    return np.shape(value) == shape and np.isfinite(np.array(value, np.float64)).all()


def test_locate_prints_json_of_the_promised_form(images: Path, tmp_path: Path) -> None:
    picture = tmp_path / "seen.png"
    content = json.loads(locate(images, 0, "--json", "--picture", picture, command=stereo_pick))
    assert "left" in content["frame"]
    assert "raw" in content["frame"]
    assert len(content["objects"]) == 4
    for each in content["objects"]:
        assert is_numbers(each["position_m"], 3)
        assert is_numbers(each["covariance_m2"], 3, 3)
        assert np.linalg.eigvalsh(each["covariance_m2"]).min() > 0
        assert np.allclose(each["covariance_m2"], np.transpose(each["covariance_m2"]))
        assert within(np.array([each["covariance_m2"]]), content["tolerance_m"]) == pytest.approx(each["confidence"])
        assert is_numbers(each["ray_gap_m"])
        assert 0 <= each["ray_gap_m"] < 0.01
        assert is_numbers(each["size_m"], 3)
        assert is_numbers(each["orientation_xyzw"], 4)
        assert each["kind"] in KINDS
        left_px, right_px = RIG.project([each["position_m"]])
        assert np.abs(left_px[0] - each["left_px"]).max() < 2, "left_px are raw pixels"
        assert np.abs(right_px[0] - each["right_px"]).max() < 2, "right_px are raw pixels"
    for each in content["refused"]:
        assert each["reason"] in REASONS
        assert each["meaning"] == REASONS[each["reason"]]
        assert any(is_numbers(each[side], 2) for side in ("left_px", "right_px"))
        assert all(each[side] is None or is_numbers(each[side], 2) for side in ("left_px", "right_px"))
    drawn = cv2.imread(str(picture))
    assert drawn is not None
    assert drawn.shape == (480, 1280, 3)


@pytest.mark.parametrize("method", ["feature", "ssd"])
def test_locate_prints_the_same_as_a_table_in_millimetres(images: Path, method: str) -> None:
    text = locate(images, 0, "--method", method)
    objects = json.loads(locate(images, 0, "--method", method, "--json"))["objects"]
    for number, each in enumerate(objects, start=1):
        x, y, z = (f"{value * 1000:.2f}" for value in each["position_m"])
        start = rf"^ *{number} +{re.escape(x)} +{re.escape(y)} +{re.escape(z)}"
        assert re.search(rf"{start} +[0-9.]+ +{each['confidence']:.4f} ", text, re.M)


def test_replay_gives_for_each_pair_what_locate_gives(images: Path, offline: list[dict[str, Any]]) -> None:
    assert [line["stamp_ns"] for line in offline] == Recording.of(RIG, *[(None, None)] * COUNT).stamps_ns()
    single = json.loads(locate(images, 1, "--json"))
    assert set(offline[1]) == set(single)
    for one, other in zip(offline[1]["objects"], single["objects"], strict=True):
        assert set(one) == set(other)
        assert np.allclose(one["position_m"], other["position_m"], rtol=0, atol=1e-6)
    assert [each["reason"] for each in offline[1]["refused"]] == [each["reason"] for each in single["refused"]]


def test_replay_writes_lines_or_a_bag_with_the_poses_in_it(
    bag: Path, offline: list[dict[str, Any]], tmp_path: Path
) -> None:
    lines, poses = tmp_path / "poses.jsonl", tmp_path / "poses.mcap"
    for output, command in ((lines, stereo_pick_here), (poses, stereo_pick)):
        done = command("replay", bag, "--output", output)
        assert (done.status, done.stdout, done.stderr) == (0, "", "")
    assert [json.loads(line) for line in lines.read_text().splitlines()] == offline
    assert sorted(path.name for path in tmp_path.iterdir()) == ["poses.jsonl", "poses.mcap"]
    assert recorded(poses, without="/object_poses") == recorded(bag)
    for array, line in zip(pose_arrays(poses), offline, strict=True):
        assert array.header.frame_id == "left_eye"
        assert array.header.stamp.sec * 10**9 + array.header.stamp.nanosec == line["stamp_ns"]
        positions = [[p.position.x, p.position.y, p.position.z] for p in array.poses]
        assert positions == [each["position_m"] for each in line["objects"]]
    again = stereo_pick_here("replay", bag, "--output", poses)
    assert f"{poses} exists already" in again.error
    of_own = stereo_pick_here("replay", poses, "--output", tmp_path / "more.mcap")
    assert f"{poses} holds /object_poses already: give the recording without poses" in of_own.error
    assert sorted(path.name for path in tmp_path.iterdir()) == ["poses.jsonl", "poses.mcap"]


def test_a_bag_with_poses_takes_the_place_of_nothing_beside_it(bag: Path, tmp_path: Path) -> None:
    notes = tmp_path / "poses.writing" / "notes.txt"
    notes.parent.mkdir()
    notes.write_text("the only copy")
    done = stereo_pick_here("replay", bag, "--output", tmp_path / "poses.mcap")
    assert (done.status, done.stderr) == (0, "")
    assert notes.read_text() == "the only copy"
    assert sorted(path.name for path in tmp_path.iterdir()) == ["poses.mcap", "poses.writing"]
    line = stereo_pick_here("replay", bag, "--output", "/proc/poses.mcap").error
    assert "--output /proc/poses.mcap cannot be written: No such file or directory" in line


def recorded(bag: Path, without: str = "") -> list[tuple[str, int, bytes]]:
    with AnyReader([bag]) as reader:
        return [(c.topic, time_ns, bytes(raw)) for c, time_ns, raw in reader.messages() if c.topic != without]


def pose_arrays(bag: Path) -> list[Any]:
    with AnyReader([bag]) as reader:
        return [reader.deserialize(raw, c.msgtype) for c, _, raw in reader.messages() if c.topic == "/object_poses"]


def test_replay_takes_a_folder_and_another_method(images: Path, bag: Path) -> None:
    of_folder = stereo_pick_here("replay", images, "--calibration", DEMO_RIG, "--method", "ssd")
    of_bag = stereo_pick_here("replay", bag, "--calibration", DEMO_RIG, "--method", "ssd")
    assert of_folder.status == of_bag.status == 0
    parsed = [[json.loads(line) for line in done.stdout.splitlines()] for done in (of_folder, of_bag)]
    assert [line["objects"] for line in parsed[0]] == [line["objects"] for line in parsed[1]]
    assert {line["method"] for line in parsed[0]} == {"ssd"}


def deep(view: Any) -> Any:
    """The same picture as a camera of 12 bits takes it: in 16 bits, white is 4080."""
    return view.astype("<u2") * 16


def deep_bag(path: Path) -> Path:
    pairs = [
        [ImageBuffer(640, 480, 1280, "mono16", False, deep(view).tobytes()) for view in p] for p in demo_pairs(COUNT)
    ]
    return Recording.of(RIG, *[(left, right) for left, right in pairs]).write(path)


def test_images_of_a_12_bit_camera_give_the_same(images: Path, offline: list[dict[str, Any]], tmp_path: Path) -> None:
    folder = write_images(tmp_path / "deep", [(deep(left), deep(right)) for left, right in demo_pairs(COUNT)])
    bag = deep_bag(tmp_path / "bag")
    files, calibration = [folder / "left01.png", folder / "right01.png"], ("--calibration", DEMO_RIG)
    located = stereo_pick_here("locate", *files, *calibration, "--json", "--full-scale-16", "4080")
    assert json.loads(located.stdout)["objects"] == json.loads(locate(images, 1, "--json"))["objects"]
    replayed = stereo_pick_here("replay", bag, "--full-scale-16", "4080")
    assert [json.loads(line) for line in replayed.stdout.splitlines()] == offline
    replayed = stereo_pick_here("replay", folder, *calibration, "--full-scale-16", "4080")
    assert replayed.stdout == stereo_pick_here("replay", images, *calibration).stdout
    wrong = stereo_pick_here("locate", *files, *calibration, "--full-scale-16", "0")
    assert "full_scale_16 = 0 is outside its range 1 .. 65535" in wrong.error


def shown(output: str) -> list[tuple[float, list[list[float]]]]:
    """The stamp and the positions [mm] of each line that `run` prints."""
    found = []
    for line in output.splitlines():
        match = re.match(r"(\d+\.\d+) left_eye +(.*)", line)
        if match:
            parts = re.split(r"\s*\d+: ", match[2])[1:]
            found.append((float(match[1]), [[float(value) for value in part.split()] for part in parts]))
    return found


def in_millimetres(line: dict[str, Any]) -> tuple[float, list[list[float]]]:
    positions = [[round(value * 1000, 1) for value in each["position_m"]] for each in line["objects"]]
    return line["stamp_ns"] / 1e9, positions


def check_shown(lines: Sequence[Any], offline: Sequence[dict[str, Any]]) -> None:
    expected = dict(map(in_millimetres, offline))
    for stamp, positions in lines:
        assert np.allclose(positions, expected[stamp], rtol=0, atol=0.101)


def test_run_shows_every_pair_and_ends_with_the_recording(
    offline: list[dict[str, Any]], system: System, tmp_path: Path
) -> None:
    bag = deep_bag(tmp_path / "bag")
    child = system.start_command("run", "--source", str(bag), "--rate", "0.2", "--full-scale-16", "4080")
    assert child.wait() == 0
    lines = shown(child.output)
    check_shown(lines, offline)
    assert [stamp for stamp, _ in lines] == [line["stamp_ns"] / 1e9 for line in offline]
    assert child.output.splitlines()[-1] == f"{COUNT} pose arrays received for {COUNT} pairs"


@pytest.mark.parametrize(
    ("number", "more"),
    [(signal.SIGINT, []), *first_of((signal.SIGTERM, ["--one-process"]), (signal.SIGHUP, ["--one-process"]))],
)
def test_run_loops_until_a_signal_and_leaves_no_process(
    bag: Path, offline: list[dict[str, Any]], system: System, number: signal.Signals, more: list[str]
) -> None:
    before = signal.signal(signal.SIGHUP, signal.SIG_DFL)  # under nohup the command would take none, and rightly so
    child = system.start_command("run", "--source", str(bag), "--rate", "0.5", "--loop", *more)
    signal.signal(signal.SIGHUP, before)
    system.graph.wait(lambda: len(shown(child.output)) > COUNT, f"more than one round: {child.output}")
    status, seconds = child.end(number)
    assert status == 0, child.output
    assert is_prompt(seconds)
    check_shown(shown(child.output), offline)
    assert re.search(r"^\d+ pose arrays received$", child.output.splitlines()[-1])
    assert "rror" not in child.output
    assert processes_in(system.domain) == []


def test_a_second_run_in_one_domain_is_refused_and_the_first_goes_on(bag: Path, system: System) -> None:
    first = system.start_command("run", "--source", str(bag), "--rate", "0.02", "--loop", "--one-process")
    system.graph.wait(lambda: shown(first.output), f"poses: {first.output}")
    second = system.start_command("run", "--source", str(bag))
    assert second.wait() == 1
    assert re.search(rf"publishes /(object_poses|\w+/image_raw) in ROS domain {system.domain}", second.output)
    assert f"ROS_DOMAIN_ID={system.domain + 1}" in second.output
    count = len(shown(first.output))
    system.graph.wait(lambda: len(shown(first.output)) > count, f"more poses: {first.output}")
    status, _ = first.end(signal.SIGINT)
    assert status == 0 and "rror" not in first.output


def test_nodes_end_when_what_started_them_was_killed(bag: Path, system: System) -> None:
    child = system.start_command("run", "--source", str(bag), "--rate", "0.5", "--loop", "--one-process")
    system.graph.wait(lambda: shown(child.output), f"poses: {child.output}")
    child.end(signal.SIGKILL)
    system.graph.wait(lambda: not processes_in(system.domain), "end of all nodes")


def processes_in(domain: int) -> list[str]:
    """Commands of other processes of this ROS domain."""
    found = []
    for entry in Path("/proc").glob("[0-9]*"):
        try:
            inside = f"ROS_DOMAIN_ID={domain}\0".encode() in (entry / "environ").read_bytes()
            command = (entry / "cmdline").read_bytes().replace(b"\0", b" ").decode()
        except OSError:
            continue
        if inside and "stereo_pick.ros." in command and int(entry.name) != os.getpid():
            found.append(command)
    return found


@pytest.mark.first
def test_the_demo_ends_with_its_verdict(tmp_path: Path) -> None:
    done = stereo_pick("demo", "--output", tmp_path / "out")  # in a domain that no test reserves
    assert (done.status, done.stderr) == (0, ""), done.stdout
    *_, drawn, verdict = done.stdout.splitlines()
    assert verdict.startswith("demo: OK: 24 of 24 pairs, 96 objects found, 0 missed, 0 ghosts; ")
    picture = cv2.imread(drawn.removeprefix("annotated picture: "))
    assert picture is not None
    assert picture.shape == (480, 1280, 3)
    rows = [line for line in done.stdout.splitlines() if re.match(r" +\d+\.\d{3} (mover|cylinder|box|ball) ", line)]
    assert len(rows) >= 96  # and those of a first run, where this machine was too busy
    assert all(float(row.split()[-1]) < 3 for row in rows)


@pytest.mark.parametrize(("heard", "says"), [(None, "received\n"), (COUNT, f"received for {COUNT} pairs\n")])
def test_run_says_nothing_of_pairs_where_capture_was_not_heard(
    heard: int | None, says: str, bag: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(run, "run_chain", lambda *_args, **_more: Outcome(heard, COUNT, 4 * COUNT, (), False))
    assert main(["run", "--source", str(bag)]) == 0
    assert capsys.readouterr() == (f"{COUNT} pose arrays {says}", "")


@pytest.mark.parametrize(("heard", "advised"), [(119, "0.5"), (10, "0.083"), (0, "0.01")])
def test_run_advises_a_rate_at_which_all_pairs_come_through(
    heard: int, advised: str, bag: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(run, "run_chain", lambda *_args, **_more: Outcome(120, heard, heard, (), False))
    assert main(["run", "--source", str(bag)]) == 0
    assert f"too slow for 120 pairs at rate 1; use --rate {advised} or less" in capsys.readouterr().err


def test_a_folder_that_cannot_be_made_is_named_by_the_demo(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("kept")
    for output, reason in ((tmp_path / "file", "File exists"), (tmp_path / "file" / "out", "Not a directory")):
        line = stereo_pick_here("demo", "--output", output).error
        assert f"--output {output} cannot be made: {reason}; name a folder" in line
    assert (tmp_path / "file").read_text() == "kept"


@pytest.mark.parametrize("stopped", [False, True])
def test_the_demo_goes_slower_where_pairs_were_lost_but_not_after_ctrl_c(
    stopped: bool, monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    rates: list[float] = []

    def run_chain(capture: dict[str, Any], _values: dict[str, Any], show: Callable[..., None]) -> Outcome:
        rates.append(capture["rate"])
        truth = demo.load_truth(demo.find_bags() / "demo_truth.json")
        for stamp_ns, objects in list(truth.items())[len(rates) == 1 :]:
            show(stamp_ns, "left_eye", list(objects.values()))
        return Outcome(0, 0, 0, (), stopped)

    monkeypatch.setattr(demo, "run_chain", run_chain)
    monkeypatch.setenv("ROS_DOMAIN_ID", "0")
    status = main(["demo", "--output", str(tmp_path)])
    assert status == 0 and len(rates) == (1 if stopped else 2)
    assert sorted(rates, reverse=True) == rates
    printed = capsys.readouterr().out
    assert ("23 of 24 pairs came through: this machine is busy" in printed) == (not stopped)
    assert (printed.splitlines()[-1] == "demo: stopped after 23 of 24 pairs") == stopped
    assert "FAILED" not in printed


def test_a_demo_that_is_stopped_before_it_plays_has_not_failed(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    def stopped(self: Pipeline, frame: StereoFrame) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(Pipeline, "run", stopped)
    monkeypatch.setenv("ROS_DOMAIN_ID", "0")
    assert main(["demo", "--output", str(tmp_path)]) == 0
    assert capsys.readouterr().out == "demo: stopped before the first pair\n"


def test_the_demo_keeps_its_poses_out_of_the_domain_that_is_set(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """A robot's terminal has ROS_DOMAIN_ID set, and its controller would take the demo's poses for its own."""
    played: list[tuple[str, str]] = []

    def run_chain(*_: object) -> Outcome:
        played.append((os.environ["ROS_DOMAIN_ID"], os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"]))
        return Outcome(0, 0, 0, (), True)

    monkeypatch.setattr(demo, "run_chain", run_chain)
    monkeypatch.setattr(demo, "_draw", lambda *_: 1.0)
    for domain in ("7", *map(str, range(91, 101))):
        monkeypatch.setenv("ROS_DOMAIN_ID", domain)
        monkeypatch.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "SUBNET")
        assert main(["demo", "--output", str(tmp_path)]) == 0
        own, discovery = played.pop()
        assert own != domain and discovery == "LOCALHOST"


@given(pair_s=st.floats(1e-3, 1e3), count=st.integers(1, 100))
def test_the_demo_plays_no_faster_than_nodes_keep_up(pair_s: float, count: int) -> None:
    rate = demo.rate_for([n * 33_333_333 for n in range(count)], pair_s)
    assert 0.01 <= rate <= 0.1
    assert rate == 0.01 or count == 1 or 0.033_333_333 / rate > 1.2 * pair_s


def test_a_terminal_that_lacks_a_letter_gets_its_code(tmp_path: Path) -> None:
    output = tmp_path / os.fsdecode(b"b\xf6ard.svg")
    for encoding, name in (("ascii", r"b\udcf6ard.svg"), ("utf-8:strict", r"b\udcf6ard.svg")):
        done = stereo_pick(
            *("board", "--board", "9x6", "--square", "0.02", "--output", output),
            env={**os.environ, "PYTHONIOENCODING": encoding},
        )
        assert (done.status, done.stderr) == (0, "")
        assert name in done.stdout


@pytest.mark.parametrize("command", ["", "run", "locate", "replay", "calibrate", "parameters", "demo"])
def test_help_says_what_it_does_and_how(command: str, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as ended:
        main([command, "--help"] if command else ["--help"])
    assert ended.value.code == 0
    text = capsys.readouterr().out
    assert len(text) > 200
    if command in ("run", "locate", "replay", "calibrate"):
        assert f"stereo-pick {command} " in text.partition("example")[2]
    options = re.findall(r"^  (--[a-z-]+)(.*(?:\n {10,}.*)*)", text, re.M)
    assert [name for name, meaning in options if len(meaning.split()) < 3] == []


def test_a_wrong_command_line_ends_with_status_2() -> None:
    done = stereo_pick("locate", "only_one.png")
    assert done.status == 2
    assert "usage: stereo-pick locate" in done.stderr


@pytest.mark.parametrize(
    "arguments",
    [("run", "--source", "nothing"), ("replay", "nothing"), ("locate", "a.png", "b.png", "--calibration", "nothing")],
)
def test_what_is_refused_ends_the_process_with_status_1_and_one_line(arguments: tuple[str, ...]) -> None:
    done = stereo_pick(*arguments)
    assert "nothing" in done.error and done.stdout == ""


@pytest.mark.parametrize(
    "missing",
    [
        ModuleNotFoundError("No module named 'rclpy'", name="rclpy"),
        ImportError("librcl.so: cannot open\nThe C extension 'rclpy' failed", name="_rclpy_pybind11"),
    ],
)
def test_without_ros_it_is_asked_for(
    missing: ImportError, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def absent() -> None:
        raise missing

    monkeypatch.setattr("stereo_pick.cli.parameters.nodes", absent)
    assert main(["parameters"]) == 1
    error = capsys.readouterr().err
    assert re.fullmatch(
        r"stereo-pick: error: this needs ROS 2 for Python 3\.\d+ \(.*(rclpy|librcl).*\): source its .*\n", error
    )


@pytest.mark.parametrize("name", [None, "_rclpy_pybind11"])
def test_ctrl_c_while_ros_is_imported_is_no_error(
    name: str | None, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """A C extension makes an ImportError of it."""

    def interrupted() -> None:
        raise ImportError("initialization failed", name=name) from KeyboardInterrupt()

    monkeypatch.setattr("stereo_pick.cli.parameters.nodes", interrupted)
    assert main(["parameters"]) == 130
    assert capsys.readouterr().err == ""


def test_a_full_disk_is_one_line_and_status_1(tmp_path: Path) -> None:
    """What fits into Python's buffer fails at the very end."""
    board = ("board", "--board", "9x6", "--square", "0.02", "--output", str(tmp_path / "board.svg"))
    with Path("/dev/full").open("w") as full:
        command = [sys.executable, "-m", "stereo_pick.cli.main", *board]
        done = subprocess.run(command, stdout=full, stderr=subprocess.PIPE, text=True, timeout=150, check=False)
    assert done.returncode == 1
    assert done.stderr == "stereo-pick: error: standard output: No space left on device\n"
