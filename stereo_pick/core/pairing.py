"""Pairing of left and right items by stamp, and the reason where nothing pairs."""

from __future__ import annotations

from bisect import insort
from dataclasses import dataclass
from typing import Generic, Literal, TypeVar

from stereo_pick.core.errors import ParameterError

T = TypeVar("T")
Side = Literal["left", "right"]

NOT_STAMPED = (
    "images have the stamp 0: the driver does not set header.stamp, and nothing else tells which left and right image "
    "belong together; let it set the time of exposure"
)
REPEATED = (
    "images repeat the stamp of the one before: nothing tells which left and right image belong together; let the "
    "driver set the time of exposure of each"
)
MOST_OFFSET_S = 1.0  # between the stamps of a pair: farther apart they are of different times
_MOST_AHEAD = 30  # images of one camera that wait for the other's: half a second of them, at 60 a second
_NS_PER_S = 1_000_000_000


@dataclass(frozen=True)
class Pair(Generic[T]):
    """A left and a right item whose stamps [ns] are equal or near."""

    left: T
    right: T
    left_stamp_ns: int
    right_stamp_ns: int

    @property
    def offset_ns(self) -> int:
        """Right stamp minus left stamp [ns]."""
        return self.right_stamp_ns - self.left_stamp_ns


@dataclass
class PairingCounts:
    """What a pairer saw so far. `dropped`: unpaired items, too old or too many to wait any longer.

    nearest_offset_ns: the smallest distance of a left and a right stamp, since the last pair, that do not pair.
    """

    left: int = 0
    right: int = 0
    pairs: int = 0
    dropped_left: int = 0
    dropped_right: int = 0
    nearest_offset_ns: int | None = None


@dataclass(frozen=True)
class _Item(Generic[T]):
    stamp_ns: int
    value: T


class StampOrder:
    """Whether the stamps of each side are those of one image each, and rise."""

    def __init__(self) -> None:
        self._last_ns: dict[Side, int] = {}
        self._newest_ns: dict[Side, list[int]] = {}  # two at most, rising

    def fault(self, side: Side, stamp_ns: int) -> str | None:
        """Why an image of this stamp, the next one of its side, belongs to no other; None where it may."""
        if stamp_ns == 0:
            return NOT_STAMPED
        return REPEATED if stamp_ns == self._last_ns.get(side) else None

    def starts_over(self, side: Side, stamp_ns: int) -> bool:
        """Whether time goes back with this image, as where a replay starts over: what came before pairs no more.

        An image of a time between those of the two newest has only been overtaken by one of them on its way.
        """
        newest_ns = self._newest_ns.get(side, [])
        is_back = bool(newest_ns) and stamp_ns < newest_ns[-1] and stamp_ns <= newest_ns[0]
        if is_back:
            self._newest_ns.clear()
            self._last_ns.clear()
        self._last_ns[side] = stamp_ns
        self._newest_ns[side] = sorted([*self._newest_ns.get(side, []), stamp_ns])[-2:]
        return is_back


class StampPairer(Generic[T]):
    """Pairs items of equal stamp, and otherwise the nearest ones at most `max_offset_ns` apart.

    Each side's stamps are taken to rise; then the pairs do not depend on how the sides interleave,
    as long as none runs ahead by more than `queue_length` items. An item whose stamp has no equal
    therefore waits for the next one of its own side, which might fit better, unless
    `min_period_ns`, the shortest time between two items of a side, rules that out. Not thread-safe.
    Raises ParameterError on a negative offset or period and on an empty queue.
    """

    def __init__(self, max_offset_ns: int, queue_length: int = _MOST_AHEAD, min_period_ns: int = 0) -> None:
        for name, value, low in (
            ("max_offset_ns", max_offset_ns, 0),
            ("queue_length", queue_length, 1),
            ("min_period_ns", min_period_ns, 0),
        ):
            if value < low:
                raise ParameterError(f"{name} = {value} must be at least {low}")
        self.counts = PairingCounts()
        self._max_offset_ns = max_offset_ns
        self._queue_length = queue_length
        self._min_period_ns = min_period_ns
        self._left: list[_Item[T]] = []
        self._right: list[_Item[T]] = []

    def add(self, side: Side, stamp_ns: int, item: T) -> list[Pair[T]]:
        """Take an item and return the pairs that it completes, oldest first."""
        queue = self._left if side == "left" else self._right
        insort(queue, _Item(stamp_ns, item), key=lambda waiting: waiting.stamp_ns)
        if side == "left":
            self.counts.left += 1
        else:
            self.counts.right += 1
        pairs = self._settle(ended=False)
        while len(queue) > self._queue_length:
            self._drop(queue)
        return pairs

    def flush(self) -> list[Pair[T]]:
        """Return the pairs that were still waiting for a better partner, and forget the rest: nothing more comes."""
        pairs = self._settle(ended=True)
        for queue in (self._left, self._right):
            while queue:
                self._drop(queue)
        return pairs

    def explain(self) -> str:
        """One sentence on what paired, or why nothing did."""
        counts = self.counts
        if counts.left == 0 and counts.right == 0:
            return "no images, neither left nor right: are the cameras running?"
        for some, other, n, others in (
            ("left", "right", counts.left, counts.right),
            ("right", "left", counts.right, counts.left),
        ):
            if others == 0:
                return f"{some} has {_images(n)}, {other} none: is the {other} camera running?"
        if counts.pairs == 0:
            return self.explain_offset()
        return (
            f"{counts.pairs} of {_images(counts.left)} left and {counts.right} right are paired, "
            f"{counts.dropped_left} left and {counts.dropped_right} right found no partner"
        )

    @property
    def is_apart(self) -> bool:
        """Whether no stamp since the last pair was near enough to one of the other side."""
        nearest_ns = self.counts.nearest_offset_ns
        return nearest_ns is not None and nearest_ns > self._max_offset_ns

    def explain_offset(self) -> str:
        """One sentence on how far apart the stamps are, and why that may be."""
        waiting_ns = abs(self._left[0].stamp_ns - self._right[0].stamp_ns) if self._left and self._right else 0
        offset_ns = self.counts.nearest_offset_ns or waiting_ns
        apart = f"nearest left and right stamps differ by {_duration(offset_ns)}"
        if offset_ns <= self._max_offset_ns:
            return f"{apart}: they pair as soon as the next image shows that there is no nearer one"
        remedy = "are the cameras synchronised?"
        if offset_ns >= _NS_PER_S:
            remedy = "do both cameras' hosts have the same time, and do both drivers set header.stamp?"
        return f"{apart}, more than max_stamp_offset_s = {self._max_offset_ns / _NS_PER_S:g}: {remedy}"

    def _settle(self, ended: bool) -> list[Pair[T]]:
        """Decide on the oldest items as long as nothing that is still to come could change it."""
        pairs = []
        while self._left and self._right:
            older, newer = sorted((self._left, self._right), key=lambda queue: queue[0].stamp_ns)
            gap_ns = newer[0].stamp_ns - older[0].stamp_ns
            outdone = len(older) > 1 and abs(older[1].stamp_ns - newer[0].stamp_ns) < gap_ns
            if outdone or gap_ns > self._max_offset_ns:
                self._note_gap(gap_ns)
                self._drop(older)
            elif ended or len(older) > 1 or 2 * gap_ns <= self._min_period_ns:
                pairs.append(self._pop_pair())
            else:
                break
        return pairs

    def _pop_pair(self) -> Pair[T]:
        left, right = self._left.pop(0), self._right.pop(0)
        self.counts.pairs += 1
        self.counts.nearest_offset_ns = None
        return Pair(left.value, right.value, left.stamp_ns, right.stamp_ns)

    def _drop(self, queue: list[_Item[T]]) -> None:
        del queue[0]
        if queue is self._left:
            self.counts.dropped_left += 1
        else:
            self.counts.dropped_right += 1

    def _note_gap(self, gap_ns: int) -> None:
        nearest_ns = self.counts.nearest_offset_ns
        self.counts.nearest_offset_ns = gap_ns if nearest_ns is None else min(nearest_ns, gap_ns)


def _duration(ns: int) -> str:
    return f"{ns / 1e6:.3g} ms" if ns < _NS_PER_S else f"{ns / _NS_PER_S:.1f} s"


def _images(count: int) -> str:
    return "1 image" if count == 1 else f"{count} images"
