"""Calibration pairs out of a recording in which a board is moved about."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

from stereo_pick.cli.progress import progress
from stereo_pick.core.arrays import Image
from stereo_pick.core.calibration.any_board import Board
from stereo_pick.core.calibration.detection import BoardImages
from stereo_pick.core.calibration.detectors import board_view, finders, may_show
from stereo_pick.core.calibration.selection import Candidate, choose, sharpness
from stereo_pick.core.calibration.views import BoardView
from stereo_pick.core.errors import CalibrationError
from stereo_pick.core.frames import grey
from stereo_pick.core.images import ImageBuffer, pixels
from stereo_pick.sources.opening import open_source
from stereo_pick.sources.source import SourcePair, StereoSource

_MIN_INTERVAL_NS = 100_000_000  # views closer in time are alike


@dataclass(frozen=True)
class _Timed:
    """A recording's pair: its place among all, and its time [s] since the first."""

    index: int
    time_s: float
    pair: SourcePair

    def images(self) -> BoardImages:
        """The pair decoded, in grey, and named by its time."""
        names = [f"{side} at {self.time_s:.2f} s" for side in ("left", "right")]
        left, right = _grey(self.pair.left, names[0]), _grey(self.pair.right, names[1])
        return BoardImages(f"pair at {self.time_s:.2f} s", names[0], names[1], left, right)


@dataclass(frozen=True)
class RecordedPairs:
    """The pairs of a recording that are worth calibrating from: made by `choose_pairs`, read anew at each iteration.

    chosen: their places among all pairs; looked_at, shown: how many pairs were looked at, and showed the board.
    """

    source: StereoSource
    chosen: frozenset[int]
    looked_at: int
    shown: int

    @property
    def summary(self) -> str:
        """For people: what was taken of what there was."""
        return f"{len(self.chosen)} taken, the board in {self.shown} of {self.looked_at} that were looked at"

    def __iter__(self) -> Iterator[BoardImages]:
        """Yield the chosen pairs; raises SourceError or ImageError where one cannot be read."""
        chosen = (each for each in _timed(self.source) if each.index in self.chosen)
        for each in progress(chosen, len(self.chosen), "views"):
            yield each.images()


def choose_pairs(path: Path, board: Board, left_topic: str = "", right_topic: str = "") -> RecordedPairs:
    """Look through a bag (or folder of pairs) and choose the sharp views that are unlike each other.

    The recording is read twice, as a stream: what is kept are the corners. Raises SourceError and ImageError as
    its source does, CalibrationError where no pair shows the board.
    """
    source = open_source(path, left_topic=left_topic, right_topic=right_topic)
    candidates, looked_at, width_px = list[Candidate](), 0, 0
    for each in _spaced(progress(_timed(source), source.count, "pairs")):
        images = each.images()
        looked_at, width_px = looked_at + 1, images.size_px[0]
        candidate = _candidate(each.index, images, board)
        if candidate is not None:
            candidates.append(candidate)
    if not candidates:
        raise CalibrationError(
            f"{path}: no {board.title} found in both images of any of {looked_at} pairs: {board.advice}"
        )
    chosen = frozenset(candidate.index for candidate in choose(candidates, board, width_px))
    return RecordedPairs(source, chosen, looked_at, len(candidates))


def _candidate(index: int, pair: BoardImages, board: Board) -> Candidate | None:
    """The pair as the first detector sees it that finds the board in both images."""
    if not (may_show(pair.left, board) and may_show(pair.right, board)):
        return None
    for find in finders(board).values():
        left = find(pair.left)
        right = None if left is None else find(pair.right)
        if left is None or right is None:
            continue
        view = board_view(pair.name, left, right, board)
        if isinstance(view, BoardView):
            worse = min(sharpness(pair.left, view.left_px), sharpness(pair.right, view.right_px))
            return Candidate(index, view, worse)
    return None


def _spaced(pairs: Iterable[_Timed]) -> Iterator[_Timed]:
    """Leave out pairs less than 0.1 s after the last."""
    last: _Timed | None = None
    for each in pairs:
        if last is None or abs(each.pair.stamp_ns - last.pair.stamp_ns) >= _MIN_INTERVAL_NS:
            last = each
            yield each


def _timed(source: StereoSource) -> Iterator[_Timed]:
    start_ns: int | None = None
    for index, pair in enumerate(source):
        start_ns = pair.stamp_ns if start_ns is None else start_ns
        yield _Timed(index, (pair.stamp_ns - start_ns) / 1e9, pair)


def _grey(buffer: ImageBuffer, name: str) -> Image:
    return grey(pixels(buffer, what=name))
