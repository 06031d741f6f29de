"""Recordings for the tests: bags with what a test wants in them, and the demo bag's first pairs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore

from stereo_pick.core.arrays import Image
from stereo_pick.core.camera import Camera
from stereo_pick.core.images import ImageBuffer, encode, pixels
from stereo_pick.core.rig import StereoRig
from stereo_pick.sources.opening import open_source

ROOT = Path(__file__).resolve().parents[1]
DEMO_BAG = ROOT / "bags" / "demo"
DEMO_RIG = ROOT / "config" / "demo_rig"
START_NS = 1_700_000_000 * 10**9
PERIOD_NS = 100_000_000

_TYPES = get_typestore(Stores.ROS2_JAZZY)


@dataclass(frozen=True)
class Recording:
    """What to write into a bag: pairs of pictures, or of image buffers as they are, and camera_info.

    cameras: by side, those given are in the bag; topics: names of the images; leave_out: topics that are not written.
    """

    pairs: Sequence[tuple[Image | ImageBuffer, Image | ImageBuffer]]
    cameras: Mapping[str, Camera] = field(default_factory=dict)
    topics: Mapping[str, str] = field(default_factory=lambda: {s: f"/{s}/image_raw" for s in ("left", "right")})
    leave_out: tuple[str, ...] = ()
    plugin: StoragePlugin = StoragePlugin.MCAP
    period_ns: int = PERIOD_NS
    start_ns: int = START_NS

    @staticmethod
    def of(rig: StereoRig, *pairs: tuple[Image | ImageBuffer, Image | ImageBuffer], **more: Any) -> Recording:
        return Recording(pairs, {"left": rig.left, "right": rig.right}, **more)

    def stamps_ns(self) -> list[int]:
        return [self.start_ns + index * self.period_ns for index in range(len(self.pairs))]

    def write(self, path: Path) -> Path:
        """Write the bag; each pair has its camera_info before it."""
        with Writer(path, version=9, storage_plugin=self.plugin) as writer:
            connections: dict[str, Any] = {}

            def put(topic: str, message: Any, time_ns: int) -> None:
                if topic in self.leave_out:
                    return
                kind = message.__msgtype__
                if topic not in connections:
                    connections[topic] = writer.add_connection(topic, kind, typestore=_TYPES)
                writer.write(connections[topic], time_ns, _TYPES.serialize_cdr(message, kind))

            for stamp_ns, pair in zip(self.stamps_ns(), self.pairs):
                for side, view in zip(("left", "right"), pair):
                    topic = self.topics[side]
                    if side in self.cameras:
                        info = camera_info(self.cameras[side], stamp_ns, f"{side}_eye")
                        put(f"{topic.rpartition('/')[0]}/camera_info", info, stamp_ns)
                    put(topic, image(view, stamp_ns, f"{side}_eye"), stamp_ns)
        return path


def demo_pairs(count: int) -> list[tuple[Image, Image]]:
    """The first pairs of the demo bag, every third of them: objects have moved in between."""
    found = []
    for index, pair in enumerate(open_source(DEMO_BAG)):
        if index % 3 == 0:
            found.append((pixels(pair.left), pixels(pair.right)))
        if len(found) == count:
            break
    return found


def write_images(folder: Path, pairs: Sequence[tuple[Image, Image]]) -> Path:
    """A folder left00.png, right00.png, left01.png, ..."""
    folder.mkdir(parents=True, exist_ok=True)
    for index, views in enumerate(pairs):
        for side, view in zip(("left", "right"), views):
            assert cv2.imwrite(str(folder / f"{side}{index:02}.png"), view)
    return folder


def image(view: Image | ImageBuffer, stamp_ns: int, frame_id: str) -> Any:
    buffer = view if isinstance(view, ImageBuffer) else encode(view)
    return _make(
        "sensor_msgs/msg/Image",
        header=_header(stamp_ns, frame_id),
        height=buffer.height_px,
        width=buffer.width_px,
        encoding=buffer.encoding,
        is_bigendian=int(buffer.is_bigendian),
        step=buffer.step_bytes,
        data=np.frombuffer(bytes(buffer.data), np.uint8),
    )


def camera_info(camera: Camera, stamp_ns: int, frame_id: str) -> Any:
    def flat(matrix: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.array(matrix).ravel()

    return _make(
        "sensor_msgs/msg/CameraInfo",
        header=_header(stamp_ns, frame_id),
        height=camera.height_px,
        width=camera.width_px,
        distortion_model=camera.distortion_model,
        d=flat(camera.D),
        k=flat(camera.K),
        r=flat(camera.R),
        p=flat(camera.P),
        binning_x=0,
        binning_y=0,
        roi=_make("sensor_msgs/msg/RegionOfInterest", x_offset=0, y_offset=0, height=0, width=0, do_rectify=False),
    )


def _header(stamp_ns: int, frame_id: str) -> Any:
    stamp = _make("builtin_interfaces/msg/Time", sec=stamp_ns // 10**9, nanosec=stamp_ns % 10**9)
    return _make("std_msgs/msg/Header", stamp=stamp, frame_id=frame_id)


def _make(kind: str, **fields: Any) -> Any:
    return _TYPES.types[kind](**fields)
