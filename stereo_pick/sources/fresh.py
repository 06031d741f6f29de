"""The pairs of a recording but those of a camera that hung, as a node that listens to them would take them."""

from __future__ import annotations

from collections.abc import Iterator

from stereo_pick.core.hanging import STILL, HangWatch, all_alike, hangs
from stereo_pick.core.pairing import Side
from stereo_pick.sources.source import SourcePair, StereoSource


class FreshPairs:
    """Yields the pairs of a source, once, without those in which one camera's image is the one before.

    read: how many pairs there were so far, refused ones among them.
    """

    def __init__(self, source: StereoSource) -> None:
        self.read = 0
        self._source = source
        self._refused: dict[Side, list[int]] = {}
        self._most_still = 0

    def __iter__(self) -> Iterator[SourcePair]:
        watch = HangWatch()
        for pair in self._source:
            self.read += 1
            side = watch.hanging(pair.left.data, pair.right.data)
            self._most_still = max(self._most_still, watch.still)
            if side is None:
                yield pair
            else:
                self._refused.setdefault(side, []).append(self.read)

    @property
    def warnings(self) -> list[str]:
        """What to say, once the source is read, of the pairs that were refused, and of pairs that are all the same."""
        refused = [
            f"{len(pairs)} of {self.read} pairs, the first of them number {pairs[0]}, are refused: "
            f"{hangs(self._source.names[side])}"
            for side, pairs in self._refused.items()
        ]
        still = [all_alike(f"{self._most_still} pairs in a row")] if self._most_still >= STILL else []
        return [*refused, *still]
