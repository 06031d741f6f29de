"""The capture node's replay: rate, loop, clock, stamps and frames; nodes in this process, messages over DDS."""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import rigs
from recordings import START_NS, Recording, write_images
from ros_tools import Graph, reserved_domain

from stereo_pick.core.calibration.files import save_rig
from stereo_pick.core.errors import ImageError
from stereo_pick.ros.messages.cameras import camera_of
from stereo_pick.ros.messages.diagnostics import WARN
from stereo_pick.ros.messages.stamps import stamp_ns
from stereo_pick.ros.nodes.capture import CaptureNode
from stereo_pick.ros.nodes.rectification import RectificationNode
from stereo_pick.ros.topics import CAMERA_INFO, CLOCK, IMAGE_RAW, SIDES

S = 1_000_000_000
COUNT = 3
RIG = rigs.RIGS["parallel"]
PAIRS = [(np.full((480, 640), 40 + i, np.uint8), np.full((480, 640), 140 + i, np.uint8)) for i in range(COUNT)]


@pytest.fixture(scope="module")
def bag(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Three pairs, 2 s apart."""
    return replace(Recording.of(RIG, *PAIRS), period_ns=2 * S).write(tmp_path_factory.mktemp("capture") / "bag")


@contextmanager
def graph_with(*parameters: str) -> Iterator[Graph]:
    with reserved_domain() as domain:
        graph = Graph(domain, [part for parameter in parameters for part in ("-p", parameter)])
        try:
            yield graph
        finally:
            graph.close()


def listen(graph: Graph) -> dict[str, list[Any]]:
    return {side: graph.listen(IMAGE_RAW[side]) for side in SIDES}


def stamps(messages: Sequence[Any]) -> list[int]:
    return [stamp_ns(message.header.stamp) for message in messages]


RECORDED = [START_NS + i * 2 * S for i in range(COUNT)]


@pytest.mark.parametrize(("rate", "shortest_s", "longest_s"), [(4.0, 1.0, np.inf), (100.0, 0.04, 1.0)])
def test_pairs_come_in_their_own_time_by_the_rate(bag: Path, rate: float, shortest_s: float, longest_s: float) -> None:
    with graph_with(f"source:={bag}", f"rate:={rate}") as graph:
        images, clock = listen(graph), graph.listen(CLOCK)
        infos = {side: graph.listen(CAMERA_INFO[side]) for side in SIDES}
        node = graph.host(CaptureNode(graph.context))
        graph.wait(lambda: images["left"], "the first pair")
        start = time.monotonic()
        graph.wait(lambda: len(images["left"]) == COUNT, "the last pair")
        assert shortest_s - 0.05 <= time.monotonic() - start < longest_s
        graph.wait(lambda: node.finished, "the end")

    for side, camera, grey in (("left", RIG.left, 40), ("right", RIG.right, 140)):
        assert stamps(images[side]) == stamps(infos[side]) == RECORDED
        assert [message.data[0] for message in images[side]] == [grey, grey + 1, grey + 2]
        assert {message.header.frame_id for message in (*images[side], *infos[side])} == {f"{side}_eye"}
        told = camera_of(infos[side][0], side)
        for matrix in "KDRP":
            assert np.allclose(getattr(told, matrix), getattr(camera, matrix), rtol=0, atol=1e-9)
    fx, shift = infos["right"][0].p[0], infos["right"][0].p[3]
    assert shift == pytest.approx(-fx * 0.08, rel=1e-9)
    assert set(RECORDED[1:]) <= {stamp_ns(message.clock) for message in clock}


def test_a_loop_starts_over_and_ends_when_it_is_switched_off(bag: Path) -> None:
    with graph_with(f"source:={bag}", "rate:=100.0", "loop:=true") as graph:
        images = listen(graph)
        node = graph.host(CaptureNode(graph.context))
        graph.wait(lambda: len(images["left"]) > 2 * COUNT, "two rounds")
        assert graph.set_parameter("capture", "loop", False).successful
        graph.wait(lambda: node.finished, "the end")
    assert stamps(images["left"])[: 2 * COUNT] == RECORDED * 2


def test_a_loop_of_one_pair_keeps_the_pace_of_its_folder(tmp_path: Path) -> None:
    folder = write_images(tmp_path / "images", PAIRS[:1])
    save_rig(RIG, tmp_path / "rig")
    parameters = (f"source:={folder}", f"calibration:={tmp_path / 'rig'}", "folder_rate_hz:=5.0", "loop:=true")
    with graph_with(*parameters) as graph:
        images = listen(graph)
        graph.host(CaptureNode(graph.context))
        graph.wait(lambda: len(images["left"]) >= 4, "four rounds")
        taken = stamps(images["left"])
        assert np.diff(taken).min() > 0.19 * S


def test_a_recording_that_breaks_off_is_not_reported_as_finished(tmp_path: Path) -> None:
    folder = write_images(tmp_path / "images", PAIRS)
    (folder / "right01.png").write_bytes(b"no image")
    save_rig(RIG, tmp_path / "rig")
    with graph_with(f"source:={folder}", f"calibration:={tmp_path / 'rig'}") as graph:
        listen(graph)
        graph.host(CaptureNode(graph.context))
        with pytest.raises(ImageError, match="right01.png is no image"):
            graph.wait(lambda: False, "the end")
        graph.wait_for_status("capture", WARN, "broke off after 1 pairs:", "right01.png is no image")


def test_a_rate_set_live_holds_from_now_on(bag: Path) -> None:
    with graph_with(f"source:={bag}", "rate:=0.01") as graph:  # the second pair would come after 200 s
        images = listen(graph)
        node = graph.host(CaptureNode(graph.context))
        graph.wait(lambda: images["left"], "the first pair")
        assert graph.set_parameter("capture", "rate", 100.0).successful
        graph.wait(lambda: node.finished, "the end")
        assert stamps(images["left"]) == RECORDED


def test_nodes_with_use_sim_time_live_in_the_recorded_time(bag: Path) -> None:
    with graph_with(f"source:={bag}", "rate:=100.0", "loop:=true", "use_sim_time:=true") as graph:
        graph.host(CaptureNode(graph.context))
        rectification = graph.host(RectificationNode(graph.context))
        graph.wait(lambda: rectification.get_clock().now().nanoseconds in RECORDED, "the recorded time")


def test_without_the_clock_topic_nothing_speaks_on_it(bag: Path) -> None:
    with graph_with(f"source:={bag}", "rate:=100.0", "publish_clock:=false") as graph:
        clock = graph.listen(CLOCK)
        listen(graph)
        node = graph.host(CaptureNode(graph.context))
        graph.wait(lambda: node.finished, "the end")
        assert clock == []


def test_a_folder_is_stamped_with_the_time_now_and_the_frames_that_are_set(tmp_path: Path) -> None:
    folder = write_images(tmp_path / "images", PAIRS)
    save_rig(RIG, tmp_path / "rig")
    parameters = (f"source:={folder}", f"calibration:={tmp_path / 'rig'}", "folder_rate_hz:=50.0", "left_frame_id:=eye")
    before_ns = time.time_ns()
    with graph_with(*parameters) as graph:
        images = listen(graph)
        node = graph.host(CaptureNode(graph.context))
        graph.wait(lambda: node.finished, "the end")
    assert [message.data[0] for message in images["right"]] == [140, 141, 142]
    taken = stamps(images["left"])
    assert taken == stamps(images["right"]) == sorted(taken)
    assert before_ns <= taken[0] <= taken[-1] <= time.time_ns()
    assert {message.header.frame_id for message in images["left"]} == {"eye"}
    assert {message.header.frame_id for message in images["right"]} == {"right_camera_optical_frame"}


def test_nobody_listening_does_not_hold_the_replay_for_ever(bag: Path) -> None:
    with graph_with(f"source:={bag}", "rate:=100.0", "wait_for_subscribers_s:=0.2") as graph:
        node = graph.host(CaptureNode(graph.context))
        graph.wait(lambda: node.finished, "the end")


def test_quality_of_service_is_overridden_for_one_topic_alone(bag: Path) -> None:
    reliable = "qos_overrides./left/image_raw.publisher.reliability:=reliable"
    with graph_with(f"source:={bag}", reliable) as graph:
        node = graph.host(CaptureNode(graph.context))
        found = {
            topic: publisher.qos_profile.reliability.name
            for topic in ("/left/image_raw", "/right/image_raw", "/left/camera_info")
            for publisher in node.get_publishers_info_by_topic(topic)
        }
    assert found == {
        "/left/image_raw": "RELIABLE",
        "/right/image_raw": "BEST_EFFORT",
        "/left/camera_info": "BEST_EFFORT",
    }
    assert IMAGE_RAW["left"].qos.reliability.name == "BEST_EFFORT"
