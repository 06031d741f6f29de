"""Dark parts that stand in their own shadow, which hides where they end: found by what is above it.

What of a silhouette is in the upper half of a part must show, all of it, before something lit; what is lower need not,
where it is dark. Nothing but shadow may lie beside the part then: nothing that rises from the table.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from stereo_pick.core.doubts.second_thoughts import WELL_SHOWN
from stereo_pick.core.edges.open_end import has_open_end
from stereo_pick.core.edges.own_shadow import ends_in_light, is_dark
from stereo_pick.core.edges.standing import most_shown, no_surer_than_rivals
from stereo_pick.core.found_late.carried import as_predicted, carried
from stereo_pick.core.found_late.last_look import LastLook, Seen
from stereo_pick.core.found_late.pieces import Found
from stereo_pick.core.matches.left_over import Unread
from stereo_pick.core.places.position import BlobPair, by_supported
from stereo_pick.core.shapes.solid_fit import SolidFit
from stereo_pick.core.tables.lying_flat import WarpedViews


def in_its_shadow(look: LastLook, warped: WarpedViews, blobs: BlobPair, others: Sequence[SolidFit]) -> Seen | None:
    """A dark object of these outlines as the solid on the table, where none of the others is, that shows all of itself
    but its foot; None where there is none, or where it is open which it is."""
    pair = warped.pair
    if not all(is_dark(view, blob.contour_px) for view, blob in zip((pair.left, pair.right), blobs)):
        return None
    shaded = replace(look, images=look.images.in_own_shadow())
    candidates = most_shown(shaded.images, shaded.around(blobs), look.table)
    clear = [each for each in shaded.free_ones(candidates, others) if _is_clear(shaded, each)]
    whole = [each for each in clear if not warped.rising(blobs[0], [*others, each[1].fit])]
    if not whole:
        return None
    (first, there), *rest = sorted(whole, key=lambda each: -each[1].shown)
    best = no_surer_than_rivals(first, [each for each, _ in rest])
    if best is None:
        return None
    return (blobs, by_supported(pair.rig, best)), there


def refused_in_its_shadow(
    look: LastLook, warped: WarpedViews, unread: Unread, others: Sequence[SolidFit]
) -> Seen | None:
    """The same of what was refused, if need be by the outline of one view, and where the table has it in the other."""
    if unread.left and unread.right:
        return in_its_shadow(look, warped, (unread.left, unread.right), others)
    blobs = carried(unread, warped.pair.rig, look.table)
    found = in_its_shadow(look, warped, blobs, others) if blobs else None
    if found is None:
        return None
    (blobs, where), there = found
    return (as_predicted(unread, blobs, there.fit, warped.pair.rig), where), there


def _is_clear(look: LastLook, found: Found) -> bool:
    images, (_, there) = look.images, found
    if there.is_astray or there.shown <= WELL_SHOWN:
        return False
    solid = there.fit.solid
    if has_open_end(solid, images.eyes_m, images.maps, look.table):
        return False
    return ends_in_light(solid, images.maps, images.rig, look.table)
