"""Bags in which a rendered board is held in front of two cameras."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore

from stereo_pick.core.arrays import Image
from stereo_pick.core.calibration.boards import Chessboard
from stereo_pick.core.transform import Transform

ROS2 = get_typestore(Stores.ROS2_JAZZY)
BOARD = Chessboard(7, 5, 0.03)
K = np.array([[420.0, 0, 165], [0, 425, 118], [0, 0, 1]])
right_T_left = Transform(np.eye(3), np.array([-0.06, 0, 0]))
GREY = np.full((240, 320), 128, np.uint8)

Pairs = Sequence[tuple[Image, Image]]


def write_bag(path: Path, pairs: Pairs, topics: tuple[str, str] = ("/left/image_raw", "/right/image_raw")) -> Path:
    types, interval_ns = ROS2.types, 200_000_000
    with Writer(path, version=9, storage_plugin=StoragePlugin.MCAP) as writer:
        connections = [writer.add_connection(topic, "sensor_msgs/msg/Image", typestore=ROS2) for topic in topics]
        for i, pair in enumerate(pairs):
            stamp_ns = 10**18 + i * interval_ns
            for connection, picture in zip(connections, pair):
                writer.write(connection, stamp_ns, ROS2.serialize_cdr(message(types, stamp_ns, picture), IMAGE))
    return path


IMAGE = "sensor_msgs/msg/Image"


def message(types: Any, stamp_ns: int, picture: Image) -> Any:
    header = types["std_msgs/msg/Header"](
        stamp=types["builtin_interfaces/msg/Time"](*divmod(stamp_ns, 10**9)), frame_id="camera"
    )
    height, width = picture.shape
    return types[IMAGE](
        header=header, height=height, width=width, encoding="mono8", is_bigendian=0, step=width, data=picture.ravel()
    )


def rendered_pairs(render_board: Callable[..., Image]) -> Pairs:
    """Ten views of BOARD, differently tilted, 0.5 m before cameras of the matrix K."""
    rng = np.random.default_rng(0)
    pairs = []
    for _ in range(10):
        R = cv2.Rodrigues(rng.uniform(-0.5, 0.5, 3) * [1, 1, 0.3])[0]
        centre = np.array([0.03, 0, 0.5]) + rng.uniform(-1, 1, 3) * [0.03, 0.03, 0.05]
        pose = Transform(R, centre - R @ BOARD.object_points().mean(axis=0))
        left, right = (render_board(BOARD, K, camera, (320, 240)) for camera in (pose, right_T_left @ pose))
        pairs.append((left, right))
    return pairs
