"""The four nodes as four processes over real DDS give the numbers of the offline pipeline, whatever the source."""

from __future__ import annotations

import json
import signal
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
import pytest
from marks import first_of
from recordings import DEMO_RIG, START_NS, Recording, demo_pairs, write_images
from ros_tools import DEADLINE_S, DOWNSTREAM, System, is_prompt, running_system, slowness
from visualization_msgs.msg import Marker

from stereo_pick.cli.main import main
from stereo_pick.core.calibration.boards import Chessboard
from stereo_pick.core.calibration.files import load_rig, save_rig
from stereo_pick.core.calibration.record import save_record
from stereo_pick.core.calibration.result import CalibrationResult
from stereo_pick.core.images import pixels, read_image
from stereo_pick.core.rig import StereoRig
from stereo_pick.ros.messages.cameras import camera_of
from stereo_pick.ros.messages.images import buffer_of
from stereo_pick.ros.messages.poses import OBJECT_ROW
from stereo_pick.ros.messages.stamps import stamp_ns
from stereo_pick.ros.messages.tables import table_of
from stereo_pick.ros.topics import ANNOTATED, CAMERA_INFO_RECT, CLOCK, IMAGE_RECT, OBJECT_MARKERS, OBJECT_POSES, OBJECTS

METHODS = ("feature", "ssd")
TOLERANCE_M = 1e-6
_RATE = 0.1  # of the bags' ten pairs a second: nodes keep up with it

Positions = list[tuple[float, float, float]]


@dataclass(frozen=True)
class Received:
    """Everything that the nodes publish, as it comes."""

    poses: list[Any]
    objects: list[Any]
    markers: list[Any]
    annotated: list[Any]
    images: dict[str, list[Any]]
    infos: dict[str, list[Any]]
    clock: list[Any]

    @staticmethod
    def of(system: System) -> Received:
        listen = system.graph.listen
        images = {side: listen(topic) for side, topic in IMAGE_RECT.items()}
        infos = {side: listen(topic) for side, topic in CAMERA_INFO_RECT.items()}
        return Received(
            listen(OBJECT_POSES),
            listen(OBJECTS),
            listen(OBJECT_MARKERS),
            listen(ANNOTATED),
            images,
            infos,
            listen(CLOCK),
        )

    def since(self, start_ns: int) -> Received:
        """What is stamped within an hour of that time."""

        def chosen(messages: list[Any]) -> list[Any]:
            return [message for message in messages if 0 <= stamp_of(message) - start_ns < 3600 * 10**9]

        several = ({side: chosen(messages) for side, messages in both.items()} for both in (self.images, self.infos))
        single = (chosen(messages) for messages in (self.poses, self.objects, self.markers, self.annotated))
        return Received(*single, *several, chosen(self.clock))

    def positions(self) -> dict[int, list[Positions]]:
        """All arrays by their stamp."""
        found: dict[int, list[Positions]] = {}
        for array in self.poses:
            points = [(pose.position.x, pose.position.y, pose.position.z) for pose in array.poses]
            found.setdefault(stamp_ns(array.header.stamp), []).append(points)
        return found


class Nodes:
    """The processes of a chain, and what came of them."""

    def __init__(self, system: System, one_process: bool) -> None:
        self.system = system
        self.one_process = one_process
        self.received = Received.of(system)
        if not one_process:
            for name in DOWNSTREAM:
                system.start_node(name)
            for name in DOWNSTREAM:
                system.graph.wait(lambda name=name: name in system.graph.statuses(), f"{name} is up")

    def replay(self, source: Path, method: str, expected: int, **values: Any) -> Received:
        """What comes of a source that is replayed until as many different stamps as expected have come.

        Only what is stamped since the source's start: of sources before it something may still be on its way.
        """
        graph, received = self.system.graph, self.received
        values = {"source": source, "loop": True, "rate": _RATE / slowness(), **values}
        start_ns = Recorded.start_ns_of(source)
        if not self.one_process:
            assert graph.set_parameter("correspondence", "method", method).successful
        if self.one_process:
            player = self.system.start_node("stereo_pick", {"method": method, **values})
        else:
            player = self.system.start_node("capture", values)

        def complete() -> bool:
            own = received.since(start_ns)
            stamped = (own.poses, own.objects, own.markers, own.annotated, *own.images.values(), *own.infos.values())
            return all(len({stamp_of(message) for message in each}) >= expected for each in (*stamped, own.clock))

        graph.wait(complete, f"{expected} pairs of {source}")
        status, seconds = player.end(signal.SIGINT)
        assert status == 0, player.output
        assert is_prompt(seconds)
        return received.since(start_ns)

    def play(self, bag: Path, method: str, pairs: int) -> Received:
        """What comes of so few pairs that the nodes' queues hold them all; once more where images still got lost."""
        graph, start_ns = self.system.graph, Recorded.start_ns_of(bag)
        assert graph.set_parameter("correspondence", "method", method).successful
        for _ in range(3):
            player = self.system.start_node("capture", {"source": bag, "rate": _RATE / slowness()})
            graph.wait(lambda player=player: not player.running(), "the end of the recording")
            assert player.wait() == 0, player.output
            graph.spin(DEADLINE_S, until=lambda: len(self.received.since(start_ns).positions()) == pairs)
            if len(self.received.since(start_ns).positions()) == pairs:
                break
        return self.received.since(start_ns)


class Recorded:
    """Bags whose stamps differ from those of every other bag, so that what comes of each can be told apart."""

    _starts_ns: ClassVar[dict[Path, int]] = {}

    @classmethod
    def write(cls, path: Path, rig: StereoRig, pairs: Sequence[Any]) -> Path:
        cls._starts_ns[path] = START_NS + len(cls._starts_ns) * 3600 * 10**9
        return Recording.of(rig, *pairs, start_ns=cls._starts_ns[path]).write(path)

    @classmethod
    def start_ns_of(cls, source: Path) -> int:
        """The first stamp of a bag; of a folder, which has none, the time now."""
        return cls._starts_ns.get(source, time.time_ns())


def stamp_of(message: Any) -> int:
    if hasattr(message, "clock"):
        return stamp_ns(message.clock)
    return stamp_ns((message.markers[0] if hasattr(message, "markers") else message).header.stamp)


FOUR, ONE = "four processes", "one process"


@pytest.fixture(scope="module")
def nodes(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Nodes]:
    with running_system(tmp_path_factory.mktemp("chain")) as system:
        yield Nodes(system, one_process=request.param == ONE)


@pytest.fixture(scope="module")
def vigir(
    shared_data: Path, calibrated: Callable[..., CalibrationResult], tmp_path_factory: pytest.TempPathFactory
) -> tuple[Path, list[list[Path]]]:
    """A real rig, calibrated from its own boards, and the files of its three scenes."""
    folder = tmp_path_factory.mktemp("vigir") / "rig"
    result = calibrated("vigir2023_puma/calib/left*", "vigir2023_puma/calib/right*", Chessboard(8, 6, 0.025))
    save_rig(result.rig, folder)
    save_record(result, folder)
    scenes = shared_data / "vigir2023_puma" / "scenes"
    return folder, [[scenes / f"{side}_obj{n:02}.png" for side in ("left", "right")] for n in (1, 2, 3)]


def offline(source: Path, method: str, output: Path) -> dict[int, list[dict[str, Any]]]:
    """What `stereo-pick replay` finds, by stamp."""
    assert main(["replay", str(source), "--method", method, "--output", str(output)]) == 0
    lines = [json.loads(line) for line in output.read_text().splitlines()]
    return {line["stamp_ns"]: line["objects"] for line in lines}


def located(files: Sequence[Path], rig: Path, method: str, capsys: pytest.CaptureFixture[str]) -> list[dict[str, Any]]:
    """What `stereo-pick locate` finds in two files."""
    arguments = ["locate", *map(str, files), "--calibration", str(rig), "--method", method, "--json"]
    assert main(arguments) == 0
    found: list[dict[str, Any]] = json.loads(capsys.readouterr().out)["objects"]
    return found


def points(objects: Sequence[dict[str, Any]]) -> Positions:
    return [tuple(each["position_m"]) for each in objects]


def assert_same(arrays: Sequence[Positions], expected: Positions) -> None:
    """Every array has just these positions in this order: not one frame may show anything else."""
    assert arrays
    for array in arrays:
        assert same(array, expected), f"{array} is not {expected}"


def same(array: Positions, expected: Positions) -> bool:
    return np.shape(array) == np.shape(expected) and np.allclose(array, expected, rtol=0, atol=TOLERANCE_M)


@pytest.mark.parametrize(
    ("nodes", "method"),
    [*first_of((FOUR, "feature"), (FOUR, "ssd")), *first_of((ONE, "ssd"), (ONE, "feature"))],
    indirect=["nodes"],
)
def test_the_demo_bag_gives_the_numbers_of_the_offline_pipeline(nodes: Nodes, method: str, tmp_path: Path) -> None:
    bag = Recorded.write(tmp_path / "bag", load_rig(DEMO_RIG), demo_pairs(3))
    expected = offline(bag, method, tmp_path / "offline.jsonl")
    assert len(expected) == 3
    if method == "feature":
        assert [len(objects) for objects in expected.values()] == [4, 4, 4]
    received = nodes.replay(bag, method, len(expected))
    found = received.positions()
    assert set(found) == set(expected)
    for stamp, objects in expected.items():
        assert_same(found[stamp], points(objects))
    check_messages(received, load_rig(DEMO_RIG), expected, "left_eye", "right_eye")


def check_messages(
    received: Received, rig: StereoRig, expected: dict[int, list[dict[str, Any]]], left_frame: str, right_frame: str
) -> None:
    """All that is published beside the positions: stamps, frames, sizes, markers, picture, clock."""
    for messages in (received.poses, received.objects, received.annotated, received.images["left"]):
        assert {message.header.frame_id for message in messages} == {left_frame}
        assert {stamp_ns(message.header.stamp) for message in messages} <= set(expected)
    assert {stamp_ns(message.clock) for message in received.clock} == set(expected)
    for side, frame, camera in (("left", left_frame, rig.left), ("right", right_frame, rig.right)):
        for info, picture in ((received.infos[side][-1], received.images[side][-1]),):
            assert info.header.frame_id == picture.header.frame_id == frame
            assert (picture.width, picture.height) == (info.width, info.height) == camera.frame_size
            assert picture.encoding == "mono8"
    left, right = (camera_of(received.infos[side][-1], side) for side in ("left", "right"))
    assert StereoRig(left, right).baseline_m == pytest.approx(rig.baseline_m, rel=1e-9)
    assert right.P[0, 3] == pytest.approx(-right.P[0, 0] * rig.baseline_m, rel=1e-9)
    assert np.allclose(left.K, rig.left.K, rtol=0, atol=0)
    picture = pixels(buffer_of(received.annotated[-1]))
    assert picture.shape == (rig.left.height_px, 2 * rig.left.width_px, 3)
    array = received.poses[-1]
    table = {stamp_of(message): message for message in received.objects}[stamp_of(array)]
    objects = expected[stamp_of(array)]
    for row, each in zip(table_of(table, OBJECT_ROW), objects, strict=True):
        assert [row[name] for name in "xyz"] == pytest.approx(each["position_m"], abs=TOLERANCE_M)
        covariance = [[row[f"cov_{a}{b}"] for b in "xyz"] for a in "xyz"]
        assert np.allclose(covariance, each["covariance_m2"], rtol=1e-3, atol=1e-12)
        assert row["confidence"] == pytest.approx(each["confidence"], abs=1e-3)
        assert [row["length"], row["width"], row["height"]] == pytest.approx(each["size_m"], abs=1e-6)
        assert [row["left_u"], row["left_v"]] == pytest.approx(each["left_px"], abs=1e-3)
        assert [row["right_u"], row["right_v"]] == pytest.approx(each["right_px"], abs=1e-3)
    by_stamp = {stamp_of(message): message for message in received.markers}
    markers = by_stamp[stamp_of(array)].markers
    assert markers[0].action == Marker.DELETEALL
    cubes = [marker for marker in markers if marker.type == Marker.CUBE and marker.action == Marker.ADD]
    assert len(cubes) == len(objects)
    assert [cube.pose for cube in cubes] == list(array.poses)


@pytest.mark.parametrize("nodes", [FOUR], indirect=True)
@pytest.mark.parametrize("method", first_of("feature", "ssd"))
def test_a_real_rig_gives_the_numbers_of_locate(
    nodes: Nodes,
    vigir: tuple[Path, list[list[Path]]],
    method: str,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    rig, files = vigir
    pairs = [(read_image(left), read_image(right)) for left, right in files]
    bag = Recorded.write(tmp_path / "bag", load_rig(rig), pairs)
    expected = [points(located(pair, rig, method, capsys)) for pair in files]
    found = nodes.play(bag, method, len(expected)).positions()
    assert len(found) == len(expected)
    for stamp, positions in zip(sorted(found), expected):
        assert_same(found[stamp], positions)
    if method == "feature":
        assert [len(each) for each in expected] == [4, 4, 4]


@pytest.mark.parametrize("nodes", first_of(ONE, FOUR), indirect=True)
def test_a_folder_of_image_pairs_gives_the_numbers_of_locate(
    nodes: Nodes, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = write_images(tmp_path / "images", demo_pairs(2))
    pairs = [[folder / f"{side}{n:02}.png" for side in ("left", "right")] for n in (0, 1)]
    expected = [points(located(pair, DEMO_RIG, "feature", capsys)) for pair in pairs]
    assert [len(positions) for positions in expected] == [4, 4]
    values = {"calibration": DEMO_RIG, "rate": 1.0 / slowness(), "folder_rate_hz": 1.0, "left_frame_id": "eye"}
    received = nodes.replay(folder, "feature", 4, **values)
    arrays = [array for same_stamp in received.positions().values() for array in same_stamp]
    nearest = [int(np.argmin([np.abs(np.subtract(array, each)).max() for each in expected])) for array in arrays]
    assert set(nearest) == {0, 1}
    for array, index in zip(arrays, nearest):
        assert_same([array], expected[index])
    assert {message.header.frame_id for message in received.poses} == {"eye"}
    assert {message.header.frame_id for message in received.images["right"]} == {"right_camera_optical_frame"}


@pytest.mark.parametrize("nodes", [FOUR], indirect=True)
def test_a_method_changed_live_takes_effect(nodes: Nodes, tmp_path: Path) -> None:
    bag = Recorded.write(tmp_path / "bag", load_rig(DEMO_RIG), demo_pairs(2))
    expected = {method: offline(bag, method, tmp_path / f"{method}.jsonl") for method in METHODS}
    graph, received = nodes.system.graph, nodes.received
    player = nodes.system.start_node("capture", {"source": bag, "loop": True, "rate": _RATE / slowness()})
    for method in ("ssd", "feature", "ssd"):
        assert graph.set_parameter("correspondence", "method", method).successful
        before = len(received.poses)

        def arrived(method: str = method, before: int = before) -> bool:
            found = replace(received, poses=received.poses[before:]).positions()
            return all(stamp in found and same(found[stamp][-1], points(o)) for stamp, o in expected[method].items())

        graph.wait(arrived, f"the numbers of {method}")
    assert player.end(signal.SIGTERM)[0] == 0


@pytest.mark.parametrize("nodes", first_of(FOUR, ONE), indirect=True)
def test_an_empty_table_gives_empty_pose_arrays(nodes: Nodes, tmp_path: Path, shared_data: Path) -> None:
    left, right = (read_image(shared_data / "bench_rig" / "empty" / "table" / f"{s}.png") for s in ("left", "right"))
    bag = Recorded.write(tmp_path / "bag", load_rig(DEMO_RIG), [(left, right)] * 2)
    received = nodes.replay(bag, "feature", 2)
    assert [array for array in received.poses if array.poses] == []
    for message in received.markers:
        assert [marker.action for marker in message.markers] == [Marker.DELETEALL]
