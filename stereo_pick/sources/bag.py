"""A bag with the images of two cameras: rosbag2 (mcap or sqlite3) or ROS 1."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from rosbags.interfaces import TopicInfo

from stereo_pick.core.arrays import Floats
from stereo_pick.core.camera import Camera
from stereo_pick.core.errors import CalibrationError, ParameterError, SourceError
from stereo_pick.core.images import FULL_SCALE_16, ImageBuffer, decode_message, encode
from stereo_pick.core.pairing import MOST_OFFSET_S, Pair, Side, StampOrder, StampPairer
from stereo_pick.core.sensor_window import SensorWindow
from stereo_pick.sources.bag_reader import BagReader, Recorded, messages, opened
from stereo_pick.sources.bag_topics import COMPRESSED_TYPE, camera_info_topic, choose_topics
from stereo_pick.sources.source import SourcePair

_CAMERA_INFO_TYPE = "sensor_msgs/msg/CameraInfo"


@dataclass(frozen=True)
class BagSource:
    """The stereo pairs of a bag, paired by the stamps of their headers; made by `open`.

    count: how many images there are of the camera that has more. The bag is read as a stream, anew at each iteration.
    uses_camera_info: whether its pairs are rectified by its own `cameras`, so that another calibration midway is wrong.
    full_scale_16: the value of a 16-bit image that is white.
    """

    path: Path
    left_topic: str
    right_topic: str
    max_stamp_offset_s: float
    count: int
    uses_camera_info: bool = True
    full_scale_16: int = FULL_SCALE_16

    @staticmethod
    def open(
        path: Path,
        left_topic: str = "",
        right_topic: str = "",
        max_stamp_offset_s: float = 0.01,
        uses_camera_info: bool = True,
        full_scale_16: int = FULL_SCALE_16,
    ) -> BagSource:
        """Find the image topics (by their names, where they are not given) of the bag at `path`.

        Raises SourceError on a bag that is absent or damaged, or in which the choice of topics is
        not clear; ParameterError on an offset outside 0 .. 1 s.
        """
        if not 0 <= max_stamp_offset_s <= MOST_OFFSET_S:
            raise ParameterError(
                f"max_stamp_offset_s = {max_stamp_offset_s} is outside its range 0 .. {MOST_OFFSET_S:g}"
            )
        with opened(path) as reader:
            topics = reader.topics
        try:
            left_topic, right_topic = choose_topics(topics, left_topic, right_topic)
            _check_images(topics, left_topic, right_topic)
        except SourceError as error:
            raise SourceError(f"{path}: {error}") from None
        count = max(topics[left_topic].msgcount, topics[right_topic].msgcount)
        return BagSource(path, left_topic, right_topic, max_stamp_offset_s, count, uses_camera_info, full_scale_16)

    @property
    def paths(self) -> tuple[Path, ...]:
        """The bag's file or folder."""
        return (self.path,)

    @property
    def names(self) -> Mapping[Side, str]:
        """The topics."""
        return {"left": self.left_topic, "right": self.right_topic}

    @property
    def has_stamps(self) -> bool:
        """True: every image message has one."""
        return True

    @property
    def cameras(self) -> tuple[Camera, Camera] | None:
        """Left and right calibration: the first camera_info beside each image topic; None where one is missing.

        Raises CalibrationError, naming the topic, on one that no real camera has (an uncalibrated
        driver sends zeros), SourceError where the bag is damaged.
        """
        with opened(self.path) as reader:
            left = self._camera(reader, "left", camera_info_topic(self.left_topic))
            right = self._camera(reader, "right", camera_info_topic(self.right_topic))
        return None if left is None or right is None else (left, right)

    def __iter__(self) -> Iterator[SourcePair]:
        """Yield the pairs; what was recorded before a damage comes before its error.

        Raises SourceError where the bag is damaged, its images are not stamped or several alike, its calibration
        changes or nothing pairs (with the reason), ImageError on a compressed image that cannot be decoded.
        """
        pairer: StampPairer[Recorded] = StampPairer(round(self.max_stamp_offset_s * 1e9))
        order, damage = StampOrder(), None
        with opened(self.path) as reader:
            try:
                for recorded in self._images(reader):
                    side: Side = "left" if recorded.topic == self.left_topic else "right"
                    fault = order.fault(side, recorded.stamp_ns)
                    if fault is not None:
                        raise SourceError(f"{self.path}: {recorded.topic}: {fault}")
                    if order.starts_over(side, recorded.stamp_ns):
                        yield from map(self._source_pair, pairer.flush())
                    yield from map(self._source_pair, pairer.add(side, recorded.stamp_ns, recorded))
            except SourceError as error:
                damage = error
        yield from map(self._source_pair, pairer.flush())
        if damage is not None:
            raise damage
        if pairer.counts.pairs == 0:
            raise SourceError(
                f"{self.path}: no stereo pair in {self.left_topic} and {self.right_topic}: {pairer.explain()}"
            )

    def _source_pair(self, pair: Pair[Recorded]) -> SourcePair:
        return SourcePair(
            _buffer(pair.left, self.full_scale_16),
            _buffer(pair.right, self.full_scale_16),
            pair.left_stamp_ns,
            max(pair.left.recorded_ns, pair.right.recorded_ns),
            pair.left.message.header.frame_id,
            pair.right.message.header.frame_id,
            self.full_scale_16,
        )

    def _images(self, reader: BagReader) -> Iterator[Recorded]:
        """The images, up to where the calibration they are used with no longer holds: SourceError."""
        images = (self.left_topic, self.right_topic)
        infos = (camera_info_topic(topic) for topic in images if self.uses_camera_info)
        first: dict[str, bytes] = {}
        for recorded in messages(self.path, reader, *images, *(topic for topic in infos if _is_info(reader, topic))):
            if recorded.topic in images:
                yield recorded
                continue
            calibration = _calibration(recorded.message)
            if first.setdefault(recorded.topic, calibration) != calibration:
                raise SourceError(
                    f"{self.path}: {recorded.topic} changes at stamp {recorded.stamp_ns / 1e9:.3f} s: what comes then "
                    "needs another calibration; cut the bag there, or give the calibration that holds for all of it"
                )

    def _camera(self, reader: BagReader, name: str, topic: str) -> Camera | None:
        for recorded in messages(self.path, reader, topic) if _is_info(reader, topic) else ():
            try:
                return _camera(name, recorded.message)
            except CalibrationError as error:
                raise CalibrationError(f"{self.path}: {topic}: {error}") from None
        return None


def _is_info(reader: BagReader, topic: str) -> bool:
    """Whether a topic is there, and holds what its name says."""
    return topic in reader.topics and reader.topics[topic].msgtype == _CAMERA_INFO_TYPE


def _check_images(topics: Mapping[str, TopicInfo], left: str, right: str) -> None:
    for topic, other in ((left, right), (right, left)):
        if topics[topic].msgcount == 0:
            count = topics[other].msgcount
            raise SourceError(f"{topic} has no images, {other} {count}: was its camera running? Record again")


def _buffer(recorded: Recorded, full_scale_16: int) -> ImageBuffer:
    message = recorded.message
    if recorded.type == COMPRESSED_TYPE:
        what = f"{recorded.topic} image of stamp {recorded.stamp_ns / 1e9:.3f} s"
        return encode(decode_message(message.data, message.format, what, full_scale_16))
    return ImageBuffer(
        message.width, message.height, message.step, message.encoding, bool(message.is_bigendian), message.data
    )


def _calibration(info: Any) -> bytes:
    """What of a CameraInfo says how to rectify, for comparison."""
    matrices = b"".join(matrix.tobytes() for matrix in _matrices(info))
    return f"{info.width} {info.height} {info.distortion_model} {SensorWindow.of(info)} ".encode() + matrices


def _matrices(info: Any) -> list[Floats]:
    """K, D, R and P of a CameraInfo, which have capital names in ROS 1."""
    return [getattr(info, name) if hasattr(info, name) else getattr(info, name.upper()) for name in "kdrp"]


def _camera(name: str, info: Any) -> Camera:
    K, D, R, P = _matrices(info)
    full = Camera(
        name=name,
        width_px=int(info.width),
        height_px=int(info.height),
        K=K.reshape(3, 3),
        D=D,
        R=R.reshape(3, 3),
        P=P.reshape(3, 4),
        distortion_model=info.distortion_model,
    )
    return SensorWindow.of(info).of_raw(full)
