"""The choice of the source that fits a path."""

from __future__ import annotations

from pathlib import Path

from stereo_pick.core.errors import SourceError
from stereo_pick.core.images import FULL_SCALE_16
from stereo_pick.sources.source import StereoSource

BAG_SUFFIXES = (".mcap", ".db3", ".bag")
_PACKED = (".mcap.zstd", ".db3.zstd")  # files of `ros2 bag record --compression-mode file`


def open_source(
    path: Path,
    *,
    left_topic: str = "",
    right_topic: str = "",
    max_stamp_offset_s: float = 0.01,
    rate_hz: float = 10.0,
    uses_camera_info: bool = True,
    full_scale_16: int = FULL_SCALE_16,
) -> StereoSource:
    """Open a bag (mcap, sqlite3, ROS 1) or a folder of image pairs, whichever `path` is.

    The topics (found by their names where not given), the stamp offset and whether the calibration is the recorded one
    (so that it must not change midway) concern bags, the rate folders. full_scale_16: the value of a 16-bit image that
    is white.
    Raises SourceError where there are no stereo pairs, or topics are named of a folder, ParameterError on an offset or
    rate out of range.
    """
    if not path.exists():
        raise SourceError(f"{path}: no such bag or folder; check the path")
    if _is_bag(path):
        try:  # here, because a folder should not wait for rosbags to load
            from stereo_pick.sources.bag import BagSource
        except ModuleNotFoundError as error:
            raise SourceError(f"{path}: bags need rosbags ({error}): pip install rosbags") from None
        return BagSource.open(path, left_topic, right_topic, max_stamp_offset_s, uses_camera_info, full_scale_16)
    packed = _packed_file(path)
    if packed is not None:
        raise SourceError(
            f"{packed} is a file of a compressed bag: give the bag's folder, with its metadata.yaml, or unpack it "
            f"(`zstd -d {packed.name} -o {packed.stem}`)"
        )
    if path.is_dir():
        if left_topic or right_topic:
            raise SourceError(
                f"{path} is a folder of images, which has no topics: leave out left_topic and right_topic"
            )
        from stereo_pick.sources.images import ImageFolder

        return ImageFolder.open(path, rate_hz, full_scale_16)
    folder = "; give the folder that it is in" if path.name == "metadata.yaml" else ""
    raise SourceError(f"{path} is no bag ({', '.join(BAG_SUFFIXES)}) and no folder of image pairs{folder}")


def _is_bag(path: Path) -> bool:
    if not path.is_dir():
        return path.is_file() and path.suffix in BAG_SUFFIXES
    return (path / "metadata.yaml").exists() or any(file.suffix in BAG_SUFFIXES for file in path.iterdir())


def _packed_file(path: Path) -> Path | None:
    """The file of a compressed bag that `path` is, or the first that it holds."""
    files = sorted(path.iterdir()) if path.is_dir() else [path]
    return next((file for file in files if file.name.endswith(_PACKED)), None)
