"""A last look at what would be refused: the table is known by now, and the other objects on it.

What the outlines hint at is tried first, and then what most edges around them agree on. A solid found so late must
be hardly anything else: exactly on its edges, its creases shown, where no other object is.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from stereo_pick.core.correspondence.clear_of import clear_of
from stereo_pick.core.correspondence.left_over import Unread
from stereo_pick.core.correspondence.located import convex_outlines, is_flat
from stereo_pick.core.correspondence.overlap import clash
from stereo_pick.core.correspondence.position import BlobPair, Row, by_supported
from stereo_pick.core.shapes.adjusted import Adjusted
from stereo_pick.core.shapes.adjustment import adjusted
from stereo_pick.core.shapes.common_table import stands_on
from stereo_pick.core.shapes.consensus import solids_around
from stereo_pick.core.shapes.hypotheses import CHANCE, Images, Supported
from stereo_pick.core.shapes.solid_fit import SolidFit
from stereo_pick.core.shapes.solids import Solids
from stereo_pick.core.shapes.standing import exactly, no_surer_than_rivals, standing_candidates
from stereo_pick.core.shapes.table import Table

_REACH = 1.1  # lengths of the outlines from their middles, where only a part of it may be lit
_LOOKED_AT = 6  # solids for each object
_NEVER = ("faint", "cut_by_border", "beside_bright", "flat")

Seen = tuple[Row, Adjusted]


@dataclass(frozen=True, eq=False)
class LastLook:
    """images: the views, behind what is known; table: what the objects stand on; before: solids that may hide
    others."""

    images: Images
    table: Table
    before: Sequence[SolidFit]

    def at(self, blobs: BlobPair, others: Sequence[SolidFit], least_shown: float = 0.0) -> Seen | None:
        """An object as the solid on the table that the edges show clearly where none of the others is; None where there
        is none of which so much of the silhouette is shown."""
        several = dict.fromkeys([clear_of(blobs, self.images), blobs])
        hinted = [
            each for one in several for each in standing_candidates(self.images, convex_outlines(one), self.table)
        ]
        found = self._clearest(blobs, hinted, others) or self._clearest(blobs, self._around(blobs), others)
        return None if found is None or found[1].shown < least_shown else found

    def at_refused(self, unread: Unread, others: Sequence[SolidFit]) -> Seen | None:
        """The same of what both views show of what was refused."""
        if unread.left is None or unread.right is None or unread.reason in _NEVER:
            return None
        blobs = unread.left, unread.right
        return self.at(blobs, others) if all(len(blob.sharpness) for blob in blobs) else None

    def _clearest(self, blobs: BlobPair, candidates: Sequence[Solids], others: Sequence[SolidFit]) -> Seen | None:
        """The best of these that is hardly anything else, and has as much of its silhouette on edges as any other."""
        exact = exactly(self.images, candidates, self.table)[:_LOOKED_AT]
        free = [(each, there) for each in exact for there in (self._free(each, others),) if there is not None]
        least = max((there.shown for _, there in free), default=0.0) - CHANCE
        clear = [(each, there) for each, there in free if _is_clear(there, least)]
        if not clear:
            return None
        (first, there), *rivals = clear
        longer = self.images.longer(first.fit.solid, self.table)
        if longer is not None and longer.believable and longer.support >= first.support - CHANCE:
            beyond = self._free(longer, others)
            if beyond is not None and _is_clear(beyond, least):
                return self._row(blobs, longer), beyond
        best = no_surer_than_rivals(first, [each for each, _ in rivals])
        return None if best is None else (self._row(blobs, best), there)

    def _row(self, blobs: BlobPair, found: Supported) -> Row:
        return blobs, by_supported(self.images.rig, found)

    def _free(self, found: Supported, others: Sequence[SolidFit]) -> Adjusted | None:
        """Where all its edges put a solid, if no other is there."""
        if is_flat(found.fit) or self._clashes(found.fit, others):
            return None
        rig, maps = self.images.rig, self.images.maps
        there = adjusted([found.fit], maps, rig, self.table, known=True, before=self.before)[0][0]
        return there if stands_on(self.table, there.fit) and not self._clashes(there.fit, others) else None

    def _clashes(self, fit: SolidFit, others: Sequence[SolidFit]) -> bool:
        return any(clash(fit, other, self.images.rig) for other in others)

    def _around(self, blobs: BlobPair) -> list[Solids]:
        """What most edges around an object's outlines agree on."""
        images, known = self.images, self.images.occluders
        reach_px = _REACH * max(blob.rectangle[0] for blob in blobs)
        places_px = [blob.centroid_px for blob in blobs]
        return solids_around(images.maps, images.rig, self.table, places_px, reach_px, known.cover if known else None)


def _is_clear(found: Adjusted, least_shown: float) -> bool:
    return found.is_clear and found.shown >= least_shown
