"""Pieces of a solid that was found late, of which clearly more shows than of all of it."""

from __future__ import annotations

from collections.abc import Sequence

from stereo_pick.core.doubts.second_thoughts import WELL_SHOWN
from stereo_pick.core.edges.adjusted import Adjusted
from stereo_pick.core.edges.adjustment import adjusted
from stereo_pick.core.edges.hypotheses import Images
from stereo_pick.core.edges.shortening import shortened
from stereo_pick.core.edges.standing import exactly
from stereo_pick.core.edges.supported import CHANCE, Supported
from stereo_pick.core.places.located import is_flat
from stereo_pick.core.shapes.common_table import stands_on
from stereo_pick.core.shapes.solid_fit import SolidFit
from stereo_pick.core.shapes.table import Table

_ABOVE = 1 / 4  # of its height, that no shadow at its foot hides

Found = tuple[Supported, Adjusted]


def shorter(images: Images, table: Table, before: Sequence[SolidFit], found: Found) -> Found | None:
    """A solid on the table without what goes on beyond it, such as a mark, if so it shows clearly more of itself.

    before: solids that may hide others.
    """
    whole = found[1]
    if whole.shown > WELL_SHOWN:
        return None
    solid = whole.fit.solid
    for each in exactly(images, shortened(solid, images.eyes_m, images.maps, table), table):
        there = adjusted([each.fit], images.maps, images.rig, table, known=True, before=before)[0][0]
        if _shows_more(there, whole) and stands_on(table, there.fit):
            return each, there
    return None


def ends_above(images: Images, table: Table, before: Sequence[SolidFit], whole: Adjusted) -> bool:
    """Whether a piece of a solid shows clearly more of itself, and ends well above the table: so it stands on something
    else. But the lit top of what stands on the table shows clearly, too."""
    solid = whole.fit.solid
    least_m = _ABOVE * (whole.fit.reach_m(table.normal) + whole.fit.reach_m(-table.normal))
    for each in exactly(images, shortened(solid, images.eyes_m, images.maps, None), None):
        there = adjusted([each.fit], images.maps, images.rig, None, before=before)[0][0]
        if _shows_more(there, whole) and float(table.under(there.fit.solid)[0][0]) > least_m:
            return True
    return False


def _shows_more(piece: Adjusted, whole: Adjusted) -> bool:
    """Whether what is no sheet is surely there, and shows clearly more of itself."""
    return piece.is_clear and not is_flat(piece.fit) and piece.shown > whole.shown + CHANCE
