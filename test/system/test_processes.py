"""Each node as a process: how it starts, what it tells of a dead camera and a bad image, how signals end it."""

from __future__ import annotations

import os
import signal
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from rclpy.context import Context
from recordings import DEMO_BAG, DEMO_RIG, demo_pairs
from ros_tools import DOWNSTREAM, NODES, System, environment, is_prompt

from stereo_pick.cli.chain import Chain
from stereo_pick.core.calibration.files import load_rig
from stereo_pick.core.errors import ParameterError
from stereo_pick.ros.messages.cameras import camera_info_message
from stereo_pick.ros.messages.diagnostics import ERROR
from stereo_pick.ros.messages.images import image_message
from stereo_pick.ros.process import start_ros
from stereo_pick.ros.shared_memory import PROFILE_VARIABLE
from stereo_pick.ros.topics import CAMERA_INFO, CAMERA_INFO_RECT, IMAGE_RAW, IMAGE_RECT, OBJECT_POSES, SIDES

CONFIG = Path(__file__).parents[2] / "config" / "stereo_pick.yaml"


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_ends_every_node_with_status_0_within_2_s(number: signal.Signals, system: System) -> None:
    values: dict[str, dict[str, Any]] = {name: {} for name in (*NODES, "stereo_pick")}
    values["capture"] = values["stereo_pick"] = {"source": DEMO_BAG, "wait_for_subscribers_s": 3600.0, "loop": True}
    namespaces = {name: "/all" if name == "stereo_pick" else "/apart" for name in values}
    children = {name: system.start_node(name, values[name], ["-r", f"__ns:={namespaces[name]}"]) for name in values}

    def up() -> bool:
        found = {f"{namespace}/{name}" for name, namespace in system.graph.node.get_node_names_and_namespaces()}
        return {f"{namespace}/{name}" for name in NODES for namespace in ("/all", "/apart")} <= found

    system.graph.wait(up, "all nodes are up")
    for name, child in children.items():
        status, seconds = child.end(number)
        assert status == 0, (name, child.output)
        assert is_prompt(seconds), name
        assert "rror" not in child.output


LITTLE_MEMORY = """
import shutil
from types import SimpleNamespace

of_disks = shutil.disk_usage
shutil.disk_usage = lambda path: SimpleNamespace(free={free_bytes}) if path == "/dev/shm" else of_disks(path)
"""

LOADING_FOR_EVER = """
import sys, time

class Slow:
    def find_spec(self, name, path, target=None):
        if name == {module!r}:
            print("loading", flush=True)
            time.sleep(600)

sys.meta_path.insert(0, Slow())
"""


@pytest.mark.parametrize(
    ("number", "start", "module", "status"),
    [
        (signal.SIGINT, "from stereo_pick.ros.executables import capture; sys.exit(capture())", "rclpy", 0),
        (signal.SIGTERM, "from stereo_pick.ros.executables import capture; sys.exit(capture())", "rclpy", 0),
        (signal.SIGINT, "from stereo_pick.cli.main import main; sys.exit(main(['run']))", "cv2", 130),
    ],
)
def test_a_signal_ends_what_still_loads(
    number: signal.Signals, start: str, module: str, status: int, system: System
) -> None:
    child = system.start(sys.executable, "-c", LOADING_FOR_EVER.format(module=module) + start)
    child.wait_for_output("loading")
    assert child.end(number)[0] == status
    assert child.output.strip() == "loading"


DEAF_ONCE = """
import signal

install, calls = signal.signal, []

def deaf_once(number, handler):
    def call(*args):
        calls.append(number)
        if len(calls) > 1:
            handler(*args)
    install(number, call)

signal.signal = deaf_once
"""


@pytest.mark.parametrize("more", ["", DEAF_ONCE], ids=["a node", "one deaf to the first signal"])
def test_a_chain_that_is_stopped_while_a_node_still_loads_ends_it_with_status_0(
    more: str, system: System, tmp_path: Path
) -> None:
    """It ended with a traceback, and one to which the only signal was lost held the command up for 10 s."""
    (tmp_path / "sitecustomize.py").write_text(more + LOADING_FOR_EVER.format(module="rclpy"))
    path = os.pathsep.join([str(tmp_path), os.environ.get("PYTHONPATH", "")])
    with Chain(environment(system.domain, PYTHONPATH=path)) as chain:
        chain.start("triangulation", {})
        system.graph.wait(lambda: "loading" in chain.log("triangulation"), "it loads")
    assert chain.status("triangulation") == 0


LOOKING_FOR_EVER = """
import sys, time
from stereo_pick.core.pipeline import Steps
from stereo_pick.ros.executables import correspondence

def correspond(*_):
    print("looking", flush=True)
    for _ in range(600_000):
        time.sleep(0.001)

Steps.correspond = correspond
sys.exit(correspondence())
"""


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_ends_the_correspondence_node_while_it_looks_at_a_pair(number: signal.Signals, system: System) -> None:
    """A hard pair takes longer than `ros2 launch` waits before it kills."""
    rig, grey = load_rig(DEMO_RIG), np.full((480, 640), 90, np.uint8)
    child, graph = system.start(sys.executable, "-c", LOOKING_FOR_EVER), system.graph
    images = {side: graph.publisher(IMAGE_RECT[side]) for side in SIDES}
    infos = {side: graph.publisher(CAMERA_INFO_RECT[side]) for side in SIDES}

    def looks() -> bool:
        for side in SIDES:
            infos[side].publish(camera_info_message(getattr(rig, side), 10**18, f"{side}_eye"))
            images[side].publish(image_message(grey, 10**18, f"{side}_eye"))
        graph.spin(0.2)
        return "looking" in child.output

    graph.wait(looks, "it looks at a pair")
    status, seconds = child.end(number)
    assert status == 0, child.output
    assert is_prompt(seconds)


def test_cameras_that_are_faster_than_the_search_give_poses(system: System) -> None:
    """At 50 pairs a second, dozens come while one is looked at."""
    rig, (pair,) = load_rig(DEMO_RIG), demo_pairs(1)
    children, graph = [system.start_node(name) for name in DOWNSTREAM], system.graph
    poses = graph.listen(OBJECT_POSES)
    images = {side: graph.publisher(IMAGE_RAW[side]) for side in SIDES}
    infos = {side: graph.publisher(CAMERA_INFO[side]) for side in SIDES}
    noise = np.random.default_rng(0).integers(0, 2, (2, *pair[0].shape), np.uint8)  # else the cameras seem to hang
    stamp = iter(range(10**18, 2 * 10**18, 20_000_000))

    def three_came() -> bool:
        stamp_ns = next(stamp)
        for side, picture, own in zip(SIDES, pair, noise):
            infos[side].publish(camera_info_message(getattr(rig, side), stamp_ns, f"{side}_eye"))
            grey = np.clip(picture, 0, 254) + np.roll(own, stamp_ns // 20_000_000, axis=1)
            images[side].publish(image_message(grey, stamp_ns, f"{side}_eye"))
        graph.spin(0.02)
        return len(poses) >= 3

    graph.wait(three_came, "poses of three pairs")
    assert [len(each.poses) for each in poses] == [4] * len(poses)
    assert [child.end()[0] for child in children] == [0, 0, 0]


def test_a_dead_camera_and_a_cut_image_are_told_and_give_no_pose(system: System) -> None:
    rig, grey = load_rig(DEMO_RIG), np.full((480, 640), 90, np.uint8)
    children = [system.start_node(name) for name in DOWNSTREAM]
    graph = system.graph
    poses = graph.listen(OBJECT_POSES)
    images = {side: graph.publisher(IMAGE_RAW[side]) for side in SIDES}
    infos = {side: graph.publisher(CAMERA_INFO[side]) for side in SIDES}
    stamp = iter(range(10**18, 2 * 10**18, 50_000_000))

    def send(*sides: str) -> None:
        stamp_ns = next(stamp)
        for side in sides:
            message = image_message(grey, stamp_ns, f"{side}_eye")
            if len(sides) == 2 and side == "right":
                message.data = message.data[:1000]
            infos[side].publish(camera_info_message(getattr(rig, side), stamp_ns, f"{side}_eye"))
            images[side].publish(message)
        graph.spin(0.05)

    def told(*parts: str) -> bool:
        level, line = graph.statuses().get("rectification", (b"", ""))
        return level == ERROR and all(part in line for part in parts)

    graph.wait(lambda: (send("left"), told("no image on /right/image_raw", "right camera running"))[1], "dead camera")
    assert "/left/image_raw" not in graph.statuses()["rectification"][1]
    graph.wait(lambda: (send("left", "right"), told("right image", "1000 bytes", "307200"))[1], "cut image")
    assert poses == []
    assert [child.end()[0] for child in children] == [0, 0, 0]
    errors = [line for line in children[-1].output.splitlines() if "rror" in line]
    assert errors == []


@pytest.mark.parametrize(
    ("node", "arguments", "parts"),
    [
        ("correspondence", ["-p", "method:=guess"], ["method = 'guess'", "feature, ssd"]),
        ("triangulation", ["-p", "triangulation.max_ray_gap_m:=5.0"], ["max_ray_gap_m", "0.0001 .. 1"]),
        ("rectification", ["-p", "max_stamp_offset_s:=soon"], ["max_stamp_offset_s", "float"]),
        ("capture", [], ["parameter source is empty", "give a bag"]),
        ("capture", ["-p", "nonsense"], ["nonsense"]),
        ("capture", ["--params-file", "/nowhere.yaml"], ["/nowhere.yaml"]),
        ("capture", ["--unheard-of"], ["--unheard-of"]),
    ],
)
def test_a_bad_parameter_at_the_start_is_one_line_and_status_1(
    node: str, arguments: list[str], parts: list[str], system: System
) -> None:
    child = system.start_node(node, ros_args=arguments)
    assert child.wait() == 1
    (line,) = [line for line in child.output.splitlines() if "[rcl]:" not in line]  # rcl's own log
    assert line.startswith("stereo-pick: error: ")
    for part in parts:
        assert part in line


def test_parameters_without_ros_args_are_refused() -> None:
    """ROS passes over them: without its hand-eye file a node would publish poses in the camera's frame."""
    context = Context()
    try:
        with pytest.raises(ParameterError, match=r"the arguments -p hand_eye_file:=a.yaml: .* after --ros-args"):
            start_ros(context, ["-p", "hand_eye_file:=a.yaml", "--ros-args", "-p", "calibration_file:=b.yaml"])
    finally:
        context.try_shutdown()


def test_a_parameter_that_no_node_has_is_told_of(system: System) -> None:
    of_another_node = {"rate": 1.0, "qos_overrides./left/image_raw.publisher.depth": 3}
    child = system.start_node("triangulation", {"triangulation.max_ray_gap": 0.01, **of_another_node})
    child.wait_for_output(
        "there is no parameter 'triangulation.max_ray_gap'; did you mean triangulation.max_ray_gap_m?"
    )
    assert child.end()[0] == 0
    assert "'rate'" not in child.output and "qos_overrides" not in child.output


def test_the_parameter_file_loads_in_every_node(system: System, tmp_path: Path) -> None:
    text = CONFIG.read_text()
    file = tmp_path / "mine.yaml"
    changes = (('method: "feature"', 'method: "ssd"'), ("full_scale_16: 65535", "full_scale_16: 4095"))
    for before, after in (*changes, ("max_ray_gap_m: 0.01", "max_ray_gap_m: 0.02"), ("rate: 1.0", "rate: 2.5")):
        assert before in text
        text = text.replace(before, after)
    file.write_text(text)
    for name in NODES:
        system.start_node(
            name, {"source": DEMO_BAG, "loop": True} if name == "capture" else {}, ["--params-file", str(file)]
        )
    expected = {
        ("correspondence", "method"): "ssd",
        ("rectification", "full_scale_16"): 4095,
        ("triangulation", "triangulation.max_ray_gap_m"): 0.02,
        ("capture", "rate"): 2.5,
        ("correspondence", "segmentation.min_area_px"): 60,
    }
    for (node, name), value in expected.items():
        assert system.graph.get_parameter(node, name) == value


@pytest.mark.parametrize(("free_bytes", "is_told"), [(30_000_000, True), (40_000_000, False)])
def test_a_node_tells_of_too_little_shared_memory(free_bytes: int, is_told: bool, system: System) -> None:
    """As in a container, of which all have 64 MB: images got lost, and the profile that was there was asked for."""
    start = "from stereo_pick.ros.nodes.rectification import main; main([])"
    node = system.start(sys.executable, "-c", LITTLE_MEMORY.format(free_bytes=free_bytes) + start)
    node.wait_for_output("are the cameras running?")
    assert ("/dev/shm has only 30 MB left" in node.output) == is_told


def test_a_node_and_a_run_tell_of_a_profile_that_is_not_there(system: System, tmp_path: Path) -> None:
    """Fast DDS passes over it, and most images got lost as if there were no profile."""
    absent = tmp_path / "profile.xml"
    told = f"FASTRTPS_DEFAULT_PROFILES_FILE = {absent} names no file"
    for start in ("stereo_pick.ros.nodes.rectification",), ("stereo_pick.cli.main", "run", "--source", str(DEMO_BAG)):
        system.start(sys.executable, "-m", *start, **{PROFILE_VARIABLE: str(absent)}).wait_for_output(told)
