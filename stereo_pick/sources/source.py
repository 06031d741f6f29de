"""What every source of stereo pairs is like, and the choice of the one that fits a path."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

from stereo_pick.core.camera import Camera
from stereo_pick.core.errors import SourceError
from stereo_pick.core.images import ImageBuffer

BAG_SUFFIXES = (".mcap", ".db3", ".bag")


@dataclass(frozen=True, eq=False)
class SourcePair:
    """A raw pair. stamp_ns: when the left image was taken; recorded_ns: when the pair was complete [ns].

    left_frame_id, right_frame_id: the frames that were recorded with the images; empty where none were.
    """

    left: ImageBuffer
    right: ImageBuffer
    stamp_ns: int
    recorded_ns: int
    left_frame_id: str = ""
    right_frame_id: str = ""


class StereoSource(Protocol):
    """Stereo pairs in the order of their stamps; iterating again starts over."""

    @property
    def count(self) -> int | None:
        """About how many pairs there are (for a progress bar); None where nobody knows."""

    @property
    def has_stamps(self) -> bool:
        """Whether the stamps say when the images were taken, and do not merely count from 0."""

    @property
    def cameras(self) -> tuple[Camera, Camera] | None:
        """Left and right calibration that came with the images; None where none did.

        Raises CalibrationError, naming where it stands, on one that no real camera has.
        """

    def __iter__(self) -> Iterator[SourcePair]:
        """Yield one pair after the other; raises SourceError or ImageError where no further one can be read."""


def open_source(
    path: Path,
    *,
    left_topic: str = "",
    right_topic: str = "",
    max_stamp_offset_s: float = 0.01,
    rate_hz: float = 10.0,
) -> StereoSource:
    """Open a bag (mcap, sqlite3, ROS 1) or a folder of image pairs, whichever `path` is.

    The topics (found by their names where not given) and the stamp offset concern bags, the rate folders.
    Raises SourceError where there are no stereo pairs, ParameterError on an offset or rate out of range.
    """
    # Here, not above: both import this module, and a folder should not wait for rosbags to load.
    if not path.exists():
        raise SourceError(f"{path}: no such bag or folder; check the path")
    if _is_bag(path):
        from stereo_pick.sources.bag import BagSource

        return BagSource.open(path, left_topic, right_topic, max_stamp_offset_s)
    if path.is_dir():
        from stereo_pick.sources.images import ImageFolder

        return ImageFolder.open(path, rate_hz)
    raise SourceError(f"{path} is no bag ({', '.join(BAG_SUFFIXES)}) and no folder of image pairs")


def _is_bag(path: Path) -> bool:
    if path.is_file():
        return path.suffix in BAG_SUFFIXES
    return (path / "metadata.yaml").exists() or any(file.suffix in BAG_SUFFIXES for file in path.iterdir())
