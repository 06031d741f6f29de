"""Whether a solid that is found late, where the table and most objects are known, is hardly anything else."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from stereo_pick.core.doubts.beyond_solid import goes_on_beyond
from stereo_pick.core.doubts.second_thoughts import WELL_SHOWN
from stereo_pick.core.doubts.seen_surface import is_seen_beyond, is_surface_seen
from stereo_pick.core.edges.adjusted import ASTRAY_PX, MOST_SHOWN, Adjusted
from stereo_pick.core.edges.adjustment import adjusted
from stereo_pick.core.edges.creases import creases
from stereo_pick.core.edges.hypotheses import Images
from stereo_pick.core.edges.supported import CHANCE, Supported, carries
from stereo_pick.core.found_late.patterned import PATTERN_PX
from stereo_pick.core.places.position import BlobPair
from stereo_pick.core.shapes.common_table import surely_on
from stereo_pick.core.shapes.kinds import CYLINDER, SPHERE
from stereo_pick.core.shapes.solid_fit import SolidFit
from stereo_pick.core.shapes.table import Table

_HALF = 1 / 2  # of its silhouette, for what its edges alone put on the table ...
_KNOWN = 0.05  # ... as sure as this part of its size
_ROUNDED_M = 0.00025  # by which edges lie off: 0.41 of a radius of 0.6 mm, twice the usual sigma of that
_DENIED = 1 / 20  # of a silhouette, with edges clearly beside it
_BESIDE, _MOST_BESIDE = 1 / 10, 1 / 4  # ... of a solid with a pattern, which has edges of its own there


@dataclass(frozen=True, eq=False)
class Evident:
    """images: the views, behind what is known; table: what the objects stand on; before: solids that may hide
    others; may_be_astray: whether what does not lie exactly on its edges will do, if it is a ball, or shows its creases
    and has rounded edges perhaps: not to bear a table out."""

    images: Images
    table: Table
    before: Sequence[SolidFit]
    may_be_astray: bool = False

    def is_clear(self, blobs: BlobPair, found: Supported, there: Adjusted, most_shown: float) -> bool:
        """Whether an object of these outlines is a solid, where all its edges put that, by them or by its pattern;
        most_shown: of its silhouette, of any other solid that it may be."""
        if (self._may_be_off(there) or not there.is_astray) and (
            self._shows_itself(found, there, most_shown) or self._is_told(blobs, there, most_shown)
        ):
            return True
        return self.shows_its_surface(blobs, there, most_shown)

    def _may_be_off(self, there: Adjusted) -> bool:
        if not self.may_be_astray:
            return False
        rounded_px = _ROUNDED_M * self.images.rig.focal_px / there.fit.centre_m[2]
        is_round_edged = there.fit.residual_px < np.hypot(ASTRAY_PX, rounded_px)
        return there.fit.kind == SPHERE.name or (there.shows_creases and bool(is_round_edged))

    def _shows_itself(self, found: Supported, there: Adjusted, most_shown: float) -> bool:
        """Whether it shows most of its silhouette, about as much as any other would, and its creases if it has any; or
        half of that, if it is on the table by what shows alone. A ball, which is no piece of another, need not be so
        exactly on its edges."""
        is_ball = there.fit.kind == SPHERE.name
        least = most_shown - CHANCE if there.has_creases or is_ball else most_shown  # its silhouette is all that speaks
        if there.shown < least:
            return False
        if not there.is_creased:
            return found.is_exact and _is_all_of_a_cylinder(there, most_shown)
        seen = there.shown, there.fit.residual_px
        noise_px = self.images.noise_px
        is_exact = found.is_exact or carries(*seen, noise_px=noise_px)
        if is_exact and (there.has_creases or there.shown >= MOST_SHOWN):
            return True
        is_half = there.shown > _HALF if is_ball else carries(*seen, _HALF, noise_px)
        return is_half and self._stands_by_itself(there.fit)

    def shows_its_surface(self, blobs: BlobPair, there: Adjusted, most_shown: float) -> bool:
        """Whether its surface is seen where it is, and it ends where that does: half of its silhouette shows, about as
        much as any other would, with few edges beside it, or its surface is not seen beyond; and there is nothing more
        to the outlines. Edges are off by more where a pattern has some of its own beside them."""
        if there.shown < max(_HALF, most_shown - CHANCE) or there.fit.residual_px > PATTERN_PX:
            return False
        if there.denied > _MOST_BESIDE or goes_on_beyond(blobs, there.fit, self.images):
            return False
        seen = self.images.pair, there.fit, self.before
        return is_surface_seen(*seen) and not (there.denied > _BESIDE and is_seen_beyond(*seen))

    def _is_told(self, blobs: BlobPair, there: Adjusted, most_shown: float) -> bool:
        """Whether it is told from all others, none of which shows more of its silhouette: its creases show and there is
        nothing more to the outlines, or hardly an edge lies beside what does not show, most of which does, or, of a
        cylinder, whose ends may be as bright as its side, enough to put it on the table."""
        if there.shown < most_shown or there.shown <= _HALF:
            return False
        if there.shows_creases and not goes_on_beyond(blobs, there.fit, self.images):
            return True
        if there.denied > _DENIED:
            return False
        return there.shown > MOST_SHOWN or (there.fit.kind == CYLINDER.name and self._stands_by_itself(there.fit))

    def _stands_by_itself(self, fit: SolidFit) -> bool:
        """Whether a solid's edges put it on the table that know nothing of that; those of a cylinder between its ends
        do not tell how long it is."""
        if fit.kind == CYLINDER.name and not creases(fit.solid, self.images.eyes_m).seen.any():
            return False
        alone = adjusted([fit], self.images.maps, self.images.rig, None, before=self.before)[0][0].fit
        sigma_m = float(np.sqrt(self.table.normal @ alone.covariance @ self.table.normal))
        return sigma_m < _KNOWN * float(alone.size_m[0]) and surely_on(self.table, alone)


def _is_all_of_a_cylinder(there: Adjusted, most_shown: float) -> bool:
    """Whether a cylinder, whose ends may be as bright as its side, shows all of its silhouette, or clearly more than
    any other."""
    return there.fit.kind == CYLINDER.name and there.shown > min(WELL_SHOWN, max(MOST_SHOWN, most_shown + CHANCE))
