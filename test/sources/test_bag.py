from __future__ import annotations

import errno
import re
import shutil
import sqlite3
import sys
import tracemalloc
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
from mcap.writer import CompressionType
from mcap.writer import Writer as McapWriter
from rosbags.rosbag1 import Writer as Ros1Writer
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin
from rosbags.rosbag2 import Writer as Ros2Writer
from rosbags.typesys import Stores, get_typestore

from stereo_pick.core.errors import CalibrationError, ImageError, ParameterError, SourceError, StereoPickError
from stereo_pick.core.images import pixels
from stereo_pick.sources.bag import BagSource
from stereo_pick.sources.opening import open_source
from stereo_pick.sources.source import without_partner

ROS2 = get_typestore(Stores.ROS2_JAZZY)
ROS1 = get_typestore(Stores.ROS1_NOETIC)
WIDTH, HEIGHT = 12, 8
MS = 1_000_000
LEFT, RIGHT = "/stereo/left/image_raw", "/stereo/right/image_raw"


@dataclass(frozen=True)
class Message:
    """What a test writes: at `log_ns` a picture (or a calibration) of `stamp_ns`."""

    topic: str
    stamp_ns: int
    content: Any
    log_ns: int = -1
    kind: str = "Image"
    extra: dict[str, Any] = field(default_factory=dict)

    @property
    def type(self) -> str:
        return f"sensor_msgs/msg/{self.kind}"

    @property
    def time(self) -> int:
        return self.stamp_ns + 50 * MS if self.log_ns < 0 else self.log_ns


def picture(seed: int) -> np.ndarray:
    return np.random.default_rng(seed).integers(0, 256, (HEIGHT, WIDTH), np.uint8)


def stereo(count: int, right_offset_ns: int = 0, left: str = LEFT, right: str = RIGHT) -> list[Message]:
    """`count` pairs at 30 Hz; the i-th pair shows pictures 2 i and 2 i + 1."""
    messages = []
    for i in range(count):
        stamp_ns = 10**18 + i * 33 * MS
        messages.append(Message(left, stamp_ns, picture(2 * i)))
        messages.append(Message(right, stamp_ns + right_offset_ns, picture(2 * i + 1)))
    return messages


def camera_info(topic: str, tx: float = 0.0, focal_px: float = 100.0, x_offset: int = 0) -> Message:
    K = np.array([focal_px, 0, WIDTH / 2, 0, focal_px, HEIGHT / 2, 0, 0, float(focal_px > 0)])
    P = np.array([focal_px, 0, WIDTH / 2, tx, 0, focal_px, HEIGHT / 2, 0, 0, 0, float(focal_px > 0), 0])
    content = {"k": K, "d": np.arange(5) / 100, "r": np.eye(3).ravel(), "p": P}
    return Message(topic, 10**18, content, kind="CameraInfo", extra={"x_offset": x_offset})


def compressed(message: Message, suffix: str = "/compressed") -> Message:
    data = cv2.imencode(".png", message.content)[1].ravel()
    return Message(message.topic + suffix, message.stamp_ns, data, kind="CompressedImage")


def ros_message(store: Any, message: Message) -> Any:
    """The rosbags object of a message in the types of ROS 1 or ROS 2."""
    types = store.types
    stamp = types["builtin_interfaces/msg/Time"](*divmod(message.stamp_ns, 10**9))
    ros1 = store is ROS1
    header = types["std_msgs/msg/Header"](
        **({"seq": 0} if ros1 else {}), stamp=stamp, frame_id=message.topic + "_frame"
    )
    make = types[message.type]
    if message.kind == "CompressedImage":
        return make(header=header, data=message.content, **{"format": "png", **message.extra})
    if message.kind == "CameraInfo":
        matrices = {name.upper() if ros1 else name: value for name, value in message.content.items()}
        x_offset = message.extra["x_offset"]
        width = WIDTH - x_offset if x_offset else 0
        roi = types["sensor_msgs/msg/RegionOfInterest"](x_offset, 0, 0, width, False)
        return make(
            header=header,
            height=HEIGHT,
            width=WIDTH,
            distortion_model="plumb_bob",
            binning_x=0,
            binning_y=0,
            roi=roi,
            **matrices,
        )
    image = message.content
    fields = {"height": HEIGHT, "width": WIDTH, "step": image.strides[0], "data": image.ravel()}
    return make(header=header, encoding="mono8", is_bigendian=0, **{**fields, **message.extra})


def write_ros2(
    path: Path,
    messages: Sequence[Message],
    plugin: StoragePlugin = StoragePlugin.MCAP,
    compression: CompressionMode = CompressionMode.NONE,
    others: Mapping[str, str] | None = None,
) -> Path:
    """others: further topics with the definitions of their type, without messages."""
    writer = Ros2Writer(path, version=9, storage_plugin=plugin)
    writer.set_compression(compression, CompressionFormat.ZSTD)
    with writer:
        for topic, definition in (others or {}).items():
            writer.add_connection(topic, "robot_msgs/msg/State", msgdef=definition, rihs01="RIHS01_" + "0" * 64)
        connections: dict[str, Any] = {}
        for message in messages:
            if message.topic not in connections:
                connections[message.topic] = writer.add_connection(message.topic, message.type, typestore=ROS2)
            data = ROS2.serialize_cdr(ros_message(ROS2, message), message.type)
            writer.write(connections[message.topic], message.time, data)
    return path


def write_sqlite(path: Path, messages: Sequence[Message]) -> Path:
    return write_ros2(path, messages, StoragePlugin.SQLITE3)


def write_ros1(path: Path, messages: Sequence[Message]) -> Path:
    path = path.with_suffix(".bag")
    with Ros1Writer(path) as writer:
        connections: dict[str, Any] = {}
        for message in messages:
            if message.topic not in connections:
                connections[message.topic] = writer.add_connection(message.topic, message.type, typestore=ROS1)
            data = ROS1.serialize_ros1(ros_message(ROS1, message), message.type)
            writer.write(connections[message.topic], message.time, data)
    return path


def write_bare_mcap(
    path: Path, messages: Sequence[Message], compression: CompressionType = CompressionType.NONE
) -> Path:
    """A file as rosbag2 writes it, with checksums, and here with one pair or two in a chunk."""
    path = path.with_suffix(".mcap")
    with path.open("wb") as stream:
        writer = McapWriter(stream, chunk_size=600, compression=compression)
        writer.start(profile="ros2", library="test")
        channels: dict[str, int] = {}
        for message in messages:
            if message.topic not in channels:
                definition = ROS2.generate_msgdef(message.type, ros_version=2)[0].encode()
                schema = writer.register_schema(message.type, "ros2msg", definition)
                channels[message.topic] = writer.register_channel(message.topic, "cdr", schema)
            data = bytes(ROS2.serialize_cdr(ros_message(ROS2, message), message.type))
            writer.add_message(channels[message.topic], message.time, data, message.time)
        writer.finish()
    return path


def one_line(error: pytest.ExceptionInfo[StereoPickError]) -> str:
    text = str(error.value)
    assert "\n" not in text
    return text


WRITERS = {"mcap": write_ros2, "sqlite3": write_sqlite, "ros1": write_ros1, "bare_mcap": write_bare_mcap}


@pytest.fixture(params=WRITERS)
def write(request: pytest.FixtureRequest) -> Any:
    return WRITERS[request.param]


def test_every_format_gives_back_what_was_recorded(tmp_path: Path, write: Any) -> None:
    source = open_source(write(tmp_path / "bag", stereo(5)))
    pairs = list(source)

    assert source.count == len(pairs) == 5
    assert source.has_stamps
    for i, pair in enumerate(pairs):
        assert (pixels(pair.left) == picture(2 * i)).all()
        assert (pixels(pair.right) == picture(2 * i + 1)).all()
        assert pair.stamp_ns == 10**18 + i * 33 * MS
        assert pair.recorded_ns == pair.stamp_ns + 50 * MS
        assert pair.left_frame_id == LEFT + "_frame"
        assert pair.right_frame_id == RIGHT + "_frame"


@pytest.mark.parametrize("late", [10, 29])
def test_images_pair_though_one_camera_was_recorded_much_later(tmp_path: Path, late: int) -> None:
    messages = [
        replace(each, log_ns=each.stamp_ns + (late * 33 * MS if "right" in each.topic else 0)) for each in stereo(40)
    ]
    by_time = sorted(messages, key=lambda each: each.log_ns)
    assert len(list(open_source(write_ros2(tmp_path / "bag", by_time)))) == 40


@pytest.mark.parametrize(("first", "second"), [(LEFT, RIGHT), (RIGHT, LEFT)])
def test_an_image_that_the_next_one_overtook_costs_its_own_pair_only(tmp_path: Path, first: str, second: str) -> None:
    messages = stereo(6, left=first, right=second)
    messages[4], messages[6] = messages[6], messages[4]
    by_time = [replace(each, log_ns=10**18 + i) for i, each in enumerate(messages)]
    assert len(list(open_source(write_ros2(tmp_path / "bag", by_time)))) == 5


def test_iterating_again_starts_over(tmp_path: Path, write: Any) -> None:
    source = open_source(write(tmp_path / "bag", stereo(3)))
    next(iter(source))
    assert [pair.stamp_ns for pair in source] == [pair.stamp_ns for pair in source]


@pytest.mark.parametrize("mode", [CompressionMode.MESSAGE, CompressionMode.FILE, CompressionMode.STORAGE])
def test_compressed_bags_are_read(tmp_path: Path, mode: CompressionMode) -> None:
    assert len(list(open_source(write_ros2(tmp_path / "bag", stereo(4), compression=mode)))) == 4


@pytest.mark.parametrize("compression", [CompressionType.LZ4, CompressionType.ZSTD])
def test_compressed_chunks_are_read(tmp_path: Path, compression: CompressionType) -> None:
    assert len(list(open_source(write_bare_mcap(tmp_path / "bag", stereo(4), compression)))) == 4


@pytest.mark.parametrize("plugin", list(StoragePlugin))
def test_a_bare_file_and_a_folder_without_metadata_are_read(tmp_path: Path, plugin: StoragePlugin) -> None:
    folder = write_ros2(tmp_path / "bag", stereo(3), plugin)
    (folder / "metadata.yaml").unlink()
    (file,) = folder.iterdir()
    assert len(list(open_source(file))) == len(list(open_source(folder))) == 3


def test_an_old_bag_without_message_definitions_is_read(tmp_path: Path) -> None:
    folder = write_sqlite(tmp_path / "bag", stereo(3))
    connection = sqlite3.connect(next(folder.glob("*.db3")))
    connection.executescript("UPDATE schema SET schema_version = 3; DROP TABLE message_definitions;")
    connection.close()
    assert len(list(open_source(folder))) == 3


def test_a_folder_of_ros2_named_like_a_bag_of_ros1_is_read(tmp_path: Path) -> None:
    assert len(list(open_source(write_ros2(tmp_path / "cell.bag", stereo(3))))) == 3


@pytest.mark.parametrize("definition", ["float64 x", "other_msgs/Thing x", "int64 a\n---\nint64 b"])
def test_what_other_topics_hold_is_of_no_concern(tmp_path: Path, definition: str) -> None:
    """A hash that does not fit, a definition that is not there, one that is no message's: a robot has many topics."""
    folder = write_ros2(tmp_path / "bag", stereo(3), others={"/robot/state": definition})
    assert len(list(open_source(folder))) == 3


def test_compressed_images_are_decoded(tmp_path: Path, write: Any) -> None:
    source = BagSource.open(write(tmp_path / "bag", [compressed(message) for message in stereo(3)]))
    assert source.left_topic == LEFT + "/compressed"
    for i, pair in enumerate(source):
        assert (pixels(pair.left) == picture(2 * i)).all()
        assert (pixels(pair.right) == picture(2 * i + 1)).all()


def test_a_compressed_bayer_mosaic_is_refused_as_it_is_uncompressed(tmp_path: Path) -> None:
    """image_transport compresses the mosaic as it is, and decoded it looks like a grey image."""
    bayer = [replace(compressed(each), extra={"format": "bayer_rggb8; jpeg compressed "}) for each in stereo(2)]
    with pytest.raises(
        ImageError, match=f"{LEFT}/compressed image of stamp .* the unknown encoding 'bayer_rggb8': debay"
    ):
        list(BagSource.open(write_ros2(tmp_path / "bag", bayer)))


def test_an_unknown_compression_is_named(tmp_path: Path) -> None:
    """Not only the plugin `compressed` of image_transport sends a CompressedImage: zstd does, too."""
    packed = [
        replace(each, kind="CompressedImage", content=each.content.ravel(), extra={"format": "zstd"})
        for each in stereo(2)
    ]
    with pytest.raises(ImageError, match="is compressed as 'zstd', neither as JPEG nor as PNG: record image_raw"):
        list(BagSource.open(write_ros2(tmp_path / "bag", packed)))


def test_a_broken_compressed_image_is_named(tmp_path: Path) -> None:
    messages = [compressed(message) for message in stereo(3)]
    messages[2] = Message(messages[2].topic, messages[2].stamp_ns, messages[2].content[:40], kind="CompressedImage")
    received, error = drained(write_ros2(tmp_path / "bag", messages))
    assert received == 1
    assert isinstance(error, ImageError)
    assert LEFT in str(error)


def test_a_camera_info_topic_of_another_type_is_none(tmp_path: Path) -> None:
    others = [Message(f"/stereo/{side}/camera_info", 10**18, picture(0)) for side in ("left", "right")]
    source = BagSource.open(write_ros2(tmp_path / "bag", others + stereo(2)))
    assert source.cameras is None
    assert len(list(source)) == 2


def test_cameras_are_those_of_the_recording(tmp_path: Path, write: Any) -> None:
    infos = [camera_info("/stereo/left/camera_info"), camera_info("/stereo/right/camera_info", tx=-12.5)]
    for messages in (stereo(1), [compressed(message) for message in stereo(1)]):
        cameras = open_source(write(tmp_path / f"bag{messages[0].kind}", infos + messages)).cameras
        assert cameras is not None
        for camera, name, info in zip(cameras, ("left", "right"), infos):
            assert (camera.name, camera.frame_size) == (name, (WIDTH, HEIGHT))
            for matrix in "kdrp":
                assert (getattr(camera, matrix.upper()).ravel() == info.content[matrix]).all()


def test_a_region_of_interest_is_what_its_camera_sees(tmp_path: Path, write: Any) -> None:
    infos = [camera_info("/stereo/left/camera_info", x_offset=3), camera_info("/stereo/right/camera_info", tx=-12.5)]
    cameras = open_source(write(tmp_path / "bag", infos + stereo(1))).cameras
    assert cameras is not None
    assert [camera.frame_size for camera in cameras] == [(WIDTH - 3, HEIGHT), (WIDTH, HEIGHT)]
    assert [camera.K[0, 2] for camera in cameras] == [WIDTH / 2 - 3, WIDTH / 2]
    moved = replace(camera_info("/stereo/left/camera_info", x_offset=4), stamp_ns=infos[0].stamp_ns + 1)
    _, error = drained(write(tmp_path / "moved", [*infos, moved, *stereo(3)]))
    assert "/stereo/left/camera_info changes" in str(error)


def test_without_both_camera_infos_there_are_no_cameras(tmp_path: Path, write: Any) -> None:
    assert open_source(write(tmp_path / "none", stereo(1))).cameras is None
    messages = [camera_info("/stereo/left/camera_info"), *stereo(1)]
    assert open_source(write(tmp_path / "one", messages)).cameras is None


def test_an_uncalibrated_camera_is_named_but_its_images_are_read(tmp_path: Path) -> None:
    infos = [camera_info(f"/stereo/{side}/camera_info", focal_px=0.0) for side in ("left", "right")]
    source = open_source(write_ros2(tmp_path / "bag", infos + stereo(2)))
    assert len(list(source)) == 2
    with pytest.raises(CalibrationError, match="/stereo/left/camera_info.*focal length"):
        source.cameras  # noqa: B018


def test_a_calibration_that_changes_midway_ends_the_reading_unless_another_one_is_used(
    tmp_path: Path, write: Any
) -> None:
    infos = [camera_info("/stereo/left/camera_info"), camera_info("/stereo/right/camera_info", tx=-12.5)]
    images = stereo(5)
    renewed = [replace(each, stamp_ns=images[6].stamp_ns) for each in (infos[0], camera_info(infos[1].topic, tx=-12.6))]
    path = write(tmp_path / "bag", [*infos, *images[:6], *renewed, *images[6:]])
    received, error = drained(path)
    assert received == 3
    assert isinstance(error, SourceError)
    assert f"/stereo/right/camera_info changes at stamp {images[6].stamp_ns / 1e9:.3f} s" in str(error)
    assert len(list(open_source(path, uses_camera_info=False))) == 5
    repeated = [replace(each, stamp_ns=images[6].stamp_ns) for each in infos]
    assert drained(write(tmp_path / "same", [*infos, *images[:6], *repeated, *images[6:]])) == (5, None)


def test_images_without_partner_are_told_of(tmp_path: Path) -> None:
    messages = stereo(5)
    source = open_source(write_ros2(tmp_path / "bag", [each for i, each in enumerate(messages) if i not in (2, 6)]))
    pairs = len(list(source))
    assert (pairs, source.count) == (3, 5)
    assert without_partner(source, pairs).startswith("2 of 5 pairs lack an image")
    assert without_partner(source, 5) == ""


@pytest.mark.parametrize(
    ("topics", "chosen"),
    [
        (["/left/image_raw", "/right/image_raw", "/left/image_rect", "/right/image_rect"], "/left/image_raw"),
        (["/left/image_raw", "/right/image_raw", "/left/image_mono", "/right/image_mono"], "/left/image_raw"),
        (["/cam_left/image", "/cam_right/image", "/arm/image_raw"], "/cam_left/image"),
        (["/left_camera/image_raw", "/right_camera/image_raw"], "/left_camera/image_raw"),
        (["/a/left/image_raw", "/a/right/image_raw", "/b/left/image_raw"], "/a/left/image_raw"),
        (["/bright/image_raw", "/cleft/image_raw", "/Left/image", "/Right/image"], "/Left/image"),
    ],
)
def test_topics_are_found_by_their_names(tmp_path: Path, topics: list[str], chosen: str) -> None:
    messages = [Message(topic, 10**18, picture(i)) for i, topic in enumerate(topics)]
    source = BagSource.open(write_ros2(tmp_path / "bag", messages))
    assert source.left_topic == chosen
    assert source.right_topic == chosen.replace("left", "right").replace("Left", "Right")


def test_uncompressed_is_preferred_unless_it_is_silent(tmp_path: Path) -> None:
    messages = stereo(2) + [compressed(message) for message in stereo(2)]
    assert BagSource.open(write_ros2(tmp_path / "both", messages)).left_topic == LEFT
    silent = write_sqlite(tmp_path / "silent", messages)
    connection = sqlite3.connect(next(silent.glob("*.db3")))
    connection.execute("DELETE FROM messages WHERE topic_id IN (SELECT id FROM topics WHERE name LIKE '%image_raw')")
    connection.commit()
    connection.close()
    assert BagSource.open(next(silent.glob("*.db3"))).left_topic == LEFT + "/compressed"


def test_given_topics_are_taken_and_one_suffices(tmp_path: Path) -> None:
    messages = stereo(2, left="/a/left/image_rect", right="/a/right/image_rect") + stereo(
        2, left="/cam0", right="/cam1"
    )
    path = write_ros2(tmp_path / "bag", messages)
    assert BagSource.open(path, left_topic="/a/left/image_rect").right_topic == "/a/right/image_rect"
    assert BagSource.open(path, right_topic="/a/right/image_rect").left_topic == "/a/left/image_rect"
    assert len(list(open_source(path, left_topic="/cam0", right_topic="/cam1"))) == 2


@pytest.mark.parametrize(
    ("topics", "options", "parts"),
    [
        ([], {}, ["no image topic", "none"]),
        (
            ["/cam0/image_raw", "/cam1/image_raw"],
            {},
            ["/cam0/image_raw, /cam1/image_raw", "left_topic and right_topic"],
        ),
        (["/left/image_raw"], {}, ["/left/image_raw", "record both cameras"]),
        (["/left/image_rect", "/right/image_rect"], {}, ["only rectified", "/left/image_rect", "image_raw"]),
        (
            ["/a/left/image_raw", "/a/right/image_raw", "/b/left/image_raw", "/b/right/image_raw"],
            {},
            ["/a/left/image_raw with /a/right/image_raw, /b/left/image_raw with /b/right/image_raw", "left_topic"],
        ),
        (
            ["/a/left/image_raw", "/a/right/image_raw", "/b/left/image_raw", "/b/right/image_raw"],
            {},
            ["choose one by left_topic and right_topic (--left-topic and --right-topic)"],
        ),
        ([LEFT, RIGHT], {"left_topic": "/nope"}, ["left_topic = /nope", f"{LEFT}, {RIGHT}"]),
        ([LEFT, RIGHT], {"right_topic": "/nope"}, ["right_topic = /nope", f"{LEFT}, {RIGHT}"]),
        ([LEFT, RIGHT], {"left_topic": LEFT, "right_topic": LEFT}, ["both", LEFT]),
        ([LEFT, RIGHT], {"left_topic": RIGHT}, [f"{LEFT}, {RIGHT}", "set left_topic and right_topic"]),
        ([LEFT, RIGHT], {"left_topic": RIGHT}, [f"left_topic = {RIGHT} (--left-topic) is the right one", "exchange"]),
        ([LEFT, RIGHT], {"right_topic": LEFT}, [f"right_topic = {LEFT} (--right-topic) is the left one", "exchange"]),
        ([LEFT, RIGHT, "/arm"], {"left_topic": "/arm"}, ["no image topics whose names differ", "--right-topic"]),
    ],
)
def test_a_choice_that_is_not_clear_is_refused(
    tmp_path: Path, topics: list[str], options: dict[str, str], parts: list[str], write: Any
) -> None:
    path = write(tmp_path / "bag", [Message(topic, 10**18, picture(0)) for topic in topics])
    with pytest.raises(SourceError) as error:
        open_source(path, **options)
    for part in [str(path), *parts]:
        assert part in one_line(error)


def test_a_bag_without_images_lists_its_topics(tmp_path: Path, write: Any) -> None:
    path = write(tmp_path / "bag", [camera_info("/left/camera_info")])
    with pytest.raises(SourceError, match="no image topic among its topics .*/left/camera_info"):
        open_source(path)


def test_a_silent_camera_is_named(tmp_path: Path) -> None:
    path = write_sqlite(tmp_path / "bag", stereo(4))
    file = next(path.glob("*.db3"))
    connection = sqlite3.connect(file)
    connection.execute("DELETE FROM messages WHERE topic_id = (SELECT id FROM topics WHERE name = ?)", (RIGHT,))
    connection.commit()
    connection.close()
    with pytest.raises(SourceError, match=f"{RIGHT} has no images, {LEFT} 4: was its camera running"):
        open_source(file)


def test_images_that_are_near_in_time_pair_and_others_are_explained(tmp_path: Path, write: Any) -> None:
    assert len(list(open_source(write(tmp_path / "near", stereo(5, right_offset_ns=4 * MS))))) == 5
    path = write(tmp_path / "far", stereo(5, right_offset_ns=16 * MS))
    with pytest.raises(SourceError) as error:
        list(open_source(path))
    assert f"{LEFT} and {RIGHT}" in one_line(error)
    assert "differ by 16 ms, more than max_stamp_offset_s = 0.01: are the cameras synchronised?" in one_line(error)
    assert len(list(open_source(path, max_stamp_offset_s=0.0161))) == 5


def test_images_without_stamps_are_no_pairs(tmp_path: Path, write: Any) -> None:
    unstamped = [replace(each, stamp_ns=0, log_ns=each.time) for each in stereo(4)]
    del unstamped[3]  # from here on each left image would pair with the right one of the next moment
    with pytest.raises(SourceError, match=f"{LEFT}: images have the stamp 0: the driver does not set header.stamp"):
        list(open_source(write(tmp_path / "bag", unstamped)))


def test_images_of_one_stamp_are_no_pairs(tmp_path: Path, write: Any) -> None:
    alike = [replace(each, stamp_ns=10**18, log_ns=each.time) for each in stereo(4)]
    del alike[2]  # from here on each right image would pair with the left one of the next moment
    source = open_source(write(tmp_path / "bag", alike))
    with pytest.raises(SourceError, match=f"{RIGHT}: images repeat the stamp of the one before"):
        list(source)
    first = next(iter(source))
    assert [bytes(side.data) for side in (first.left, first.right)] == [picture(i).tobytes() for i in (0, 1)]


def test_no_image_pairs_with_one_of_another_lap(tmp_path: Path, write: Any) -> None:
    """A recording of a replay that started over: each lap has the stamps of the other, and pictures of its own."""
    first, second = stereo(4), stereo(8)[8:]
    lap_ns = 10**9
    second = [replace(two, stamp_ns=one.stamp_ns, log_ns=one.time + lap_ns) for one, two in zip(first, second)]
    del first[-2], second[-1]  # the last left image of the first lap, the last right one of the second
    found = list(open_source(write(tmp_path / "bag", first + second)))
    shown = {picture(i).tobytes(): i for i in range(16)}
    pairs = [tuple(shown[bytes(side.data)] for side in (each.left, each.right)) for each in found]
    assert pairs == [(0, 1), (2, 3), (4, 5), (8, 9), (10, 11), (12, 13)]


@pytest.mark.parametrize("offset_s", [-0.001, 1.001, float("nan"), float("inf")])
def test_an_impossible_offset_is_refused(tmp_path: Path, offset_s: float) -> None:
    with pytest.raises(ParameterError, match="max_stamp_offset_s"):
        open_source(write_ros2(tmp_path / "bag", stereo(1)), max_stamp_offset_s=offset_s)


def test_the_bag_is_read_as_a_stream(tmp_path: Path, write: Any) -> None:
    row_bytes = 100_000
    wide = np.zeros((HEIGHT, row_bytes), np.uint8)
    messages = [Message(message.topic, message.stamp_ns, wide) for message in stereo(20)]
    source = open_source(write(tmp_path / "bag", messages))
    tracemalloc.start()
    count = sum(1 for _ in source)
    peak_bytes = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert count == 20
    assert peak_bytes < 0.3 * len(messages) * wide.nbytes


def drained(path: Path) -> tuple[int, Exception | None]:
    """How many pairs a bag gives, and the error that it ends with."""
    count = 0
    try:
        for _ in open_source(path):
            count += 1
    except StereoPickError as error:
        assert "\n" not in str(error)
        return count, error
    return count, None


def test_an_absent_bag_is_named(tmp_path: Path) -> None:
    for opening in (open_source, BagSource.open):
        with pytest.raises(SourceError, match=r"nowhere\.mcap: no such bag"):
            opening(tmp_path / "nowhere.mcap")


def test_another_file_is_no_bag(tmp_path: Path) -> None:
    (tmp_path / "film.mp4").write_bytes(b"film")
    with pytest.raises(SourceError, match=r"film\.mp4 is no bag \(\.mcap, \.db3, \.bag\)"):
        open_source(tmp_path / "film.mp4")


def test_several_files_without_metadata_need_an_index(tmp_path: Path) -> None:
    for name in ("a", "b"):
        write_bare_mcap(tmp_path / name, stereo(1))
    with pytest.raises(SourceError, match="2 bag files and no metadata.yaml.*ros2 bag reindex"):
        open_source(tmp_path)


def test_damaged_metadata_is_named(tmp_path: Path) -> None:
    path = write_ros2(tmp_path / "bag", stereo(2))
    for text in ("rosbag2_bagfile_information: {", "", "x: 1", "\udcff"):
        (path / "metadata.yaml").write_text(text, errors="surrogateescape")
        with pytest.raises(SourceError, match="metadata.yaml.*`ros2 bag reindex .*/bag`") as error:
            open_source(path)
        one_line(error)
        assert "mcap recover" not in str(error.value)


REPAIRS = {"mcap": "mcap recover", "sqlite3": "sqlite3", "ros1": "rosbag reindex", "bare_mcap": "mcap recover"}


def storage_file(path: Path) -> Path:
    return path if path.is_file() else next(file for file in path.iterdir() if file.suffix != ".yaml")


@pytest.mark.parametrize("kind", WRITERS)
def test_a_bag_cut_short_says_how_to_repair_it(tmp_path: Path, kind: str) -> None:
    path = WRITERS[kind](tmp_path / "bag", stereo(60))
    content = storage_file(path).read_bytes()
    refused = 0
    for percent in range(0, 100, 7):
        storage_file(path).write_bytes(content[: len(content) * percent // 100])
        count, error = drained(path)
        assert count < 60
        assert isinstance(error, SourceError)
        assert str(path) in str(error)
        refused += REPAIRS[kind] in str(error)
    assert refused > 10


@pytest.mark.parametrize("kind", WRITERS)
def test_wrong_bytes_never_end_in_a_traceback(tmp_path: Path, kind: str) -> None:
    path = WRITERS[kind](tmp_path / "bag", stereo(4))
    content = storage_file(path).read_bytes()
    rng = np.random.default_rng(1)
    damaged = 0
    for _ in range(80):
        wrong = bytearray(content)
        at = int(rng.integers(len(wrong)))
        wrong[at : at + 4] = rng.integers(0, 256, len(wrong[at : at + 4]), np.uint8).tobytes()
        storage_file(path).write_bytes(wrong)
        damaged += drained(path)[1] is not None
    assert damaged > 2


def spoil_the_middle(path: Path) -> None:
    """Spoil as much as surely reaches into a chunk."""
    content = bytearray(path.read_bytes())
    middle = len(content) // 2
    content[middle : middle + 300] = bytes(byte ^ 0x10 for byte in content[middle : middle + 300])
    path.write_bytes(content)


@pytest.mark.parametrize("compression", list(CompressionType))
def test_what_was_recorded_before_a_damage_is_read(tmp_path: Path, compression: CompressionType) -> None:
    path = write_bare_mcap(tmp_path / "bag", stereo(30), compression)
    spoil_the_middle(path)
    count, error = drained(path)
    assert 5 < count < 25
    assert isinstance(error, SourceError)
    assert re.search(rf"cannot be read beyond its first ({2 * count}|{2 * count + 1}) messages", str(error))


def test_a_pair_that_waited_for_a_nearer_image_comes_before_the_damage(tmp_path: Path) -> None:
    path = write_bare_mcap(tmp_path / "bag", stereo(30, right_offset_ns=2 * MS))
    spoil_the_middle(path)
    count, error = drained(path)
    assert 5 < count < 25
    assert re.search(rf"beyond its first ({2 * count}|{2 * count + 1}) messages", str(error))


def test_a_cut_compressed_file_is_named(tmp_path: Path) -> None:
    path = write_ros2(tmp_path / "bag", stereo(10), compression=CompressionMode.FILE)
    file = storage_file(path)
    file.write_bytes(file.read_bytes()[:-20])
    count, error = drained(path)
    assert count == 0
    assert "EOFError" in str(error)


@pytest.mark.parametrize("plugin", list(StoragePlugin))
def test_a_compressed_file_without_its_folder_says_how_to_read_it(tmp_path: Path, plugin: StoragePlugin) -> None:
    folder = write_ros2(tmp_path / "bag", stereo(2), plugin, CompressionMode.FILE)
    file = storage_file(folder)
    with pytest.raises(SourceError, match=r"metadata\.yaml is no bag .*; give the folder that it is in"):
        open_source(folder / "metadata.yaml")
    (folder / "metadata.yaml").unlink()
    for path in (folder, file):
        with pytest.raises(
            SourceError, match=rf"is a file of a compressed bag: .*`zstd -d {file.name} -o {file.stem}`"
        ):
            open_source(path)


def test_a_lack_of_room_to_unpack_is_no_damage(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folder = write_ros2(tmp_path / "bag", stereo(2), compression=CompressionMode.FILE)

    def full(*_: Any) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(shutil, "copyfileobj", full)
    with pytest.raises(SourceError, match=r"No space left on device\): .* unpacked in .*name another folder by TMPDIR"):
        open_source(folder)


def test_a_missing_part_is_named(tmp_path: Path) -> None:
    path = write_ros2(tmp_path / "bag", stereo(2))
    storage_file(path).unlink()
    with pytest.raises(SourceError, match=r"bag cannot be read .*bag\.mcap"):
        open_source(path)


def test_without_rosbags_it_is_asked_for(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """No ROS 2 brings it."""
    (tmp_path / "bag.mcap").touch()
    for module in ("bag", "bag_reader"):
        monkeypatch.delitem(sys.modules, f"stereo_pick.sources.{module}")
    monkeypatch.setitem(sys.modules, "rosbags.highlevel", None)
    with pytest.raises(SourceError, match=r"bag.mcap: bags need rosbags \(.*\): pip install rosbags"):
        open_source(tmp_path / "bag.mcap")
