"""A copy of a bag with the poses in it."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from rosbags.interfaces import Connection
from rosbags.rosbag2 import Reader, StoragePlugin, Writer, WriterError
from rosbags.typesys import Stores, TypesysError, get_typestore
from rosbags.typesys.store import Typestore

from stereo_pick.core.errors import SourceError
from stereo_pick.core.pipeline import Result
from stereo_pick.core.poses import ObjectPoses
from stereo_pick.sources.bag_reader import opened, raw_messages, typestore_of
from stereo_pick.sources.source import SourcePair

TOPIC = "/object_poses"
_TYPE = "geometry_msgs/msg/PoseArray"
_NS_PER_S = 1_000_000_000


def write_pose_bag(source: Path, output: Path, results: Iterable[tuple[SourcePair, Result]]) -> None:
    """Write `output` (.mcap): the messages of the bag `source` as they are, and a PoseArray for every pair.

    Raises SourceError where `output` exists or cannot be written, or `source` is no rosbag2 or has poses already.
    """
    if output.exists():
        raise SourceError(f"--output {output} exists already: remove it, or name another file")
    try:
        output.parent.mkdir(parents=True, exist_ok=True)
        with TemporaryDirectory(".writing", f".{output.name}.", output.parent, ignore_cleanup_errors=True) as made:
            folder = Path(made) / "bag"
            with Writer(folder, version=9, storage_plugin=StoragePlugin.MCAP) as writer:
                _copy(source, writer)
                _write_poses(writer, results)
            next(folder.glob("*.mcap")).replace(output)
    except OSError as error:
        raise SourceError(f"--output {output} cannot be written: {error.strerror}") from None
    except (WriterError, TypesysError) as error:
        raise SourceError(f"--output {output} cannot be written: {error}") from None


def _copy(source: Path, writer: Writer) -> None:
    with opened(source) as reader:
        if not isinstance(reader, Reader):
            raise SourceError(f"{source} is a ROS 1 bag: convert it with `rosbags-convert`, or choose a .jsonl output")
        if TOPIC in reader.topics:
            raise SourceError(f"{source} holds {TOPIC} already: give the recording without poses, or a .jsonl output")
        types = cache(lambda: typestore_of(source))
        copies = {
            connection.id: writer.add_connection(
                connection.topic,
                connection.msgtype,
                **_definition(connection, types),
                offered_qos_profiles=connection.ext.offered_qos_profiles,  # type: ignore[union-attr]
            )
            for connection in reader.connections
        }
        for connection, recorded_ns, raw in raw_messages(source, reader):
            writer.write(copies[connection.id], recorded_ns, raw)


def _definition(connection: Connection, types: Callable[[], Typestore]) -> dict[str, Any]:
    """The message's definition as it was recorded; older recordings lack it, or its hash."""
    if connection.msgdef.data and connection.digest:
        return {"msgdef": connection.msgdef.data, "rihs01": connection.digest}
    return {"typestore": types()}


def _write_poses(writer: Writer, results: Iterable[tuple[SourcePair, Result]]) -> None:
    types = get_typestore(Stores.ROS2_JAZZY)
    connection = writer.add_connection(TOPIC, _TYPE, typestore=types)
    for pair, result in results:
        message = _pose_array(types.types, result.poses, pair.left_frame_id)
        writer.write(connection, pair.recorded_ns, types.serialize_cdr(message, _TYPE))


def _pose_array(types: Any, poses: ObjectPoses, frame_id: str) -> Any:
    time, header, pose, point, quaternion = (
        types[name]
        for name in (
            "builtin_interfaces/msg/Time",
            "std_msgs/msg/Header",
            "geometry_msgs/msg/Pose",
            "geometry_msgs/msg/Point",
            "geometry_msgs/msg/Quaternion",
        )
    )
    stamp = time(sec=poses.stamp_ns // _NS_PER_S, nanosec=poses.stamp_ns % _NS_PER_S)
    rows = np.hstack([poses.xyz, poses.quaternions()]).tolist()
    return types[_TYPE](
        header=header(stamp=stamp, frame_id=poses.frame_id or frame_id or "left_camera_optical_frame"),
        poses=[pose(position=point(*row[:3]), orientation=quaternion(*row[3:])) for row in rows],
    )
