"""The triangulation node with a calibration.yaml and a hand-eye file: frames, covariances, and what does not belong."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import rigs
from rig_files import framed, write_hand_eye, write_record
from ros_tools import Graph, reserved_domain

import stereo_pick.ros.node as node_module
from stereo_pick.core.calibration.fingerprint import calibration_hash
from stereo_pick.core.calibration.record import load_record
from stereo_pick.core.correspondence import Correspondences
from stereo_pick.core.errors import CalibrationError
from stereo_pick.core.pipeline import Steps
from stereo_pick.core.positioning import Positioning
from stereo_pick.core.transform import Transform
from stereo_pick.ros.messages.cameras import camera_info_message
from stereo_pick.ros.messages.correspondences import correspondences_message
from stereo_pick.ros.messages.diagnostics import ERROR, OK, WARN
from stereo_pick.ros.messages.poses import OBJECT_ROW
from stereo_pick.ros.messages.tables import table_of
from stereo_pick.ros.nodes.triangulation import TriangulationNode
from stereo_pick.ros.topics import CAMERA_INFO_RECT, CORRESPONDENCES, OBJECT_MARKERS, OBJECT_POSES, OBJECTS, SIDES

RIG = rigs.RIGS["verged"]
BASE_T_CAMERA = Transform(rigs.rotation((2.2, 0.2, -0.3)), np.array([0.6, -0.2, 0.9]))
POINTS_M = np.array([[0.0, 0.02, 0.9], [0.1, -0.05, 0.85]])


@pytest.fixture(autouse=True)
def frequent_diagnostics(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(node_module, "_DIAGNOSTICS_PERIOD_S", 0.1)


def rows() -> Correspondences:
    left_px, right_px = RIG.project(POINTS_M)
    return Correspondences(
        RIG.left.rectified(left_px),
        RIG.right.rectified(right_px),
        np.full((2, 2), 0.1),
        np.full((2, 2), 20.0),
        np.array([0.3, 1.2]),
    )


class Node:
    """A triangulation node, fed with one pair again and again."""

    def __init__(self, graph: Graph) -> None:
        self.graph = graph
        self.poses, self.objects, self.markers = map(graph.listen, (OBJECT_POSES, OBJECTS, OBJECT_MARKERS))
        graph.host(TriangulationNode(graph.context))
        self._infos = {side: graph.publisher(CAMERA_INFO_RECT[side]) for side in SIDES}
        self._table = graph.publisher(CORRESPONDENCES)
        self._stamp_ns = 0

    def feed_until(self, condition: Callable[[], Any], what: str, frame_id: str = "left_eye") -> None:
        def holds() -> Any:
            self._stamp_ns += 50_000_000
            for side in SIDES:
                self._infos[side].publish(camera_info_message(getattr(RIG, side), self._stamp_ns, f"{side}_eye"))
            self._table.publish(correspondences_message(rows(), self._stamp_ns, frame_id))
            self.graph.spin(0.05)
            return condition()

        self.graph.wait(holds, what)

    def told(self, level: bytes, *parts: str) -> Callable[[], bool]:
        def check() -> bool:
            last, message = self.graph.statuses().get("triangulation", (None, ""))
            return last == level and all(part in message for part in parts)

        return check

    def values(self) -> dict[str, str]:
        status = [each for array in self.graph.diagnostics for each in array.status][-1]
        return {each.key: each.value for each in status.values}


@pytest.fixture
def start() -> Iterator[Callable[..., Node]]:
    with reserved_domain() as domain:
        graphs: list[Graph] = []

        def started(**files: Path) -> Node:
            args = [part for name, path in files.items() for part in ("-p", f"{name}:={path}")]
            graphs.append(Graph(domain, args))
            return Node(graphs[0])

        yield started
        for graph in graphs:
            graph.close()


@pytest.mark.parametrize(("parent", "frame"), [("base", "base_link"), ("flange", "flange")])
def test_poses_come_in_the_hand_eyes_frame_with_the_whole_covariance(
    parent: str, frame: str, start: Callable[..., Node], tmp_path: Path
) -> None:
    record = write_record(RIG, tmp_path)
    known = {"calibration_hash": calibration_hash(RIG), "parent": parent}
    hand_eye = write_hand_eye(tmp_path / "hand_eye.yaml", BASE_T_CAMERA, **known)
    node = start(calibration_file=record, hand_eye_file=hand_eye)
    node.feed_until(lambda: node.poses and node.objects and node.markers, "poses")

    poses = Steps().locate(rows(), RIG, 0)
    expected = Positioning(load_record(record), framed(BASE_T_CAMERA, **known)).place(poses, RIG)
    heads = [message.header for message in (node.poses[-1], node.objects[-1], node.markers[-1].markers[1])]
    assert {head.frame_id for head in heads} == {frame}
    table = table_of(node.objects[-1], OBJECT_ROW)
    for pose, row, xyz, q in zip(node.poses[-1].poses, table, expected.xyz, expected.quaternions()):
        np.testing.assert_allclose([pose.position.x, pose.position.y, pose.position.z], xyz, atol=1e-9)
        turn = pose.orientation
        np.testing.assert_allclose([turn.x, turn.y, turn.z, turn.w], q, atol=1e-9)
        np.testing.assert_allclose([row["x"], row["y"], row["z"]], xyz, atol=1e-9)
    covariance = np.stack([table[f"cov_{a}{b}"] for a in "xyz" for b in "xyz"], axis=1).reshape(-1, 3, 3)
    np.testing.assert_allclose(covariance, expected.covariance, rtol=1e-6)
    np.testing.assert_allclose(table["confidence"], expected.confidence, rtol=1e-6)
    np.testing.assert_allclose(BASE_T_CAMERA.apply(POINTS_M), expected.xyz, atol=1e-6)
    node.feed_until(node.told(OK, "2 objects located"), "it is well")
    assert node.values()["covariance_of"] == "image, calibration, hand_eye"
    assert node.values()["calibration_hash"] == calibration_hash(RIG)


def test_a_file_in_the_users_folder_is_found(
    start: Callable[..., Node], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """No shell puts it in behind `:=`, and a parameter file has none."""
    monkeypatch.setenv("HOME", str(tmp_path))
    write_hand_eye(tmp_path / "hand_eye.yaml", BASE_T_CAMERA)
    node = start(hand_eye_file=Path("~/hand_eye.yaml"))
    node.feed_until(lambda: node.poses, "poses")
    assert node.poses[-1].header.frame_id == "base_link"


def test_without_files_poses_are_the_cameras_and_the_diagnostics_tell_what_the_covariance_lacks(
    start: Callable[..., Node],
) -> None:
    node = start()
    node.feed_until(node.told(OK, "2 objects located"), "it is well")
    assert node.values()["covariance_of"] == "image"
    assert node.poses[-1].header.frame_id == "left_eye"


@pytest.mark.parametrize("frame_id", ["", "/left_eye"])
def test_a_frame_that_tf2_refuses_is_told(frame_id: str, start: Callable[..., Node]) -> None:
    node = start()
    node.feed_until(node.told(WARN, f"frame_id of the poses is {frame_id!r}", "name a frame"), "it is told", frame_id)
    node.feed_until(node.told(OK, "2 objects located"), "it is well")


def test_a_record_of_another_calibration_is_told_and_left_out(start: Callable[..., Node], tmp_path: Path) -> None:
    other = rigs.RIGS["parallel"]
    node = start(calibration_file=write_record(other, tmp_path))
    parts = (f"calibration.yaml is of another calibration ({calibration_hash(other)})", "without the calibration's")
    node.feed_until(node.told(WARN, *parts), "the other calibration")
    assert node.values()["covariance_of"] == "image"
    assert len(node.poses[-1].poses) == 2


@pytest.mark.parametrize(
    ("wrong", "parts"),
    [
        ({"child_frame": "cam_b"}, ["of the frame 'cam_b', but the left images come from 'left_eye'"]),
        ({"calibration_hash": "0123456789ab"}, ["another calibration (0123456789ab)", calibration_hash(RIG)]),
    ],
)
def test_a_hand_eye_that_does_not_belong_publishes_nothing(
    wrong: dict[str, str], parts: list[str], start: Callable[..., Node], tmp_path: Path
) -> None:
    node = start(hand_eye_file=write_hand_eye(tmp_path / "hand_eye.yaml", BASE_T_CAMERA, **wrong))
    node.feed_until(node.told(ERROR, *parts), "what is wrong")
    assert node.poses == []


@pytest.mark.parametrize("first_frame", ["cam_b", "left_eye"])
def test_an_error_is_told_until_a_message_goes_well_though_there_was_another_warning_before(
    first_frame: str, start: Callable[..., Node], tmp_path: Path
) -> None:
    """Cameras that are triggered for each pick are silent for seconds."""
    record = write_record(rigs.RIGS["parallel"], tmp_path)
    node = start(calibration_file=record, hand_eye_file=write_hand_eye(tmp_path / "hand_eye.yaml", BASE_T_CAMERA))
    if first_frame == "left_eye":
        node.feed_until(node.told(WARN, "is of another calibration"), "the warning")
    node.feed_until(node.told(ERROR, "but the left images come from 'cam_b'"), "the error", "cam_b")
    node.graph.spin(0.5)
    node.graph.forget_statuses()
    node.graph.spin(0.5)
    assert node.told(ERROR, "but the left images come from 'cam_b'")(), node.graph.statuses()


@pytest.mark.parametrize("name", ["calibration_file", "hand_eye_file"])
def test_a_file_that_is_none_ends_the_node_with_its_name(name: str, start: Callable[..., Node], tmp_path: Path) -> None:
    (tmp_path / "wrong.yaml").write_text("a: 1\n")
    with pytest.raises(CalibrationError, match=r"wrong\.yaml"):
        start(**{name: tmp_path / "wrong.yaml"})
