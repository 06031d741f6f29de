"""A last look at what would be refused: the table is known by now, and the other objects on it.

What the outlines hint at is tried first, and then what most edges around them agree on. A solid found so late must
be hardly anything else: exactly on its edges, its creases shown, where no other object is. Half a silhouette will do
for that, as of a ball lit from one side, where its edges alone put it on the table, of which they know nothing.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from stereo_pick.core.arrays import Floats
from stereo_pick.core.doubts.second_thoughts import CREASED
from stereo_pick.core.edges.adjusted import MOST_SHOWN, Adjusted
from stereo_pick.core.edges.adjustment import adjusted
from stereo_pick.core.edges.consensus import solids_around
from stereo_pick.core.edges.ending import ended
from stereo_pick.core.edges.hypotheses import Images
from stereo_pick.core.edges.standing import agree, nearly, no_surer_than_rivals, standing_candidates
from stereo_pick.core.edges.supported import CHANCE, Supported
from stereo_pick.core.found_late.carried import as_predicted, carried
from stereo_pick.core.found_late.evident import Evident
from stereo_pick.core.found_late.patterned import patterned
from stereo_pick.core.found_late.pieces import Found, ends_above, shorter
from stereo_pick.core.found_late.risen import Risen
from stereo_pick.core.matches.left_over import Unread
from stereo_pick.core.objects import Blob
from stereo_pick.core.places.clear_of import clear_of
from stereo_pick.core.places.located import TOP, convex_outlines, is_flat
from stereo_pick.core.places.overlap import clash, goes_on_as, is_where, reach_into_each_other
from stereo_pick.core.places.position import BlobPair, Located, Row, by_supported
from stereo_pick.core.shapes.common_table import stands_on
from stereo_pick.core.shapes.kinds import KINDS, Round
from stereo_pick.core.shapes.solid_fit import SolidFit
from stereo_pick.core.shapes.solids import Solids
from stereo_pick.core.shapes.table import Table

# Of which an object may be found yet
_REASONS = ("half_lit", "merged", "off_table", "other_shape", "flat", "beside_bright")
_REASONS_ALONE = ("left_only", "right_only", "merged")  # ... of which one view shows an outline
MOST = 12  # objects
_REACH = 1.1  # lengths of the outlines from their middles, where only a part of it may be lit
_LOOKED_AT = 8  # solids for each object

Seen = tuple[Row, Adjusted]


@dataclass(frozen=True, eq=False)
class LastLook:
    """images: the views, behind what is known; table: what the objects stand on; before: solids that may hide
    others; besides: objects that stay what they are; may_be_astray: as of `Evident`."""

    images: Images
    table: Table
    before: Sequence[SolidFit]
    besides: Sequence[Located]
    may_be_astray: bool = False

    def without(self, where: Located) -> LastLook:
        """The same, where that object need not stay what it is."""
        return replace(self, besides=[each for each in self.besides if each is not where])

    def at(self, blobs: BlobPair, others: Sequence[SolidFit], shown: float = 0.0) -> Seen | None:
        """An object as the solid on the table that the edges show clearly where none of the others is; None where there
        is none, or where it is open which it is. shown: of its silhouette, as what it was taken for."""
        return self._among(self._hinted(blobs) + self.around(blobs), blobs, others, shown)

    def at_risen(self, risen: Risen, others: Sequence[SolidFit]) -> Seen | None:
        """The same of what rises from the table, by its surface; if that shows none, by its edges alone."""
        found = self._among(risen.solids(self.images.rig, self.table), risen.blobs, others, 0.0)
        return found or self._among(self.around(risen.blobs), risen.blobs, others, 0.0)

    def _among(
        self, candidates: Sequence[Solids], blobs: BlobPair, others: Sequence[SolidFit], shown: float
    ) -> Seen | None:
        """The same of these candidates."""
        free = self._with_ended(self.free_ones(nearly(self.images, candidates, self.table), others), others)
        clear = self._clear_ones(blobs, free, shown) or self._clear_by_pattern(blobs, candidates, others, free, shown)
        return self._best_of(blobs, others, free, clear, shown)

    def instead(self, blobs: BlobPair, others: Sequence[SolidFit], found: Adjusted) -> tuple[Seen | None, Floats]:
        """What shows clearly more of itself than what an object was found to be, if anything does; and how far (3,) [m]
        from that the farthest of those is that show as much, as it may be any of them."""
        candidates = self._hinted(blobs) + self.around(blobs)
        free = self.free_ones(nearly(self.images, candidates, self.table), others)
        clear = self._clear_ones(blobs, free, found.shown)
        another = self._best_of(blobs, others, free, clear, found.shown)
        if another is not None and another[1].is_clear and another[1].shown > found.shown + CHANCE:
            return another, np.zeros(3)
        as_much = [there.fit for _, there in free if _is_as_likely(there, found) and not agree(there.fit, found.fit)]
        offs_m = [fit.centre_m - found.fit.centre_m for fit in as_much]
        return None, max(offs_m, key=lambda off: float(off @ off), default=np.zeros(3))

    def _clear_ones(self, blobs: BlobPair, free: Sequence[Found], shown: float) -> list[Found]:
        """Those of these that are hardly anything else."""
        return [
            one
            for one in free
            if self._evident.is_clear(blobs, *one, _most_shown([each for each in free if each is not one], shown))
        ]

    def _clear_by_pattern(
        self,
        blobs: BlobPair,
        candidates: Sequence[Solids],
        others: Sequence[SolidFit],
        free: Sequence[Found],
        shown: float,
    ) -> list[Found]:
        """The same of candidates of which the pattern is seen, but edges are off by more than those of plain ones."""
        locked = self.images.all_locked(candidates, self.table)
        found = patterned(self.images, [each for each in locked if not each.raises_doubt], self.before)
        several = self.free_ones(found, others)
        return [one for one in several if self._evident.shows_its_surface(blobs, one[1], _most_shown(free, shown))]

    def _best_of(
        self, blobs: BlobPair, others: Sequence[SolidFit], free: Sequence[Found], clear: Sequence[Found], shown: float
    ) -> Seen | None:
        """The best of those that are clear, if it is not open which it is."""
        if not clear:
            return None
        clearest, *rest = [one for one in clear if one[1].shows_creases] or clear
        first, there = shorter(self.images, self.table, self.before, clearest) or clearest
        if there is not clearest[1] and there.shown <= MOST_SHOWN:
            return None
        rivals = [each for each, _ in rest]
        longer = self.images.longer(first.fit.solid, self.table)
        if longer is not None and longer.believable and longer.support >= first.support - CHANCE:
            beyond = self._free(longer, others) if longer.is_exact else None
            if (
                beyond is not None
                and beyond.shown >= there.shown
                and self._evident.is_clear(blobs, longer, beyond, _most_shown(free, shown))
            ):
                first, there = longer, beyond
            else:
                rivals.append(longer)
        best = no_surer_than_rivals(first, rivals)
        if best is None or ends_above(self.images, self.table, self.before, there):
            return None
        return (blobs, by_supported(self.images.rig, best)), there

    def at_refused(self, unread: Unread, others: Sequence[SolidFit]) -> Seen | None:
        """The same of what was refused, if need be by the outline of one view, and where the table has it in the
        other."""
        if unread.left and unread.right:
            return self.at((unread.left, unread.right), others, self._shown(unread.fit))
        blobs = carried(unread, self.images.rig, self.table)
        found = self.at(blobs, others) if blobs else None
        if found is None:
            return None
        (blobs, where), there = found
        return (as_predicted(unread, blobs, there.fit, self.images.rig), where), there

    def at_fading(self, unread: Unread, others: Sequence[SolidFit]) -> Seen | None:
        """The same as a round solid: what else has no limbs that may fade, which count as edges in these images."""
        found = self.at_refused(unread, others)
        return found if found and isinstance(KINDS[found[1].fit.kind], Round) else None

    def _shown(self, fit: SolidFit | None) -> float:
        """How much of its silhouette a body shows that what was refused was taken for; 0 of what may be a lit top."""
        if fit is None or is_flat(fit, TOP):
            return 0.0
        return adjusted([fit], self.images.maps, self.images.rig, None, before=self.before)[0][0].shown

    @property
    def _evident(self) -> Evident:
        return Evident(self.images, self.table, self.before, self.may_be_astray)

    def _hinted(self, blobs: BlobPair) -> list[Solids]:
        """What an object's outlines hint at, with and without what is another's."""
        several = dict.fromkeys([clear_of(blobs, self.images), blobs])
        return [each for one in several for each in standing_candidates(self.images, convex_outlines(one), self.table)]

    def free_ones(self, candidates: Iterable[Supported], others: Sequence[SolidFit]) -> list[Found]:
        """The best of these, each another one, that lie on edges where there is room, and where all edges put them."""
        found: list[Found] = []
        for each in candidates:
            if len(found) == _LOOKED_AT:
                break
            if _is_among(found, each):
                continue
            there = self._free(each, others)
            if there is not None:
                found.append((each, there))
        return found

    def _with_ended(self, free: Sequence[Found], others: Sequence[SolidFit]) -> list[Found]:
        """The same, and those that end where a rim shows instead of any of theirs."""
        rimless = [there.fit.solid for _, there in free if there.has_creases and not there.is_creased]
        images, table = self.images, self.table
        several = [each for solid in rimless for each in ended(solid, images.maps, images.rig, table, images.occluders)]
        more = self.free_ones(nearly(images, several, table), others)
        return [*free, *(each for each in more if not _is_among(free, each[0]))]

    def _free(self, found: Supported, others: Sequence[SolidFit]) -> Adjusted | None:
        """Where all its edges put a solid, if it is no sheet and no other is there."""
        if is_flat(found.fit) or self._clashes(found.fit, others):
            return None
        rig, maps = self.images.rig, self.images.maps
        in_shadow = self.images.in_shadow
        there = adjusted([found.fit], maps, rig, self.table, known=True, before=self.before, in_shadow=in_shadow)[0][0]
        return there if stands_on(self.table, there.fit) and not self._clashes(there.fit, others) else None

    def _clashes(self, fit: SolidFit, others: Sequence[SolidFit]) -> bool:
        rig = self.images.rig
        if any(clash(fit, each, rig) or reach_into_each_other(fit, each) or goes_on_as(fit, each) for each in others):
            return True
        return any(is_where(fit, each, rig) for each in self.besides)

    def around(self, blobs: BlobPair) -> list[Solids]:
        """What most edges around an object's outlines agree on."""
        images, known = self.images, self.images.occluders
        reach_px = _REACH * max(blob.rectangle[0] for blob in blobs)
        places_px = [blob.centroid_px for blob in blobs]
        covered = known.cover if known else None
        return solids_around(images.maps, images.rig, self.table, places_px, reach_px, covered, images.in_shadow)


def _is_among(several: Sequence[Found], found: Supported) -> bool:
    """Whether one of several solids is the same one."""
    return any(found.fit.kind == other.fit.kind and agree(found.fit, other.fit) for other, _ in several)


def _is_as_likely(another: Adjusted, found: Adjusted) -> bool:
    """Whether as much of it shows, with no more edges beside it, where it says they are, and not without the creases
    that it must have."""
    shows_as_much = another.shown >= found.shown and another.denied <= found.denied
    return shows_as_much and another.creased >= CREASED and not another.is_astray


def _most_shown(several: Sequence[Found], shown: float) -> float:
    """The most that any of several, or another one, shows of its silhouette."""
    return max([shown, *(there.shown for _, there in several)])


def may_be_found(refused: Sequence[Unread]) -> list[Unread]:
    """Those refused that may be found yet, sharp and whole: what both views show first, and the largest first."""
    several = [each for each in refused if each.reason in _REASONS and _is_whole(each.left) and _is_whole(each.right)]
    alone = [each for each in refused if each.reason in _REASONS_ALONE and _is_whole(each.alone)]
    return [*sorted(several, key=_area_px2, reverse=True), *sorted(alone, key=_area_px2, reverse=True)][:MOST]


def _is_whole(blob: Blob | None) -> bool:
    return blob is not None and blob.fault in ("", "merged", "beside_bright") and len(blob.sharpness) > 0


def _area_px2(refused: Unread) -> float:
    return sum(blob.area_px2 for blob in (refused.left, refused.right) if blob)
