"""Objects read from their outlines in both views: matched, located, taken apart where they touch, put on the table."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

from stereo_pick.core.correspondence.found_table import FoundTable, Shaded, TableSearch
from stereo_pick.core.edges.hypotheses import Images
from stereo_pick.core.matches.ambiguity import ambiguous_pairs, uncrossed
from stereo_pick.core.matches.assignment import assign
from stereo_pick.core.matches.left_over import Unread, left_over
from stereo_pick.core.matches.out_of_view import OpenRows
from stereo_pick.core.matches.similarity import Similarity
from stereo_pick.core.objects import Blob, Blobs
from stereo_pick.core.places.apart import Matching, taken_apart
from stereo_pick.core.places.located import locate
from stereo_pick.core.places.overlap import one_in_each_place
from stereo_pick.core.places.position import BlobPair, Located, Row
from stereo_pick.core.shapes.solid_fit import SolidFit
from stereo_pick.core.shapes.table import Table
from stereo_pick.core.tables.on_table import OnTable

_PLAIN_SIGMA_PX = 0.3  # of a centroid of whole pixels: shading moves its edges along whole arcs
_FADES = 0.15  # part of the outline, at least, of a ball's lit top that fades; a flat one's does not


@dataclass(frozen=True, eq=False)
class FirstLook:
    """What is found without a table: blobs, touching ones taken apart; kept, lost: those of which the place is known,
    and the others; doubtful: pairs that may not belong together."""

    blobs: Blobs
    kept: list[Row]
    lost: list[Row]
    doubtful: list[BlobPair]

    @property
    def unclear(self) -> list[Blob]:
        """The outlines of what is doubtful."""
        return [blob for each in self.doubtful for blob in each]

    def without(self, mistaken: Callable[[SolidFit], bool]) -> FirstLook:
        """The same, where solids that are mistaken are not found."""
        kept = [row for row in self.kept if row[1].fit is None or not mistaken(row[1].fit)]
        return replace(self, kept=kept)

    def left_over(self) -> tuple[list[Blob], list[Blob]]:
        """The outlines in both views of what may be found yet."""
        known = blobs_of(self.kept) + self.unclear
        left, right = (
            [blob for blob in _locatable(side) if blob not in known] for side in (self.blobs.left, self.blobs.right)
        )
        return left, right


@dataclass(frozen=True, eq=False)
class Reading:
    """kept: the objects found; unread: those refused; table: what they stand on, as far as that is known; for_good:
    those refused that edges alone would mistake, being shadows perhaps; aside: what is a shadow, or a high light, most
    likely, and is not spoken of, but found where it rises from the table."""

    kept: list[Row]
    unread: list[Unread]
    table: Table | None
    for_good: Sequence[Unread] = ()
    aside: Sequence[Unread] = ()


@dataclass(frozen=True, eq=False)
class Reader:
    """images: the views; similarity: by how much an object may differ between them; ambiguity_margin, flat_parts,
    last_look: as of `Feature`; is_table_given: whether what is paired wrongly would not be on it."""

    images: Images
    similarity: Similarity
    ambiguity_margin: float
    flat_parts: bool
    last_look: bool
    is_table_given: bool

    def look(self, blobs: Blobs) -> FirstLook:
        """Match the objects of both views, and find out where they are."""
        return self.look_at(blobs, *self._paired(blobs.left, blobs.right))

    def look_at(self, blobs: Blobs, matched: list[BlobPair], doubtful: list[BlobPair]) -> FirstLook:
        """Find out where objects are that are matched, and parts of those that are not."""
        kept, lost = _told_apart(self._located(matched, blobs.max_concavity))
        matching = Matching(
            self.similarity,
            lambda left, right: self._paired(left, right)[0],
            lambda pairs: self._located(pairs, blobs.max_concavity),
        )
        blobs, rows = taken_apart(blobs, blobs_of(kept) + [blob for each in doubtful for blob in each], matching)
        found, lost_parts = _told_apart(rows)
        kept, twice = one_in_each_place(kept + found)
        return FirstLook(blobs, kept, lost + lost_parts + twice, doubtful)

    def table(self, first: FirstLook, others: Sequence[Row], shaded: Shaded) -> FoundTable | None:
        """The table that the objects stand on, others with them."""
        if not _have_edges(first.blobs):
            return None
        flat = [(blobs, where.fit) for blobs, where in first.lost if where.fit is not None and where.reason == "flat"]
        faces = [(blobs, fit) for blobs, fit in flat if max(blob.fading for blob in blobs) < _FADES]
        bright = None if first.blobs.may_be_shaded else first.blobs
        search = TableSearch(self.images, self._lit_parts(first), faces, self.flat_parts, shaded, bright)
        return search.table([*first.kept, *others])

    def read(self, first: FirstLook, table: Table | None) -> Reading:
        """What is found with the table, and what is refused."""
        kept, lost = first.kept, first.lost
        if table is not None and _have_edges(first.blobs):
            kept, off = OnTable(self.images, table, self.flat_parts).seen(kept, self._lit_parts(first))
            lost = lost + off
        lost = [row for row in lost if not _any_of(row[0], blobs_of(kept)) and _all_of(row[0], first.blobs)]
        unread = [Unread(where.reason, *each, where.fit) for each, where in lost]
        unread += [Unread("ambiguous", *each) for each in first.doubtful]
        unread += left_over(first.blobs, blobs_of(kept + lost) + first.unclear, self.similarity)
        return Reading(kept, unread, table)

    def _lit_parts(self, first: FirstLook) -> list[BlobPair]:
        """What is left over and may be the lit parts of the same objects."""
        left, right = first.left_over()
        cost = self.similarity.of_pieces().costs(left, right)
        return [(left[i], right[j]) for i, j in assign(cost, unmatched_cost=1.0)]

    def _paired(self, left: Sequence[Blob], right: Sequence[Blob]) -> tuple[list[BlobPair], list[BlobPair]]:
        """The pairs of objects that belong together, and those that might as well be paired otherwise."""
        one, other = _locatable(left), _locatable(right)
        cost = self.similarity.costs(one, other)
        pairs = uncrossed(assign(cost, unmatched_cost=1.0), cost, one, other)
        cut = [blob for blob in (*left, *right) if blob.fault == "cut_by_border"]
        rows = OpenRows((one, other), self.images.rig, cut, self.similarity)
        open_ = set() if self.is_table_given else rows.ambiguous_pairs(pairs, cost, self.ambiguity_margin)
        doubtful = ambiguous_pairs(pairs, cost, self.ambiguity_margin, open_)
        sure = [(one[i], other[j]) for i, j in pairs if (i, j) not in doubtful]
        return sure, [(one[i], other[j]) for i, j in sorted(doubtful)]

    def _located(self, matched: list[BlobPair], max_concavity: float) -> list[Row]:
        if all(len(blob.sharpness) for each in matched for blob in each):
            return list(zip(matched, locate(self.images, matched, max_concavity, self.flat_parts)))
        return [((one, two), Located(one.centroid_px, two.centroid_px, _PLAIN_SIGMA_PX, None)) for one, two in matched]


def blobs_of(rows: Sequence[Row]) -> list[Blob]:
    """The outlines of objects."""
    return [blob for blobs, _ in rows for blob in blobs]


def _have_edges(blobs: Blobs) -> bool:
    return all(len(blob.sharpness) for blob in _locatable((*blobs.left, *blobs.right)))


def _told_apart(rows: Sequence[Row]) -> tuple[list[Row], list[Row]]:
    """Those whose place is known, and those that must be refused."""
    return [row for row in rows if not row[1].reason], [row for row in rows if row[1].reason]


def _any_of(pair: BlobPair, others: Sequence[Blob]) -> bool:
    return any(blob in others for blob in pair)


def _all_of(pair: BlobPair, blobs: Blobs) -> bool:
    return all(blob in (*blobs.left, *blobs.right) for blob in pair)


def _locatable(blobs: Sequence[Blob]) -> list[Blob]:
    """Those whose place can be known: touching or half-lit parts too, as far as a solid explains them."""
    return [blob for blob in blobs if blob.fault == "" or (blob.fault == "merged" and len(blob.sharpness))]
