"""set_camera_info of the capture node, called as ROS's camera_calibration calls it: left, then right."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import rigs
from recordings import Recording, write_images
from ros_tools import Graph, reserved_domain
from sensor_msgs.srv import SetCameraInfo

import stereo_pick.ros.node as node_module
from stereo_pick.core.calibration.files import load_cameras, load_rig, save_rig
from stereo_pick.core.calibration.fingerprint import calibration_hash
from stereo_pick.core.camera import Camera
from stereo_pick.core.rig import StereoRig
from stereo_pick.ros.messages.cameras import camera_info_message, camera_of, content
from stereo_pick.ros.messages.diagnostics import OK, WARN
from stereo_pick.ros.nodes.capture import CaptureNode
from stereo_pick.ros.topics import CAMERA_INFO, IMAGE_RAW, SIDES

OLD, NEW = rigs.RIGS["verged"], rigs.RIGS["parallel"]
PAIR = (np.full((480, 640), 40, np.uint8), np.full((480, 640), 140, np.uint8))


@pytest.fixture(autouse=True)
def frequent_diagnostics(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(node_module, "_DIAGNOSTICS_PERIOD_S", 0.1)


class Capture:
    """A capture node that replays two pairs for ever, and what it publishes."""

    def __init__(self, graph: Graph) -> None:
        self.graph = graph
        self.infos: dict[str, list[Any]] = {side: graph.listen(CAMERA_INFO[side]) for side in SIDES}
        self.images = {side: graph.listen(IMAGE_RAW[side]) for side in SIDES}
        graph.host(CaptureNode(graph.context))
        graph.wait(lambda: self.images["right"], "the first images")

    def set(self, side: str, camera: Camera, service: str = "") -> tuple[bool, str]:
        request = SetCameraInfo.Request(camera_info=camera_info_message(camera, 0, ""))
        answer = self.graph.ask(SetCameraInfo, service or f"{side}/set_camera_info", request)
        assert "\n" not in answer.status_message
        return answer.success, answer.status_message

    def published(self) -> set[tuple[Any, ...]]:
        """The pairs of camera_info (their contents) of one stamp that came since the last question."""
        by_stamp: dict[tuple[int, int], dict[str, Any]] = {}
        for side in SIDES:
            for message in self.infos[side]:
                stamp = message.header.stamp
                by_stamp.setdefault((stamp.sec, stamp.nanosec), {})[side] = content(message)
        return {(pair["left"], pair["right"]) for pair in by_stamp.values() if len(pair) == 2}

    def wait_for(self, rig: StereoRig) -> None:
        wanted = tuple(content(camera_info_message(camera, 0, "")) for camera in (rig.left, rig.right))
        self.graph.wait(lambda: wanted in self.published(), "the new camera_info")


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    save_rig(OLD, tmp_path / "rig")
    return tmp_path / "rig"


@pytest.fixture
def start(tmp_path: Path) -> Iterator[Any]:
    """Starts a capture node on a folder of images with these parameters."""
    images = write_images(tmp_path / "images", [PAIR, PAIR])
    with reserved_domain() as domain:
        graphs: list[Graph] = []

        def started(*ros_args: str, source: Path = images) -> Capture:
            given = [f"source:={source}", "loop:=true", "folder_rate_hz:=50.0"]
            args = [part for each in given for part in ("-p", each)]
            graphs.append(Graph(domain, [*args, *ros_args]))
            return Capture(graphs[0])

        yield started
        for graph in graphs:
            graph.close()


def test_left_then_right_are_saved_and_published_together(start: Any, folder: Path) -> None:
    capture = start("-p", f"calibration:={folder}")
    capture.wait_for(OLD)
    success, told = capture.set("left", NEW.left)
    assert success
    assert "right/set_camera_info" in told
    capture.graph.wait_for_status("capture", WARN, "call right/set_camera_info", "the calibration before is published")
    assert calibration_hash(load_rig(folder)) == calibration_hash(OLD)
    capture.graph.forget_statuses()
    assert capture.set("right", NEW.right) == (
        True, f"saved in {folder}; published for both cameras from the next pair on"
    )  # fmt: skip
    capture.wait_for(NEW)
    of = {calibration_hash(rig) for rig in (OLD, NEW)}
    for left, right in zip(*(capture.infos[side] for side in SIDES)):
        if left.header.stamp == right.header.stamp:
            pair = StereoRig.from_cameras(camera_of(left, "left"), camera_of(right, "right"))
            assert calibration_hash(pair) in of
    assert calibration_hash(load_rig(folder)) == calibration_hash(NEW)
    np.testing.assert_array_equal(load_cameras(folder)[1].P, NEW.right.P)
    capture.graph.wait_for_status("capture", OK, "replaying")


def test_the_diagnostics_tell_the_hash_of_what_is_published(start: Any, folder: Path) -> None:
    capture = start("-p", f"calibration:={folder}")

    def told(rig: StereoRig) -> bool:
        values = [each for array in capture.graph.diagnostics for status in array.status for each in status.values]
        return calibration_hash(rig) in {each.value for each in values if each.key == "calibration_hash"}

    capture.graph.wait(lambda: told(OLD), "the first hash")
    assert not told(NEW)
    for side in SIDES:
        capture.set(side, getattr(NEW, side))
    capture.graph.wait(lambda: told(NEW), "the second hash")


def test_millimetres_are_refused_with_their_value(start: Any, folder: Path) -> None:
    capture = start("-p", f"calibration:={folder}")
    P = NEW.right.P.copy()
    P[0, 3] *= 1000
    success, told = capture.set("right", replace(NEW.right, P=P))
    assert not success
    assert "baseline = 80.0 m is longer than 5 m: the calibration is in millimetres" in told


def test_an_uncalibrated_camera_info_is_refused(start: Any, folder: Path) -> None:
    capture = start("-p", f"calibration:={folder}")
    request = SetCameraInfo.Request()
    request.camera_info.width, request.camera_info.height = 640, 480
    answer = capture.graph.ask(SetCameraInfo, "left/set_camera_info", request)
    assert not answer.success
    assert "focal length K[0,0] = 0" in answer.status_message


def test_an_empty_folder_waits_for_its_calibration(start: Any, tmp_path: Path) -> None:
    (tmp_path / "new").mkdir()
    capture = start("-p", f"calibration:={tmp_path / 'new'}")
    capture.graph.wait_for_status("capture", WARN, "no calibration yet: call left/set_camera_info")
    assert capture.infos == {"left": [], "right": []}
    for side in SIDES:
        assert capture.set(side, getattr(NEW, side))[0]
    capture.wait_for(NEW)
    assert calibration_hash(load_rig(tmp_path / "new")) == calibration_hash(NEW)


def test_a_recordings_own_camera_info_has_no_place_to_be_saved(start: Any, tmp_path: Path) -> None:
    bag = Recording.of(OLD, PAIR, PAIR).write(tmp_path / "bag")
    capture = start(source=bag)
    success, told = capture.set("left", NEW.left)
    assert not success
    assert f"the camera_info is that of {bag}; start capture with the parameter calibration set to a folder" in told


def test_the_services_lie_in_the_cameras_namespaces_and_can_be_remapped(folder: Path, tmp_path: Path) -> None:
    images = write_images(tmp_path / "images", [PAIR])
    names = ["-r", "__ns:=/cell", "-r", "right/set_camera_info:=/camera_b/set_camera_info"]
    with reserved_domain() as domain:
        graph = Graph(domain, [*names, "-p", f"source:={images}", "-p", f"calibration:={folder}"])
        graph.host(CaptureNode(graph.context))

        def services() -> set[str]:
            return {name for name, kinds in graph.node.get_service_names_and_types() if "SetCameraInfo" in kinds[0]}

        graph.wait(lambda: services() == {"/cell/left/set_camera_info", "/camera_b/set_camera_info"}, "both services")
        graph.close()


def test_a_record_of_the_calibration_before_is_told(start: Any, folder: Path) -> None:
    (folder / "calibration.yaml").write_text("format: another\n")
    capture = start("-p", f"calibration:={folder}")
    capture.graph.wait_for_status("capture", WARN, "calibration.yaml: is no 'stereo_pick calibration 1'")
