"""Calibration pairs out of a recording in which a board is moved about."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

from stereo_pick.cli.progress import progress
from stereo_pick.cli.warning import warn
from stereo_pick.core.calibration.any_board import Board
from stereo_pick.core.calibration.collecting import Collector, Pace, timed_pair
from stereo_pick.core.calibration.detection import BoardImages
from stereo_pick.core.errors import CalibrationError
from stereo_pick.core.frames import grey
from stereo_pick.core.images import FULL_SCALE_16
from stereo_pick.sources.fresh import FreshPairs
from stereo_pick.sources.opening import open_source
from stereo_pick.sources.source import SourcePair


@dataclass(frozen=True, eq=False)
class RecordedPairs:
    """The pairs of a recording that are worth calibrating from, and for people how they were chosen."""

    images: tuple[BoardImages, ...]
    summary: str


def choose_pairs(
    path: Path, board: Board, left_topic: str = "", right_topic: str = "", full_scale_16: int = FULL_SCALE_16
) -> RecordedPairs:
    """Look through a bag (or folder of pairs) and choose the sharp views that are unlike each other.

    The recording is read as a stream: what is kept are the images of the chosen views. Raises SourceError and
    ImageError as its source does, CalibrationError where no pair shows the board or the images differ in size.
    """
    source = open_source(
        path, left_topic=left_topic, right_topic=right_topic, uses_camera_info=False, full_scale_16=full_scale_16
    )
    collector, pairs = Collector(board), FreshPairs(source)
    for pair in progress(timed_pairs(pairs), source.count, "pairs"):
        collector.look(pair)
    warn(*pairs.warnings)
    try:
        images = collector.images()
    except CalibrationError as error:
        raise CalibrationError(f"{path}: {error}") from None
    summary = f"{len(images)} taken, the board in {collector.shown} of {collector.looked_at} that were looked at"
    return RecordedPairs(images, summary)


def timed_pairs(pairs: Iterable[SourcePair]) -> Iterator[BoardImages]:
    """The pairs that are worth a look, in grey and named by their time since the first."""
    pace, start_ns = Pace(), None
    for pair in pairs:
        start_ns = pair.stamp_ns if start_ns is None else start_ns
        if pace.takes(pair.stamp_ns):
            left, right = (grey(image) for image in pair.images())
            yield timed_pair((pair.stamp_ns - start_ns) / 1e9, left, right)
