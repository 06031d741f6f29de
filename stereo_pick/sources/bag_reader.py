"""Opening and reading of bags, damaged ones included."""

from __future__ import annotations

import errno
import struct
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from tempfile import gettempdir
from typing import Any, TypeAlias, TypeVar

import apsw
from rosbags.highlevel import AnyReader, AnyReaderError
from rosbags.interfaces import Connection
from rosbags.rosbag1 import Reader as Ros1Reader
from rosbags.rosbag1 import ReaderError as Ros1ReaderError
from rosbags.rosbag2 import Reader as Ros2Reader
from rosbags.rosbag2 import ReaderError as Ros2ReaderError
from rosbags.serde import SerdeError
from rosbags.typesys import Stores, TypesysError, get_typestore
from rosbags.typesys.store import Typestore

from stereo_pick.core.errors import SourceError
from stereo_pick.sources.opening import BAG_SUFFIXES

if sys.version_info >= (3, 14):
    from compression.zstd import ZstdError
else:
    from backports.zstd import ZstdError

T = TypeVar("T")
BagReader: TypeAlias = "Ros1Reader | Ros2Reader"

_REFUSED = (AnyReaderError, Ros1ReaderError, Ros2ReaderError, SerdeError, TypesysError, apsw.Error)
# rosbags reads lengths, offsets and names unchecked: these are what it meets where a byte is wrong or missing.
_DAMAGED = (
    *_REFUSED,
    ZstdError,
    EOFError,
    MemoryError,
    OSError,
    OverflowError,
    RuntimeError,
    TypeError,
    ValueError,
    AssertionError,
    LookupError,
    struct.error,
)
_REPAIR = {
    ".mcap": "repair it with `mcap recover`",
    ".db3": "repair it with `sqlite3 broken.db3 .recover | sqlite3 repaired.db3`",
    ".bag": "repair it with `rosbag reindex`",
}


@dataclass(frozen=True, eq=False)
class Recorded:
    """A message as rosbags decodes it, with a header, and when it was written into the bag [ns]."""

    topic: str
    type: str
    message: Any
    recorded_ns: int

    @property
    def stamp_ns(self) -> int:
        """The stamp of the message's header [ns]."""
        stamp = self.message.header.stamp
        return int(stamp.sec) * 1_000_000_000 + int(stamp.nanosec)


@contextmanager
def opened(path: Path) -> Iterator[BagReader]:
    """Open a rosbag2 folder, a bare .mcap or .db3 file or a ROS 1 .bag file.

    Raises SourceError where there is none, or where it is damaged or of an unknown format.
    """
    storage = _storage(path)
    try:
        reader = _reader(storage)
        reader.open()
    except _DAMAGED as error:
        raise _unreadable(path, "cannot be read", error, _metadata_remedy(path)) from None
    try:
        yield reader
    finally:
        reader.close()


def typestore_of(path: Path) -> Typestore:
    """The types of all messages of a bag, by its own definitions; SourceError where these cannot be read."""
    try:
        with AnyReader([_storage(path)], default_typestore=_types(is_ros2=True)) as reader:
            return reader.typestore
    except _DAMAGED as error:
        raise _unreadable(path, "holds a message definition that cannot be read", error) from None


def messages(path: Path, reader: BagReader, *topics: str) -> Iterator[Recorded]:
    """Yield the messages of the topics as a stream, up to the first damage, which raises SourceError."""
    return _up_to_damage(path, _messages(reader, topics))


def raw_messages(path: Path, reader: BagReader) -> Iterator[tuple[Connection, int, bytes]]:
    """Yield every message with its topic and time [ns] as it was recorded, up to the first damage: SourceError."""
    return _up_to_damage(path, reader.messages())


def _up_to_damage(path: Path, recorded: Iterator[T]) -> Iterator[T]:
    count = 0
    while True:
        try:
            message = next(recorded)
        except StopIteration:
            return
        except _DAMAGED as error:
            raise _unreadable(path, f"cannot be read beyond its first {count} messages", error) from None
        count += 1
        yield message


def _messages(reader: BagReader, topics: tuple[str, ...]) -> Iterator[Recorded]:
    connections = [connection for connection in reader.connections if connection.topic in topics]
    if not connections:
        return
    # The definitions in the bag may be damaged or missing, and those of sensor_msgs never changed.
    is_ros2 = isinstance(reader, Ros2Reader)
    types = _types(is_ros2)
    deserialize = types.deserialize_cdr if is_ros2 else types.deserialize_ros1
    for connection, recorded_ns, raw in reader.messages(connections):
        yield Recorded(connection.topic, connection.msgtype, deserialize(raw, connection.msgtype), recorded_ns)


@lru_cache
def _types(is_ros2: bool) -> Typestore:
    return get_typestore(Stores.ROS2_JAZZY if is_ros2 else Stores.ROS1_NOETIC)


def _reader(storage: Path) -> BagReader:
    # No AnyReader: it takes a folder named x.bag for ROS 1, and fails where it cannot read the definition of any topic.
    return Ros1Reader(storage) if storage.is_file() and storage.suffix == ".bag" else Ros2Reader(storage)


def _storage(path: Path) -> Path:
    """What rosbags is to open: a recording that was killed leaves its file without the folder's metadata.yaml."""
    if not path.exists():
        raise SourceError(f"{path}: no such bag; check the path")
    if path.is_file() or (path / "metadata.yaml").exists():
        return path
    files = _bag_files(path)
    if len(files) != 1:
        raise SourceError(
            f"{path} holds {len(files)} bag files and no metadata.yaml: "
            f"make it with `ros2 bag reindex {path}`, or give one of the files"
        )
    return files[0]


def _bag_files(folder: Path) -> list[Path]:
    return sorted(file for file in folder.iterdir() if file.suffix in BAG_SUFFIXES)


def _metadata_remedy(path: Path) -> str:
    """What to do where all files of a folder can be opened, so that its metadata.yaml is to blame; else nothing."""
    try:
        files = _bag_files(path) if path.is_dir() else []
        for file in files:
            with _reader(file):
                pass
    except _DAMAGED:
        return ""
    return f"make its metadata.yaml anew with `ros2 bag reindex {path}`, or give one of its files" if files else ""


def _unreadable(path: Path, fault: str, error: BaseException, remedy: str = "") -> SourceError:
    text = " ".join(str(error).split()).rstrip(".")
    reason = text if isinstance(error, _REFUSED) else f"{type(error).__name__}: {text}"
    if isinstance(error, PermissionError):
        return SourceError(f"{path} {fault} ({error.strerror}): change its permissions")
    if isinstance(error, OSError) and error.errno == errno.ENOSPC:
        remedy = f"it is compressed, and unpacked in {gettempdir()}: make room there, or name another folder by TMPDIR"
    if remedy:
        return SourceError(f"{path} {fault} ({reason}): {remedy}")
    suffixes = [file.suffix for file in _bag_files(path)] if path.is_dir() else [path.suffix]
    repair = _REPAIR.get(suffixes[0] if suffixes else "", "copy it again")
    return SourceError(f"{path} {fault} ({reason}): if it is cut short or damaged, {repair}, or record it again")
