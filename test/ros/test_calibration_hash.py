"""All four nodes tell one calibration's hash, although they see it as camera_info with different R and P."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import cv2
import pytest
from recordings import DEMO_RIG, Recording, demo_pairs
from ros_tools import NODES, Graph, reserved_domain

import stereo_pick.ros.node as node_module
from stereo_pick.core.calibration.files import load_rig
from stereo_pick.core.calibration.fingerprint import calibration_hash
from stereo_pick.ros.nodes.capture import CaptureNode
from stereo_pick.ros.nodes.correspondence import CorrespondenceNode
from stereo_pick.ros.nodes.rectification import RectificationNode
from stereo_pick.ros.nodes.triangulation import TriangulationNode


def test_every_node_tells_the_hash_of_the_bags_camera_info(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(node_module, "_DIAGNOSTICS_PERIOD_S", 0.1)
    rig = load_rig(DEMO_RIG)
    left, right, pose = rig.left, rig.right, rig.right_T_left
    left_R, right_R, left_P, right_P, *_ = cv2.stereoRectify(
        left.K, left.D, right.K, right.D, left.frame_size, pose.rotation, pose.translation, alpha=0
    )
    cameras = {"left": replace(left, R=left_R, P=left_P), "right": replace(right, R=right_R, P=right_P)}
    bag = Recording(demo_pairs(2), cameras).write(tmp_path / "bag")
    with reserved_domain() as domain:
        # One thread takes one report between two pairs: seconds apart, or it may hear of the same node each time.
        graph = Graph(domain, ["-p", f"source:={bag}", "-p", "loop:=true", "-p", "rate:=0.02"])
        for node in (TriangulationNode, CorrespondenceNode, RectificationNode, CaptureNode):
            graph.host(node(graph.context))

        def hashes() -> dict[str, set[str]]:
            found: dict[str, set[str]] = {}
            for status in (each for array in graph.diagnostics for each in array.status):
                told = {each.value for each in status.values if each.key == "calibration_hash"}
                found.setdefault(status.name.removeprefix("stereo_pick: "), set()).update(told)
            return found

        graph.wait(lambda: set(hashes()) == set(NODES) and all(hashes().values()), "a hash of every node")
        assert hashes() == {name: {calibration_hash(rig)} for name in NODES}
        graph.close()
