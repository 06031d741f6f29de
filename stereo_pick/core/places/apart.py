"""Touching parts: taken apart in each view, and counted where the parts are found in both.

Each view alone is cut where its parts are convex. Where not all parts of that are found, both views are cut in two
together, or one of them as the other shows two objects: what belongs together has the same rows. Where the views show
different pieces of one of the two, the other one is looked for all the same.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, replace

from stereo_pick.core.matches.similarity import Similarity
from stereo_pick.core.objects import Blob, Blobs
from stereo_pick.core.objects.splitting import split
from stereo_pick.core.places.cut_together import Way, is_told, ways_to_cut
from stereo_pick.core.places.located import TOP, is_flat
from stereo_pick.core.places.overlap import are_one, one_in_each_place
from stereo_pick.core.places.position import BlobPair, Located, Row

_ROUNDS = 3  # a part may still be several
_TRIED = 4  # ways to cut the same objects ...
_TRIED_OF_EACH = 8  # ... and any one of them ...
_TRIED_IN_ALL = 16  # ... and all: planks and prints fall to dozens of pieces, and hundreds of ways


@dataclass(frozen=True)
class Matching:
    """How objects find their partners: similarity; paired: those of the left and of the right view that belong
    together; located: where each pair is."""

    similarity: Similarity
    paired: Callable[[Sequence[Blob], Sequence[Blob]], list[BlobPair]]
    located: Callable[[list[BlobPair]], list[Row]]

    def bodies(self, pairs: list[BlobPair]) -> list[Row]:
        """Where each pair of parts is."""
        return [_unless_a_face(row) for row in self.located(pairs)]


def taken_apart(blobs: Blobs, dealt_with: Collection[Blob], matching: Matching) -> tuple[Blobs, list[Row]]:
    """The objects with touching ones taken apart, as far as at least one part is found, and those parts.

    dealt_with: the objects that need no taking apart.
    """
    rows: dict[BlobPair, Located] = {}
    for _ in range(_ROUNDS):
        before = {*blobs.left, *blobs.right}
        blobs, more = _once(blobs, dealt_with, matching)
        rows |= more
        if not more:
            break
        dealt_with = before | {blob for each, where in rows.items() if not where.reason for blob in each}
    now = {*blobs.left, *blobs.right}
    return blobs, [(each, where) for each, where in rows.items() if now.issuperset(each)]


def _once(blobs: Blobs, dealt_with: Collection[Blob], matching: Matching) -> tuple[Blobs, dict[BlobPair, Located]]:
    sides = [[blob for blob in side if blob not in dealt_with] for side in (blobs.left, blobs.right)]
    parts = {blob: _parts(blob, blobs.max_concavity) for side in sides for blob in side}
    rows = _each_alone(sides, parts, matching)
    unclear = _unclear(parts, rows)
    doubtful = {part for blob in unclear for part in parts[blob]}
    rows = [_unless_shapeless(row) if doubtful.intersection(row[0]) else row for row in rows]
    cut = _together([[blob for blob in side if blob in unclear] for side in sides], matching)
    for each in cut:
        parts |= _told(each)
    rows = [row for row in rows if all(any(blob in its for its in parts.values()) for blob in row[0])]
    return _opened(blobs, parts, rows + [row for _, both in cut for row in both])


def _opened(blobs: Blobs, parts: dict[Blob, list[Blob]], rows: list[Row]) -> tuple[Blobs, dict[BlobPair, Located]]:
    """The objects, those of which parts are found in parts, and what became of these."""
    before = dict(rows)
    rows, there = one_in_each_place(rows)
    # a half-lit part has a notch, too, and either half may tell the whole of it
    again = [each for each, _ in there if any(_are_one(before[each], where) for _, where in rows)]
    repeated = {blob for each in again for blob in each}
    rows += [row for row in there if row[0] not in again]
    found = {blob for each, where in rows if not where.reason for blob in each}
    opened = {
        whole: [part for part in its if part not in repeated]
        for whole, its in parts.items()
        if any(part in found for part in its)
    }
    kept = {part for its in opened.values() for part in its}
    left, right = (
        tuple(part for blob in side for part in opened.get(blob, [blob])) for side in (blobs.left, blobs.right)
    )
    return replace(blobs, left=left, right=right), {each: where for each, where in rows if kept.intersection(each)}


def _are_one(one: Located, other: Located) -> bool:
    return one.fit is not None and other.fit is not None and are_one(one.fit, other.fit)


def _each_alone(sides: Sequence[Sequence[Blob]], parts: dict[Blob, list[Blob]], matching: Matching) -> list[Row]:
    """The parts that fit each other, where any object is of several."""
    if all(len(its) <= 1 for its in parts.values()):
        return []
    left, right = ([part for blob in side for part in parts[blob]] for side in sides)
    return matching.bodies(matching.paired(left, right))


def _unclear(parts: dict[Blob, list[Blob]], rows: list[Row]) -> set[Blob]:
    """The objects without fault of which not all parts are found, and those that share a part with one of them."""
    whole = {part: blob for blob, its in parts.items() for part in its}
    found = [each for each, where in rows if not where.reason]
    known = {blob for each in found for blob in each}
    unclear = {blob for blob, its in parts.items() if its and not all(part in known for part in its)}
    grows = True
    while grows:
        more = {whole[blob] for each in found for blob in each if any(whole[other] in unclear for other in each)}
        grows = not more <= unclear
        unclear |= more
    return unclear


_Cut = tuple[Way, list[Row]]
"""A way to cut objects, and the two parts."""


def _together(sides: Sequence[Sequence[Blob]], matching: Matching) -> list[_Cut]:
    """The likeliest ways to cut these objects by which a part is found: such that both parts look alike in both views
    and are found, or else those of all by which most is found."""
    alike = _tried(sides, matching, alike=True)
    found = _once_each([cut for cut in alike if _open(cut) == 0])
    dealt_with = {blob for way, _ in found for blob in way.whole}
    rest = [[blob for blob in side if blob not in dealt_with] for side in sides]
    several = [cut for cut in alike if dealt_with.isdisjoint(cut[0].whole)] + _tried(rest, matching, alike=False)
    return found + _once_each([cut for cut in sorted(several, key=_open) if _open(cut) < len(cut[1])])


def _tried(sides: Sequence[Sequence[Blob]], matching: Matching, *, alike: bool) -> list[_Cut]:
    """A few ways to cut each of these objects, the likeliest first."""
    tries: Counter[frozenset[Blob]] = Counter()
    tries_of_each: Counter[Blob] = Counter()
    tried: list[Way] = []
    for way in ways_to_cut(sides[0], sides[1], matching.similarity, alike):
        if len(tried) == _TRIED_IN_ALL:
            break
        objects = way.whole if alike else way.cut  # any may be the other part: they would be tried with each
        if tries[objects] < _TRIED and all(tries_of_each[blob] < _TRIED_OF_EACH for blob in objects):
            tries[objects] += 1
            tries_of_each.update(objects)
            tried.append(way)
    pairs = [pair for way in tried for pair in way.pairs]
    told = [pair for pair in pairs if alike or all(is_told(part) for part in pair)]
    rows = dict(_unless_shapeless(row) for row in matching.bodies(told))
    return [(way, [(pair, rows[pair]) if pair in rows else _merged(pair) for pair in way.pairs]) for way in tried]


def _open(cut: _Cut) -> int:
    """How many of the parts are not found."""
    return sum(bool(where.reason) for _, where in cut[1])


def _once_each(cuts: Sequence[_Cut]) -> list[_Cut]:
    """The first of those that tell a part of the same object."""
    taken: set[Blob] = set()
    found = []
    for cut in cuts:
        told = _told(cut)
        if taken.isdisjoint(told):
            found.append(cut)
            taken |= told.keys()
    return found


def _told(cut: _Cut) -> dict[Blob, list[Blob]]:
    """The objects of which a part is found, and their parts."""
    way, both = cut
    found = {part for pair, where in both if not where.reason for part in pair}
    return {whole: its for whole, its in way.wholes if not found.isdisjoint(its)}


def _parts(blob: Blob, max_concavity: float) -> list[Blob]:
    if blob.fault == "merged":
        return split(replace(blob, fault=""), max_concavity)
    return [] if blob.fault else [blob]


def _unless_a_face(row: Row) -> Row:
    """One face of a half-lit part would pass for a flat part: what was cut out must be a body."""
    fit = row[1].fit
    return _merged(row[0]) if fit is not None and is_flat(fit, TOP) else row


def _unless_shapeless(row: Row) -> Row:
    """A face would pass for a part of unknown shape as well, unless all other parts are found beside it."""
    return row if row[1].reason or row[1].fit is not None else _merged(row[0])


def _merged(pair: BlobPair) -> Row:
    return pair, Located(pair[0].centroid_px, pair[1].centroid_px, 1.0, None, "merged")
