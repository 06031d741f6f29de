"""The calibration node as a process, fed by a replayed bag: it ends as the command does that reads the bag itself."""

from __future__ import annotations

import signal
from collections.abc import Callable
from pathlib import Path
from typing import Any

import cv2
import pytest
from board_bags import BOARD, GREY, Pairs, rendered_pairs, write_bag
from ros_tools import Child, System, stereo_pick
from std_srvs.srv import Trigger

from stereo_pick.core.arrays import Image
from stereo_pick.ros.messages.diagnostics import ERROR, OK, WARN
from stereo_pick.ros.topics import CALIBRATION_ANNOTATED, SIDES

FILES = ("left.yaml", "right.yaml", "stereo.yaml", "calibration.yaml")


@pytest.fixture(scope="module")
def pairs(render_board: Callable[..., Image]) -> Pairs:
    """Ten views, each held for a while; some without a board, some blurred."""
    rendered = rendered_pairs(render_board)
    held = [pair for pair in rendered for _ in range(2)]
    blurred = [tuple(cv2.GaussianBlur(picture[:, ::-1], (0, 0), 3) for picture in pair) for pair in rendered[:2]]
    return [(GREY, GREY), *held, *blurred]


def lossless(end: str) -> list[str]:
    """Arguments with which no image gets lost on its way from a publisher to a subscription."""
    topics = [f"qos_overrides./{side}/image_raw.{end}" for side in SIDES]
    settings = [f"{topic}.{setting}" for topic in topics for setting in ("reliability:=reliable", "depth:=100")]
    return [part for setting in settings for part in ("-p", setting)]


def start(system: System, folder: Path, **values: Any) -> Child:
    """Start the node; with so many that may wait nothing is left out, however slow this machine is."""
    options = {"board": f"chessboard:{BOARD}", "square_m": BOARD.square_m, "output": folder, "max_waiting": 1000}
    return system.start_node("calibration", {**options, **values}, lossless("subscription"))


def replay(system: System, bag: Path, rate: float = 1.0) -> Child:
    empty = system.folder / "no_calibration_yet"
    empty.mkdir(exist_ok=True)
    values = {"source": bag, "calibration": empty, "rate": rate, "wait_for_subscribers_s": 60.0}
    return system.start_node("capture", values, lossless("publisher"))


def value(system: System, name: str) -> str:
    """A value of the node's last diagnostic; empty where there is none."""
    found = ""
    for array in system.graph.diagnostics:
        for status in array.status:
            if status.name == "stereo_pick: calibration":
                found = {each.key: each.value for each in status.values}.get(name, "")
    return found


def call(system: System, name: str) -> Trigger.Response:
    return system.graph.ask(Trigger, f"calibration/{name}", Trigger.Request())


def test_a_replayed_bag_ends_with_the_files_of_the_offline_command(
    system: System, pairs: Pairs, tmp_path: Path
) -> None:
    bag, live, offline = write_bag(tmp_path / "bag", pairs), tmp_path / "live", tmp_path / "offline"
    node = start(system, live)
    pictures = system.graph.listen(CALIBRATION_ANNOTATED)
    system.graph.wait_for_status("calibration", WARN, "no image on", "cameras running")
    assert not call(system, "save").success
    assert replay(system, bag, rate=2.0).wait() == 0
    system.graph.wait(lambda: value(system, "looked_at") == str(len(pairs)), "all pairs looked at")
    assert value(system, "views") == "10"
    assert value(system, "not_looked_at") == "0"
    system.graph.wait_for_status("calibration", WARN, "10 views kept", "5 more views", "left image's")
    finished = call(system, "finish")
    assert finished.success, finished.message
    assert "10 of 10 views used, rms 0." in finished.message
    assert "baseline 6" in finished.message
    assert not live.exists()
    saved = call(system, "save")
    assert saved.success, saved.message
    assert str(live / "left.yaml") in saved.message
    done = stereo_pick(
        *("calibrate", "--bag", bag, "--board", str(BOARD), "--square", str(BOARD.square_m), "--output", offline)
    )
    assert done.status == 0, done.stderr
    for name in FILES:
        assert (live / name).read_text() == (offline / name).read_text(), name
    assert (live / "calibration_report.html").read_text() == (offline / "calibration_report.html").read_text()
    assert {(picture.width, picture.height) for picture in pictures} == {(640, 240)}
    assert node.end()[0] == 0


def test_a_recording_of_one_camera_is_refused_and_nothing_saved(system: System, pairs: Pairs, tmp_path: Path) -> None:
    same = [(left, left) for left, _ in pairs]
    start(system, tmp_path / "live")
    replay(system, write_bag(tmp_path / "bag", same), rate=4.0)
    system.graph.wait(lambda: value(system, "looked_at") == str(len(same)), "all pairs looked at")
    finished = call(system, "finish")
    assert not finished.success
    assert finished.message.startswith("refused: ")
    assert "from the same place" in finished.message
    saved = call(system, "save")
    assert not saved.success
    assert "from the same place" in saved.message
    assert [path.name for path in (tmp_path / "live").iterdir()] == ["calibration_report.html"]


def test_pairs_that_come_too_fast_are_counted(system: System, tmp_path: Path, pairs: Pairs) -> None:
    start(system, tmp_path / "live", max_waiting=1)
    many = [(GREY, GREY), *pairs] * 4
    replay(system, write_bag(tmp_path / "bag", many), rate=100.0)
    system.graph.wait_for_status("calibration", WARN, "pairs were not looked at")
    system.graph.wait(
        lambda: int(value(system, "looked_at") or 0) + int(value(system, "not_looked_at") or 0) == len(many),
        "every pair is accounted for",
    )


def test_without_a_board_finish_says_what_to_check(system: System, tmp_path: Path) -> None:
    node = start(system, tmp_path / "live")
    replay(system, write_bag(tmp_path / "bag", [(GREY, GREY)] * 3), rate=4.0)
    system.graph.wait(lambda: value(system, "looked_at") == "3", "all pairs looked at")
    finished = call(system, "finish")
    assert not finished.success
    assert "no chessboard of 7x5 inner corners found in both images of any of 3 pairs: count" in finished.message
    assert node.end(signal.SIGTERM)[0] == 0


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"board": ""}, "parameter board is empty"),
        ({"board": "circles:4x4"}, "board 'circles:4x4' is not understood"),
        ({"square_m": 0.0}, "parameter square_m is 0"),
        ({"square_m": 30.0}, "square_m must be within 0 .. 1"),
        ({"output": ""}, "parameter output is empty"),
        ({"output": __file__}, "is a file: name a folder"),
        ({"output": f"{__file__}/rig"}, f"cannot be made: {__file__} is a file"),
    ],
)
def test_what_nobody_can_guess_must_be_given(
    system: System, tmp_path: Path, values: dict[str, Any], message: str
) -> None:
    child = start(system, tmp_path / "live", **values)
    assert child.wait() == 1
    (line,) = [line for line in child.output.splitlines() if "[rcl]:" not in line]
    assert line.startswith("stereo-pick: error: ")
    assert message in line


def test_images_of_another_size_are_named_and_left_out(system: System, tmp_path: Path, pairs: Pairs) -> None:
    start(system, tmp_path / "live")
    smaller = tuple(cv2.resize(picture, (160, 120)) for picture in pairs[1])
    replay(system, write_bag(tmp_path / "bag", [*pairs[1:4], smaller]), rate=4.0)
    system.graph.wait_for_status("calibration", ERROR, "left at 0.60 s is 160 x 120, but left at 0.00 s is 320 x 240")


def test_a_signal_ends_the_node_while_it_calibrates(system: System, tmp_path: Path, pairs: Pairs) -> None:
    node = start(system, tmp_path / "live")
    replay(system, write_bag(tmp_path / "bag", pairs), rate=10.0)
    system.graph.wait(lambda: value(system, "looked_at") == str(len(pairs)), "all pairs looked at")
    client = system.graph.node.create_client(Trigger, "calibration/finish")
    system.graph.wait(client.service_is_ready, "service")
    client.call_async(Trigger.Request())
    system.graph.forget_statuses()
    system.graph.wait_for_status("calibration", OK, "calibrating from 10 views")
    assert node.end()[0] == 0
    assert not (tmp_path / "live").exists()
