"""Rows of alike objects that go on beyond both views: shifted by one, each object fits as well."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import permutations

import numpy as np

from stereo_pick.core.arrays import Bools, Floats
from stereo_pick.core.matches.ambiguity import Pairs
from stereo_pick.core.matches.similarity import Similarity
from stereo_pick.core.objects import Blob
from stereo_pick.core.rectified_view import valid_region
from stereo_pick.core.rig import StereoRig

_NEAR = 0.25  # of its width, to which it is foreseen where an object is

Pair = tuple[int, int]
Exchange = tuple[Pair, Pair]
"""Two pairs; the left object of the second may take the partner of the first."""


@dataclass(frozen=True, eq=False)
class OpenRows:
    """sides: the objects of the left and the right view; cut: what the borders of the views cut."""

    sides: tuple[Sequence[Blob], Sequence[Blob]]
    rig: StereoRig
    cut: Sequence[Blob]
    similarity: Similarity

    def ambiguous_pairs(self, pairs: Pairs, cost: Floats, margin: float) -> set[Pair]:
        """The pairs of which each may be with the next one's partner instead, in a row that goes on: at one of its ends
        something is cut by a border, or left over.

        Then the object at one end of the row has no partner in the right view, and at the other end one of the right
        view has none in the left: at the depth that the others have then, these are outside of the views, or cut.
        cost, margin: as of `ambiguity.ambiguous_pairs`.
        """
        exchanges = [each for each in permutations(pairs, 2) if _fits(each, cost, margin)]
        more = [*self.cut, *self._left_over(pairs)] if exchanges else []
        found: set[Pair] = set()
        for is_nearer in (True, False):
            some = [each for each in exchanges if self._is_nearer(each) == is_nearer]
            starts = [each for each in some if self._starts(each, some)]
            ends = [each for each in some if self._ends(each, some)]
            found |= _between([each for each in starts if self._is_on_rows(each, more)], ends, some)
            found |= _between(starts, [each for each in ends if self._is_on_rows(each, more)], some)
        return found

    def _left_over(self, pairs: Pairs) -> list[Blob]:
        """What is in no pair."""
        taken = [set(which) for which in zip(*pairs)] or [set(), set()]
        return [blob for side, some in zip(self.sides, taken) for i, blob in enumerate(side) if i not in some]

    def _is_on_rows(self, exchange: Exchange, several: Sequence[Blob]) -> bool:
        """Whether any of several is on the row of two of its pairs."""
        of_row = [self._left(pair) for pair in exchange]
        return any(self.similarity.is_on_rows(each, blob) for each in several for blob in of_row)

    def _is_nearer(self, exchange: Exchange) -> bool:
        """Whether what takes another's partner is nearer then."""
        first, second = (_column_px(self._right(pair)) for pair in exchange)
        return first < second

    def _starts(self, exchange: Exchange, several: Sequence[Exchange]) -> bool:
        """Whether the left object of the first, which loses its partner, would be seen by the left camera alone, and so
        would those between the two, which keep their order."""
        alone = [exchange[0], *self._between(exchange, several)]
        by_px, seen = -self._disparity_px(exchange), valid_region(self.rig.right)
        return all(_leaves(self._left(pair), by_px, seen) for pair in alone)

    def _ends(self, exchange: Exchange, several: Sequence[Exchange]) -> bool:
        """Whether the right object of the second, which has lost its own, would be seen by the right camera alone, and
        so would those between the two."""
        alone = [exchange[1], *self._between(exchange, several)]
        by_px, seen = self._disparity_px(exchange), valid_region(self.rig.left)
        return all(_leaves(self._right(pair), by_px, seen) for pair in alone)

    def _between(self, exchange: Exchange, several: Sequence[Exchange]) -> list[Pair]:
        """The pairs of the same row between two of it."""
        first, second = exchange
        nearer, farther = sorted(_column_px(self._left(pair)) for pair in exchange)
        row = [other for one, other in several if one == first and other != second]
        return [pair for pair in row if nearer < _column_px(self._left(pair)) < farther]

    def _disparity_px(self, exchange: Exchange) -> float:
        first, second = exchange
        return _column_px(self._left(second)) - _column_px(self._right(first))

    def _left(self, pair: Pair) -> Blob:
        return self.sides[0][pair[0]]

    def _right(self, pair: Pair) -> Blob:
        return self.sides[1][pair[1]]


def _fits(exchange: Exchange, cost: Floats, margin: float) -> bool:
    """Whether what takes another's partner fits it about as well as its own."""
    (_, taken), (i, own) = exchange
    return bool(cost[i, taken] <= cost[i, own] + margin)


def _turned(exchange: Exchange) -> Exchange:
    first, second = exchange
    return second, first


def _column_px(blob: Blob) -> float:
    return float(blob.centroid_px[0])


def _between(starts: Sequence[Exchange], ends: Sequence[Exchange], several: Sequence[Exchange]) -> set[Pair]:
    """The pairs of the exchanges that follow one another from a start to an end."""
    ahead = _reached(starts, several)
    back = _reached([_turned(each) for each in ends], [_turned(each) for each in several])
    return {pair for each in ahead if _turned(each) in back for pair in each}


def _leaves(blob: Blob, by_px: float, seen: Bools) -> bool:
    """Whether an outline moved along its rows is not wholly and clearly in what a view shows (H, W)."""
    near_px = _NEAR * float(np.ptp(blob.contour_px[:, 0]))
    return any(not _is_within(blob.contour_px + (by_px + off_px, 0.0), seen) for off_px in (-near_px, near_px))


def _is_within(outline_px: Floats, seen: Bools) -> bool:
    columns, rows = np.round(outline_px).astype(int).T
    height, width = seen.shape
    if columns.min() < 0 or columns.max() >= width or rows.min() < 0 or rows.max() >= height:
        return False
    return bool(seen[rows, columns].all())


def _reached(first: Sequence[Exchange], exchanges: Sequence[Exchange]) -> set[Exchange]:
    """These, and all that follow one another from them on."""
    found, to_follow = set(first), list(first)
    while to_follow:
        _, last = to_follow.pop()
        new = [each for each in exchanges if each[0] == last and each not in found]
        found.update(new)
        to_follow += new
    return found
