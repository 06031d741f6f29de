"""What each node tells of itself on /diagnostics, with real messages: what is missing, wrong or refused, and where."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import rigs
from rclpy.parameter import Parameter
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from ros_tools import Graph, reserved_domain
from sensor_msgs.msg import CompressedImage
from std_srvs.srv import Trigger

import stereo_pick.ros.node as node_module
import stereo_pick.ros.raw_pairs as raw_pairs_module
from stereo_pick.core.camera import Camera
from stereo_pick.core.correspondence import Correspondences
from stereo_pick.core.frames import RectifiedPair, StereoFrame
from stereo_pick.core.pairing import Side
from stereo_pick.core.rectification import Rectifier
from stereo_pick.core.rig import StereoRig
from stereo_pick.core.transform import Transform
from stereo_pick.ros.messages.cameras import camera_info_message
from stereo_pick.ros.messages.correspondences import correspondences_message
from stereo_pick.ros.messages.diagnostics import ERROR, OK, WARN
from stereo_pick.ros.messages.images import image_message
from stereo_pick.ros.messages.stamps import stamp_ns
from stereo_pick.ros.nodes.capture import CaptureNode
from stereo_pick.ros.nodes.correspondence import CorrespondenceNode
from stereo_pick.ros.nodes.rectification import RectificationNode
from stereo_pick.ros.nodes.triangulation import TriangulationNode
from stereo_pick.ros.topics import (
    CAMERA_INFO,
    CAMERA_INFO_RECT,
    CORRESPONDENCES,
    IMAGE_RAW,
    IMAGE_RECT,
    OBJECT_POSES,
    SIDES,
    Topic,
)

START_NS = 1_760_000_000_000_000_000
STEP_NS = 50_000_000
SIZE_PX = (160, 120)
RIG = StereoRig.from_extrinsics(
    rigs.camera("left", 220.0, (79.5, 59.5), size_px=SIZE_PX),
    rigs.camera("right", 220.0, (79.5, 59.5), size_px=SIZE_PX),
    Transform(np.eye(3), np.array([-0.1, 0.0, 0.0])),
)
ONCE = QoSProfile(depth=1, reliability=ReliabilityPolicy.RELIABLE, durability=DurabilityPolicy.TRANSIENT_LOCAL)
GREY = np.full(SIZE_PX[::-1], 90, np.uint8)


@pytest.fixture(autouse=True)
def frequent_diagnostics(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(node_module, "_DIAGNOSTICS_PERIOD_S", 0.1)
    monkeypatch.setattr(raw_pairs_module, "_SILENT_AFTER_S", 0.5)


class Cameras:
    """A driver of two cameras: images and camera_info, of stamps that go on."""

    def __init__(self, graph: Graph, images: Any = IMAGE_RAW, infos: Any = CAMERA_INFO) -> None:
        self._graph = graph
        self.images = {side: graph.publisher(images[side]) for side in SIDES}
        self.infos = {side: graph.publisher(infos[side]) for side in SIDES}
        self.stamp_ns = START_NS

    def image(self, side: str, picture: Any = GREY, offset_ns: int = 0) -> None:
        message = image_message(picture, self.stamp_ns + offset_ns, f"{side}_eye")
        self.images[side].publish(message)

    def pairs(self, **pair: Any) -> None:
        """A few at once: each turn of `until` takes a fifth of a second, and some things are told after dozens."""
        for _ in range(4):
            self.pair(**pair)

    def info(self, side: str, camera: Camera) -> None:
        self.infos[side].publish(camera_info_message(camera, self.stamp_ns, f"{side}_eye"))

    def pair(self, left: Any = GREY, right: Any = GREY, rig: StereoRig | None = RIG) -> None:
        for side, picture in zip(SIDES, (left, right)):
            if rig is not None:
                self.info(side, getattr(rig, side))
            self.image(side, picture)
        self.stamp_ns += STEP_NS

    def until(self, send: Callable[[], None], condition: Callable[[], Any], what: str) -> Any:
        """Send again and again until the condition holds: images are best effort, and the first find no listener.

        Where one callback takes longer than a turn, on a busy machine, the others get their time before more is sent.
        A status may not last: it is looked at all the while.
        """

        def holds() -> Any:
            send()
            began = time.monotonic()
            self._graph.spin(0.2, condition)
            self._graph.spin(5 * (time.monotonic() - began - 0.2), condition)
            return condition()

        return self._graph.wait(holds, what)


def told(graph: Graph, node: str, level: bytes, *parts: str) -> Callable[[], bool]:
    """Whether the node's last status is of that level and has those parts in its line."""

    def check() -> bool:
        last_level, message = graph.statuses().get(node, (None, ""))
        return last_level == level and all(part in message for part in parts) and "\n" not in message

    return check


def test_rectification_names_the_topics_that_are_silent_from_the_start(graph: Graph) -> None:
    graph.host(RectificationNode(graph.context))
    graph.wait(told(graph, "rectification", WARN, "/left/image_raw", "/right/image_raw"), "both are named")


@pytest.mark.parametrize(("alive", "dead"), [("left", "right"), ("right", "left")])
def test_rectification_names_the_one_camera_that_is_silent(graph: Graph, alive: str, dead: str) -> None:
    graph.host(RectificationNode(graph.context))
    cameras = Cameras(graph)
    parts = (f"no image on /{dead}/image_raw", f"is the {dead} camera running?")
    cameras.until(lambda: cameras.image(alive), told(graph, "rectification", ERROR, *parts), "the dead one is named")
    assert f"/{alive}/image_raw" not in graph.statuses()["rectification"][1]


def test_rectification_tells_of_the_profile_only_where_somebody_publishes(graph: Graph) -> None:
    graph.host(RectificationNode(graph.context))
    graph.wait(told(graph, "rectification", WARN, "/left/image_raw", "are the cameras running?"), "nobody publishes")
    assert "profile" not in graph.statuses()["rectification"][1]
    Cameras(graph)
    graph.wait(lambda: all(graph.node.count_publishers(IMAGE_RAW[side].name) for side in SIDES), "they are published")
    began_s = time.monotonic()
    graph.wait(told(graph, "rectification", WARN, "are the cameras running?", "Fast DDS profile"), "nothing comes")
    assert time.monotonic() - began_s > 0.45, "it is not said of every driver that starts after the nodes"


def test_rectification_names_the_type_that_is_published_in_place_of_images(graph: Graph) -> None:
    """Remapped to compressed images, it advised the Fast DDS profile."""
    graph.host(RectificationNode(graph.context))
    driver = Graph(graph.context.get_domain_id())
    driver.publisher(replace(IMAGE_RAW["left"], type=CompressedImage))
    published = ("It is published as sensor_msgs/msg/CompressedImage, not as sensor_msgs/msg/Image", "remap")
    graph.wait(told(graph, "rectification", WARN, *published), "the type is named")
    driver.close()


def test_rectification_warns_where_most_images_have_no_partner(graph: Graph) -> None:
    graph.host(RectificationNode(graph.context))
    cameras = Cameras(graph)

    def lossy() -> None:
        cameras.pair()
        for _ in range(3):
            cameras.image("left")
            cameras.stamp_ns += STEP_NS

    parts = ("of the last 40 images found no partner", "synchronised", "Fast DDS profile")
    cameras.until(lossy, told(graph, "rectification", WARN, *parts), "most are alone")
    cameras.until(cameras.pair, told(graph, "rectification", OK, "pairs rectified"), "it is well again")


@pytest.mark.parametrize("topic", [IMAGE_RAW["right"], CAMERA_INFO["left"], IMAGE_RECT["left"]])
def test_rectification_warns_of_two_publishers_of_one_topic_until_one_is_gone(graph: Graph, topic: Topic) -> None:
    """Of two camera_info the last one won, and all positions were those of another calibration."""
    graph.host(RectificationNode(graph.context))
    cameras, other = Cameras(graph), graph.publisher(topic)
    two = told(graph, "rectification", WARN, f"2 publishers on /{topic.name}", "end all but one")
    cameras.until(cameras.pair, two, "both are told of")
    graph.node.destroy_publisher(other)
    cameras.until(cameras.pair, told(graph, "rectification", OK, "pairs rectified"), "one is left")


def test_rectification_warns_of_images_that_were_rectified_before() -> None:
    """Rectified twice, parts before cameras that look towards each other are centimetres off, and no check notices."""
    with reserved_domain() as domain:
        names = {side: f"/{side}/image_rect_color" for side in SIDES}
        other = Graph(domain, [part for side in SIDES for part in ("-r", f"{side}/image_raw:={names[side]}")])
        other.host(RectificationNode(other.context))
        cameras = Cameras(other, {side: replace(IMAGE_RAW[side], name=names[side]) for side in SIDES})
        twice = told(other, "rectification", WARN, "/left/image_rect_color is rectified already, by its name", "remap")
        lens = replace(RIG.left, D=np.array([-0.2, 0.1, 0.0, 0.0, 0.0]))
        bent = StereoRig.from_extrinsics(lens, RIG.right, RIG.right_T_left)
        cameras.until(lambda: cameras.pair(rig=bent), twice, "it warns")
        unchanged = told(other, "rectification", OK, "pairs rectified")
        cameras.until(cameras.pair, unchanged, "of a driver that rectifies, camera_info is of rectified images")
        other.close()


@pytest.mark.parametrize("frozen", SIDES)
def test_rectification_pairs_no_image_of_a_camera_that_hangs(graph: Graph, frozen: Side) -> None:
    """Its driver sends the last one again and again: parts that moved on would be located where they never were."""
    graph.host(RectificationNode(graph.context))
    cameras, rectified = Cameras(graph), graph.listen(IMAGE_RECT["left"])
    noise = np.random.default_rng(0)

    def new() -> Any:
        return noise.integers(80, 100, GREY.shape, np.uint8)

    cameras.until(lambda: cameras.pair(new(), new()), lambda: rectified, "both cameras run")
    still = new()

    def hang() -> None:
        cameras.pair(*(still if side == frozen else new() for side in SIDES))

    hangs = told(
        graph, "rectification", ERROR, f"/{frozen}/image_raw repeats the image before", "does the camera hang?"
    )
    cameras.until(hang, hangs, "it is named")
    before = len(rectified)
    for _ in range(3):
        hang()
        graph.spin(0.1)
    assert len(rectified) == before
    both = told(graph, "rectification", WARN, "the last 40 pairs are the same to the last bit: do both cameras hang?")
    cameras.until(lambda: cameras.pairs(left=still, right=still), both, "it is told where both hang, too")
    assert len(rectified) > before, "a simulation in which nothing moves looks the same, and is paired"


def test_rectification_names_a_remapped_topic(graph: Graph) -> None:
    with reserved_domain() as domain:
        other = Graph(domain, ["-r", "__ns:=/cell1", "-r", "right/image_raw:=/cam1/image"])
        other.host(RectificationNode(other.context))
        named = told(other, "cell1/rectification", WARN, "/cell1/left/image_raw", "/cam1/image")
        other.wait(named, "real names, its own among them")
        other.close()


def test_rectification_pairs_no_images_without_stamps(graph: Graph) -> None:
    graph.host(RectificationNode(graph.context))
    cameras = Cameras(graph)

    def unstamped() -> None:
        cameras.stamp_ns = 0
        cameras.pair()

    told_so = told(graph, "rectification", ERROR, "/image_raw: images have the stamp 0", "header.stamp")
    cameras.until(unstamped, told_so, "no stamps")


def test_rectification_pairs_no_images_whose_stamps_repeat_and_the_next_ones_again(graph: Graph) -> None:
    graph.host(RectificationNode(graph.context))
    cameras = Cameras(graph)
    cameras.until(cameras.pair, told(graph, "rectification", OK, "pairs rectified"), "it works")

    def repeated() -> None:
        cameras.stamp_ns = START_NS
        cameras.pair()

    told_so = told(graph, "rectification", ERROR, "/image_raw: images repeat the stamp of the one before", "exposure")
    cameras.until(repeated, told_so, "stamps that stay")
    cameras.until(cameras.pair, told(graph, "rectification", OK, "pairs rectified"), "it works again")


@pytest.mark.parametrize("stamp", [0, START_NS])
def test_rectification_logs_what_is_wrong_with_the_stamps_of_each_camera_once(
    graph: Graph, stamp: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Left and right images take turns: there were 60 lines a second."""
    node = graph.host(RectificationNode(graph.context))
    lines, cameras = list[str](), Cameras(graph)
    monkeypatch.setattr(type(node.get_logger()), "error", lambda _, line: lines.append(line))

    def wrong() -> None:
        cameras.stamp_ns = stamp
        cameras.pair()

    def of_each_camera() -> list[int]:
        own = [line for line in lines if "stamp" in line and line.count("/image_raw") == 1]
        return [sum(line.startswith(f"/{side}/image_raw") for line in own) for side in SIDES]

    well = told(graph, "rectification", OK, "pairs rectified")
    cameras.until(cameras.pair, well, "it works")
    cameras.until(wrong, lambda: of_each_camera() == [1, 1], "both are logged")
    for _ in range(10):
        wrong()
        graph.spin(0.05)
    assert of_each_camera() == [1, 1]
    cameras.until(cameras.pair, well, "it works again")
    cameras.until(wrong, lambda: of_each_camera() == [2, 2], "both are logged anew")


def test_rectification_names_the_camera_that_has_gone_and_rejoices_when_it_is_back(graph: Graph) -> None:
    graph.host(RectificationNode(graph.context))
    cameras = Cameras(graph)
    cameras.until(cameras.pair, told(graph, "rectification", OK, "pairs rectified"), "it works")

    def left_only() -> None:
        cameras.image("left")
        cameras.stamp_ns += STEP_NS

    gone = told(graph, "rectification", ERROR, "no image on /right/image_raw any more")
    cameras.until(left_only, gone, "the lost one is named")
    graph.wait(told(graph, "rectification", WARN, "/left/image_raw and /right/image_raw"), "both have gone")
    cameras.until(cameras.pair, told(graph, "rectification", OK, "pairs rectified"), "it works again")


@pytest.mark.parametrize("since", ["the start", "a restart"])
def test_rectification_says_by_how_much_stamps_differ(graph: Graph, since: str) -> None:
    graph.host(RectificationNode(graph.context))
    cameras = Cameras(graph)
    if since == "a restart":
        cameras.until(cameras.pair, told(graph, "rectification", OK, "pairs rectified"), "one clock")

    def apart() -> None:
        for _ in range(4):
            cameras.image("left")
            cameras.image("right", offset_ns=2 * 10**10)
            cameras.stamp_ns += STEP_NS

    parts = ("differ by", "s", "max_stamp_offset_s = 0.01", "same time")
    cameras.until(apart, told(graph, "rectification", ERROR, *parts), "the offset is named")


def test_rectification_asks_for_the_camera_info_that_is_missing_and_then_uses_what_it_held(graph: Graph) -> None:
    graph.host(RectificationNode(graph.context))
    images, cameras = graph.listen(IMAGE_RECT["left"]), Cameras(graph)

    def without_right_info() -> None:
        cameras.info("left", RIG.left)
        cameras.pair(rig=None)

    parts = ("no message on /right/camera_info", "calibrated")
    cameras.until(without_right_info, told(graph, "rectification", WARN, *parts), "it may be on its way")
    cameras.until(without_right_info, told(graph, "rectification", ERROR, *parts), "camera_info is named")
    assert images == []
    held_ns = cameras.stamp_ns - STEP_NS
    cameras.until(lambda: cameras.info("right", RIG.right), lambda: images, "the held pairs come")
    graph.wait(lambda: stamp_ns(images[-1].header.stamp) == held_ns, "the last of them")


def test_a_pair_of_unequal_stamps_is_rectified_though_no_other_follows(graph: Graph) -> None:
    """As of cameras that are triggered for each part: poses were those of the part before."""
    graph.host(RectificationNode(graph.context))
    images, cameras = graph.listen(IMAGE_RECT["left"]), Cameras(graph)
    cameras.until(cameras.pair, lambda: images, "the node is up")
    left_ns = cameras.stamp_ns
    for side in SIDES:
        cameras.info(side, getattr(RIG, side))
        cameras.image(side)
        cameras.stamp_ns += STEP_NS // 10
    graph.wait(lambda: stamp_ns(images[-1].header.stamp) == left_ns, "the last pair comes")


def test_a_pair_without_camera_info_of_its_own_is_rectified_though_no_other_follows(graph: Graph) -> None:
    """Of a triggered camera whose driver sends camera_info with every other image, each other pose was late."""
    graph.host(RectificationNode(graph.context))
    images, cameras = graph.listen(IMAGE_RECT["left"]), Cameras(graph)
    cameras.until(cameras.pair, lambda: images, "camera_info come with images")
    left_ns = cameras.stamp_ns
    cameras.pair(rig=None)
    graph.wait(lambda: stamp_ns(images[-1].header.stamp) == left_ns, "the last pair comes")


def test_of_a_driver_that_sends_its_camera_info_once_rectification_tells_how_to_get_it(graph: Graph) -> None:
    cameras = Cameras(graph, infos={side: replace(CAMERA_INFO[side], qos=ONCE) for side in SIDES})
    for side in SIDES:
        cameras.info(side, getattr(RIG, side))
    graph.host(RectificationNode(graph.context))
    parts = ("no message on /left/camera_info", "transient_local", "qos_overrides")
    cameras.until(lambda: cameras.pair(rig=None), told(graph, "rectification", ERROR, *parts), "durability is named")


def test_rectification_gets_camera_info_that_was_sent_before_it_came_where_its_parameters_ask_for_it() -> None:
    asked = [f"qos_overrides./{side}/camera_info.subscription" for side in SIDES]
    values = [f"{name}.{value}" for name in asked for value in ("reliability:=reliable", "durability:=transient_local")]
    with reserved_domain() as domain:
        graph = Graph(domain, [part for value in values for part in ("-p", value)])
        cameras = Cameras(graph, infos={side: replace(CAMERA_INFO[side], qos=ONCE) for side in SIDES})
        for side in SIDES:
            cameras.info(side, getattr(RIG, side))
        graph.host(RectificationNode(graph.context))
        images = graph.listen(IMAGE_RECT["left"])
        cameras.until(lambda: cameras.pair(rig=None), lambda: images, "a pair is rectified")
        graph.close()


def _changed(camera: Camera, **fields: Any) -> Camera:
    values = {name: getattr(camera, name) for name in camera.__dataclass_fields__}
    return Camera(**{**values, **fields})


def _with_baseline_m(baseline_m: float) -> Callable[[Any], None]:
    def spoil(info: Any) -> None:
        info.p[3] = -info.p[0] * baseline_m

    return spoil


def _nan(info: Any) -> None:
    info.k[2] = float("nan")


@pytest.mark.parametrize("first", ["images", "infos"])
def test_rectification_takes_the_camera_info_of_the_images_stamp(first: str, graph: Graph) -> None:
    """The calibration changes with every pair; drivers send camera_info before or after the image."""
    graph.host(RectificationNode(graph.context))
    cameras = Cameras(graph)
    rects = {side: graph.listen(CAMERA_INFO_RECT[side]) for side in SIDES}
    other = StereoRig.from_extrinsics(RIG.left, RIG.right, Transform(np.eye(3), np.array([-0.2, 0.0, 0.0])))

    def rig_of(time_ns: int) -> StereoRig:
        return (RIG, other)[(time_ns - START_NS) // STEP_NS % 2]

    def send() -> None:
        def images() -> None:
            for side in SIDES:
                cameras.image(side)

        def infos() -> None:
            for side in SIDES:
                cameras.info(side, getattr(rig_of(cameras.stamp_ns), side))

        for step in (images, infos) if first == "images" else (infos, images):
            step()
            graph.spin(0.05)
        cameras.stamp_ns += STEP_NS

    cameras.until(send, lambda: len(rects["right"]) > 10, "pairs of both calibrations")
    seen = [(stamp_ns(message.header.stamp), -message.p[3] / message.p[0]) for message in rects["right"]]
    # The very first pairs come before the node knows that the stamps match.
    assert [baseline for _, baseline in seen[2:]] == [pytest.approx(rig_of(when).baseline_m) for when, _ in seen[2:]]
    assert {round(baseline, 3) for _, baseline in seen} == {0.1, 0.2}


@pytest.mark.parametrize(
    ("spoil", "parts"),
    [
        (_with_baseline_m(0.0), ["baseline = 0.000 mm is zero", "stereo pair"]),
        (_with_baseline_m(-0.1), ["baseline", "-0.1000 m is negative", "exchange"]),
        (_with_baseline_m(100.0), ["baseline = 100.0 m", "millimetres", "divide"]),
        (_nan, ["right camera: K holds nan", "finite"]),
    ],
)
def test_rectification_refuses_a_calibration_that_cannot_be_and_stays_with_it(
    graph: Graph, spoil: Callable[[Any], None], parts: list[str]
) -> None:
    graph.host(RectificationNode(graph.context))
    rectified, cameras = graph.listen(IMAGE_RECT["left"]), Cameras(graph)
    bad = camera_info_message(RIG.right, START_NS, "right_eye")
    spoil(bad)

    def send() -> None:
        cameras.infos["right"].publish(bad)
        cameras.info("left", RIG.left)
        cameras.pair(rig=None)

    cameras.until(send, told(graph, "rectification", ERROR, *parts), "the calibration is refused")
    # A driver may send its camera_info once: the refusal must not fade while images go on.
    graph.forget_statuses()
    seen = told(graph, "rectification", ERROR, *parts)
    cameras.until(lambda: cameras.pair(rig=None), lambda: len(graph.diagnostics) >= 5, "five more statuses")
    assert seen()
    assert all(status.level == ERROR for array in graph.diagnostics for status in array.status)
    assert rectified == []
    cameras.until(cameras.pair, told(graph, "rectification", OK, "rectified"), "a good calibration is taken")
    assert rectified


@pytest.mark.parametrize(
    ("change", "parts"),
    [
        ({"encoding": "bayer_rggb8"}, ["right image", "unknown encoding 'bayer_rggb8'", "debayer"]),
        ({"encoding": "16UC9"}, ["right image", "unknown encoding '16UC9'", "mono8"]),
        ({"data": bytes(100)}, ["right image", "100 bytes", "19200", "cut short"]),
        ({"step": 80}, ["right image", "step = 80"]),
        ({"width": 80, "step": 80, "data": bytes(80 * 120)}, ["right image is 80 x 120", "160 x 120", "calibrate"]),
    ],
)
def test_rectification_names_a_bad_image_and_takes_the_next_good_one(
    graph: Graph, change: dict[str, Any], parts: list[str]
) -> None:
    graph.host(RectificationNode(graph.context))
    rectified, cameras = graph.listen(IMAGE_RECT["left"]), Cameras(graph)

    def send() -> None:
        cameras.info("left", RIG.left)
        cameras.info("right", RIG.right)
        cameras.image("left")
        message = image_message(GREY, cameras.stamp_ns, "right_eye")
        for name, value in change.items():
            setattr(message, name, value)
        cameras.images["right"].publish(message)
        cameras.stamp_ns += STEP_NS

    cameras.until(send, told(graph, "rectification", ERROR, *parts), "the image is named")
    assert rectified == []
    cameras.until(cameras.pair, lambda: rectified, "good ones are rectified")


def test_a_replay_that_starts_over_is_paired_although_the_last_image_had_no_partner(graph: Graph) -> None:
    node = graph.host(RectificationNode(graph.context))
    rectified, cameras = graph.listen(IMAGE_RECT["left"]), Cameras(graph)
    cameras.until(cameras.pair, lambda: rectified, "it works")
    seen = node._raw.counts.right
    cameras.until(lambda: cameras.image("right"), lambda: node._raw.counts.right > seen, "one without partner")
    cameras.stamp_ns = START_NS
    rectified.clear()
    for _ in range(5):
        cameras.pair()
        graph.spin(0.05)
    last_ns = START_NS + 4 * STEP_NS
    graph.wait(lambda: any(stamp_ns(m.header.stamp) == last_ns for m in rectified), "the replay's pairs", 5)


def test_correspondence_names_what_it_waits_for(graph: Graph) -> None:
    graph.host(CorrespondenceNode(graph.context))
    cameras = Cameras(graph, IMAGE_RECT, CAMERA_INFO_RECT)
    every = ("/left/image_rect", "/right/image_rect", "/left/camera_info_rect", "/right/camera_info_rect")
    graph.wait(told(graph, "correspondence", WARN, *every), "all are named")
    one_left = told(graph, "correspondence", WARN, "/right/image_rect, /left/camera_info_rect, /right/camera_info_rect")
    cameras.until(lambda: cameras.image("left"), one_left, "those that are left")


@pytest.fixture(scope="module")
def demo() -> RectifiedPair:
    """The demo bag's first pair, rectified."""
    from recordings import DEMO_RIG, demo_pairs

    from stereo_pick.core.calibration.files import load_rig

    (pair,) = demo_pairs(1)
    return Rectifier(load_rig(DEMO_RIG)).rectify(StereoFrame(*pair))


def test_correspondence_tells_of_a_view_without_light(graph: Graph, demo: RectifiedPair) -> None:
    graph.host(CorrespondenceNode(graph.context))
    cameras = Cameras(graph, IMAGE_RECT, CAMERA_INFO_RECT)
    cameras.until(
        lambda: cameras.pair(demo.left, np.zeros_like(demo.right), demo.rig),
        told(graph, "correspondence", WARN, "so little light", "expose longer"),
        "too dark",
    )


def test_correspondence_tells_of_a_camera_that_has_turned_and_matches_all_the_same(
    graph: Graph, demo: RectifiedPair
) -> None:
    graph.host(CorrespondenceNode(graph.context))
    cameras = Cameras(graph, IMAGE_RECT, CAMERA_INFO_RECT)
    lower = np.roll(demo.right, 1, axis=0)
    parts = ("has turned since its calibration", "1.0 rows off", "calibrate again")
    cameras.until(
        lambda: cameras.pair(demo.left, lower, demo.rig), told(graph, "correspondence", WARN, *parts), "a turn"
    )
    cameras.until(
        lambda: cameras.pair(demo.left, demo.right, demo.rig), told(graph, "correspondence", OK, "4 objects"), "right"
    )


def test_correspondence_tells_of_parts_that_it_learned_as_long_as_that_background_is_in_use(
    graph: Graph, demo: RectifiedPair, tmp_path: Path
) -> None:
    """One line of its log told of them; then all was OK, with 0 objects matched and 0 refused."""
    graph.host(CorrespondenceNode(graph.context))
    cameras, file = Cameras(graph, IMAGE_RECT, CAMERA_INFO_RECT), str(tmp_path / "background.npz")
    assert graph.set_parameter("correspondence", "segmentation.background_file", file).successful
    assert graph.ask(Trigger, "correspondence/learn_background", Trigger.Request()).success

    def send() -> None:
        cameras.pairs(left=demo.left, right=demo.right, rig=demo.rig)

    learned = told(graph, "correspondence", WARN, "4 objects are in the views that the background was learned from")
    cameras.until(send, learned, "parts were learned")
    assert graph.set_parameter("correspondence", "segmentation.background_file", "").successful
    cameras.until(send, told(graph, "correspondence", OK, "4 objects matched"), "without that background")


def test_correspondence_tells_of_exchanged_images_and_matches_none(graph: Graph, demo: RectifiedPair) -> None:
    graph.host(CorrespondenceNode(graph.context))
    found, cameras = graph.listen(CORRESPONDENCES), Cameras(graph, IMAGE_RECT, CAMERA_INFO_RECT)
    parts = ("left and the right images are exchanged", "exchange the two image topics")
    rectifier = Rectifier(demo.rig)
    from recordings import demo_pairs

    ((left, right),) = demo_pairs(1)
    wrong = rectifier.rectify(StereoFrame(right, left))
    cameras.until(
        lambda: cameras.pair(wrong.left, wrong.right, demo.rig),
        told(graph, "correspondence", ERROR, *parts),
        "exchange",
    )
    cameras.until(
        lambda: cameras.pair(demo.left, demo.right, demo.rig), told(graph, "correspondence", OK, "4 objects"), "right"
    )
    from stereo_pick.ros.messages.correspondences import correspondences_of

    def counts() -> set[int]:
        return {len(correspondences_of(message)) for message in found}

    graph.wait(lambda: 4 in counts(), "the objects, which may come after what is said of them")
    assert counts() == {0, 4}


def test_correspondence_names_a_rectified_image_that_does_not_fit_its_camera_info(graph: Graph) -> None:
    graph.host(CorrespondenceNode(graph.context))
    found, cameras = graph.listen(CORRESPONDENCES), Cameras(graph, IMAGE_RECT, CAMERA_INFO_RECT)
    parts = ("rectified right image is 80 x 60", "160 x 120")
    cameras.until(lambda: cameras.pair(right=GREY[::2, ::2]), told(graph, "correspondence", ERROR, *parts), "the size")
    assert found == []


def _rows(rig: StereoRig, gap_px: float) -> Correspondences:
    """Two points 1 m away, and their right rows off by gap_px."""
    disparity = rig.focal_px * rig.baseline_m - (rig.right.P[0, 2] - rig.left.P[0, 2])
    left = np.array([[60.0, 50.0], [90.0, 70.0]])
    right = left - (disparity, gap_px)
    return Correspondences(left, right, np.full((2, 2), 0.1), np.full((2, 2), 9.0), np.zeros(2))


def test_triangulation_tells_of_rays_that_do_not_meet_and_publishes_an_empty_array(graph: Graph) -> None:
    graph.host(TriangulationNode(graph.context))
    poses, cameras = graph.listen(OBJECT_POSES), Cameras(graph, IMAGE_RECT, CAMERA_INFO_RECT)
    table = graph.publisher(CORRESPONDENCES)
    waiting = ("/correspondences", "/left/camera_info_rect", "/right/camera_info_rect")
    graph.wait(told(graph, "triangulation", WARN, *waiting), "all are named")

    def send(gap_px: float) -> None:
        for side in SIDES:
            cameras.info(side, getattr(RIG, side))
        table.publish(correspondences_message(_rows(RIG, gap_px), cameras.stamp_ns, "left_eye"))
        cameras.stamp_ns += STEP_NS

    apart = told(graph, "triangulation", ERROR, "rays of 2 objects do not meet", "moved")
    cameras.until(lambda: send(20.0), apart, "the rays")
    assert poses
    assert all(len(message.poses) == 0 for message in poses)
    cameras.until(lambda: send(0.0), told(graph, "triangulation", OK, "2 objects located"), "good ones")
    graph.wait(lambda: len(poses[-1].poses) == 2, "two poses")
    assert [round(pose.position.z, 6) for pose in poses[-1].poses] == [1.0, 1.0]


def test_triangulation_tells_that_most_positions_are_less_sure_than_asked_for(graph: Graph) -> None:
    node = graph.host(TriangulationNode(graph.context))
    node.set_parameters([Parameter("triangulation.min_confidence", value=1.0)])
    poses, cameras = graph.listen(OBJECT_POSES), Cameras(graph, IMAGE_RECT, CAMERA_INFO_RECT)
    table = graph.publisher(CORRESPONDENCES)

    def send() -> None:
        for side in SIDES:
            cameras.info(side, getattr(RIG, side))
        table.publish(correspondences_message(_rows(RIG, 0.0), cameras.stamp_ns, "left_eye"))
        cameras.stamp_ns += STEP_NS

    unsure = told(graph, "triangulation", WARN, "2 positions are less sure than triangulation.min_confidence = 1")
    cameras.until(send, unsure, "that they are unsure")
    assert poses and all(len(message.poses) == 0 for message in poses)


def test_triangulation_takes_what_was_long_looked_for_in_the_images_of_fast_cameras(graph: Graph) -> None:
    """Of cameras with 30 images a second it located nothing where a pair took a third of a second or more."""
    graph.host(TriangulationNode(graph.context))
    poses, cameras = graph.listen(OBJECT_POSES), Cameras(graph, IMAGE_RECT, CAMERA_INFO_RECT)
    table = graph.publisher(CORRESPONDENCES)

    def result(taken_ns: int) -> None:
        table.publish(correspondences_message(_rows(RIG, 0.0), taken_ns, "left_eye"))

    def infos() -> None:
        cameras.stamp_ns += STEP_NS
        for side in SIDES:
            cameras.info(side, getattr(RIG, side))

    def pair() -> None:
        infos()
        result(cameras.stamp_ns)

    cameras.until(pair, lambda: poses, "all listen to each other")
    graph.spin(0.2)
    poses.clear()
    taken_ns = cameras.stamp_ns + STEP_NS
    for _ in range(100):
        infos()
        graph.spin(0.02)
    result(taken_ns)
    graph.wait(
        lambda: any(stamp_ns(each.header.stamp) == taken_ns for each in poses), "the poses of the first pair", 10
    )


def test_an_error_stays_until_something_goes_well(graph: Graph, demo: RectifiedPair) -> None:
    """Between pairs that come seldom, or take long, the node was OK by the last one that had gone well."""
    graph.host(CorrespondenceNode(graph.context))
    cameras = Cameras(graph, IMAGE_RECT, CAMERA_INFO_RECT)
    well = told(graph, "correspondence", OK, "4 objects")
    cameras.until(lambda: cameras.pair(demo.left, demo.right, demo.rig), well, "it works")
    bad = told(graph, "correspondence", ERROR, "rectified right image is")
    cameras.until(lambda: cameras.pair(demo.left, demo.right[::2, ::2], demo.rig), bad, "a bad image")
    reports = len(graph.diagnostics)
    graph.wait(lambda: len(graph.diagnostics) > reports + 5, "more reports")
    assert bad()
    cameras.until(lambda: cameras.pair(demo.left, demo.right, demo.rig), well, "it works again")


def test_correspondence_tells_that_the_node_before_it_has_ended(graph: Graph, demo: RectifiedPair) -> None:
    graph.host(CorrespondenceNode(graph.context))
    cameras = Cameras(graph, IMAGE_RECT, CAMERA_INFO_RECT)
    cameras.until(
        lambda: cameras.pair(demo.left, demo.right, demo.rig),
        told(graph, "correspondence", OK, "4 objects"),
        "it works",
    )
    for each in cameras.images.values():
        graph.node.destroy_publisher(each)
    gone = told(graph, "correspondence", WARN, "nobody publishes /left/image_rect, /right/image_rect any more")
    graph.wait(gone, "both are named")


def test_triangulation_tells_that_nothing_belongs_together_any_more(graph: Graph) -> None:
    graph.host(TriangulationNode(graph.context))
    cameras, table = Cameras(graph, IMAGE_RECT, CAMERA_INFO_RECT), graph.publisher(CORRESPONDENCES)

    def send(off_ns: int) -> None:
        cameras.stamp_ns += STEP_NS
        for side in SIDES:
            cameras.info(side, getattr(RIG, side))
        table.publish(correspondences_message(_rows(RIG, 0.0), cameras.stamp_ns + off_ns, "left_eye"))

    together = told(graph, "triangulation", OK, "2 objects located")
    cameras.until(lambda: send(0), together, "it works")
    cameras.until(
        lambda: send(1), told(graph, "triangulation", WARN, "of one stamp", "/correspondences"), "other stamps"
    )
    cameras.until(lambda: send(0), together, "it works again")


def test_triangulation_refuses_a_table_of_another_make(graph: Graph) -> None:
    graph.host(TriangulationNode(graph.context))
    poses, cameras = graph.listen(OBJECT_POSES), Cameras(graph, IMAGE_RECT, CAMERA_INFO_RECT)
    table = graph.publisher(CORRESPONDENCES)

    def send() -> None:
        for side in SIDES:
            cameras.info(side, getattr(RIG, side))
        message = correspondences_message(_rows(RIG, 0.0), cameras.stamp_ns, "left_eye")
        message.data = message.data[:-5]
        table.publish(message)
        cameras.stamp_ns += STEP_NS

    cameras.until(send, told(graph, "triangulation", ERROR, "bytes", "2 rows", "announced"), "the table")
    assert poses == []


def test_capture_waits_for_listeners_and_then_tells_how_far_it_is(tmp_path: Path) -> None:
    from recordings import Recording

    bag = Recording.of(RIG, *[(GREY, GREY)] * 3).write(tmp_path / "bag")
    with reserved_domain() as domain:
        graph = Graph(domain, ["-p", f"source:={bag}", "-p", "wait_for_subscribers_s:=60.0"])
        node = graph.host(CaptureNode(graph.context))
        graph.wait(told(graph, "capture", WARN, "waiting for subscribers"), "it waits")
        left = graph.listen(IMAGE_RAW["left"])
        graph.spin(0.3)
        assert left == []
        right = graph.listen(IMAGE_RAW["right"])
        graph.spin(0.15)
        late = graph.listen(CAMERA_INFO["left"])  # nobody subscribes to all topics at the same moment
        graph.wait(lambda: len(left) == len(right) == len(late) == 3, "all three pairs, and their camera_info")
        graph.wait(told(graph, "capture", OK, "finished", str(bag), "3 pairs"), "the end")
        graph.wait(lambda: node.finished, "done")
        graph.close()


def test_an_option_changed_live_does_not_look_like_a_dead_camera(graph: Graph) -> None:
    node = graph.host(RectificationNode(graph.context))
    rectified, cameras = graph.listen(IMAGE_RECT["left"]), Cameras(graph)
    cameras.until(cameras.pair, told(graph, "rectification", OK, "pairs rectified"), "it works")
    graph.spin(0.7)  # beyond the time after which a silent camera would be told
    assert graph.set_parameter("rectification", "max_stamp_offset_s", 0.02).successful
    assert node.status().level == WARN
    before = len(rectified)
    cameras.until(cameras.pair, lambda: len(rectified) > before, "it goes on")
