"""What an object is after all: second thoughts, once the edges in and around it were compared with the solid.

A lying cylinder and its shadow have the silhouette of a box. What they have not are a box's edges inside of it.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from stereo_pick.core.edges.adjusted import MOST_SHOWN, Adjusted
from stereo_pick.core.edges.adjustment import adjusted
from stereo_pick.core.edges.hypotheses import BODY, Images
from stereo_pick.core.edges.shortening import shortened
from stereo_pick.core.edges.standing import exactly, most_supported
from stereo_pick.core.edges.supported import CHANCE
from stereo_pick.core.places.located import TOP, convex_outlines, is_flat
from stereo_pick.core.places.position import Row, by_supported, of_thickness
from stereo_pick.core.shapes.common_table import stands_on
from stereo_pick.core.shapes.fitting import can_be_fitted, nearest_of_kind
from stereo_pick.core.shapes.kinds import BOX, CYLINDER, HEX_PRISM, KINDS, Prism
from stereo_pick.core.shapes.solid_fit import SolidFit
from stereo_pick.core.shapes.table import Table

CREASED = 1 / 3  # of its creases, without which an object is no prism ...
WELL_SHOWN = 0.92  # ... but with so much of its silhouette, all but its corners: its faces may be dark, or lit, alike


def reconsidered(images: Images, row: Row, found: Adjusted, table: Table | None) -> Row | None:
    """The same, or what the object is instead: no prism, or one after all; None where that is open."""
    is_cylinder, is_prism = found.fit.kind == CYLINDER.name, isinstance(KINDS[found.fit.kind], Prism)
    shorter = _as_shorter(images, row, found, table)
    if shorter is not None:
        return shorter
    if found.is_astray and (is_cylinder or (is_prism and not is_flat(found.fit))):
        return None
    if is_cylinder and not found.has_creases:
        return _as_prism(images, row, found, table) or row
    if found.is_seen and (found.creased >= CREASED or not is_prism):
        return row
    if not is_prism:
        return None
    return _as_cylinder(images, row, found, table) or (row if found.shown > WELL_SHOWN else None)


def is_flat_after_all(row: Row, table: Table | None) -> bool:
    """Whether a solid has become so thin that it may be a print, or, where it is not seen to stand, a lit top."""
    fit = row[1].fit
    if fit is None:
        return False
    if table is None:
        return is_flat(fit, TOP) or _is_slab(fit)
    return is_flat(fit) if stands_on(table, fit) else is_flat(fit, TOP)


def _is_slab(fit: SolidFit) -> bool:
    """Whether a solid is much thinner than it is wide: it may be the top of another, with a strip of its side."""
    least, middle, _ = np.sort(fit.size_m)
    return bool(least < BODY * middle)


def _as_shorter(images: Images, row: Row, found: Adjusted, table: Table | None) -> Row | None:
    """The same object without what goes on beyond it, such as its shadow, if so it shows clearly more of itself."""
    if found.shown > WELL_SHOWN:
        return None
    for each in exactly(images, shortened(found.fit.solid, images.eyes_m, images.maps, table), table):
        there = adjusted([each.fit], images.maps, images.rig, table, known=True)[0][0]
        if there.is_clear and there.shown > found.shown + CHANCE:
            return row[0], by_supported(images.rig, each)
    return None


def _as_prism(images: Images, row: Row, found: Adjusted, table: Table | None) -> Row | None:
    """The same object as the prism that shows as much of its silhouette, and its creases as well, if one does; one that
    shows as much, but not its creases, leaves open where within its thickness the object is."""
    blobs, where = row
    outlines = convex_outlines(blobs)
    if not can_be_fitted(outlines):
        return None
    nearest = [nearest_of_kind([outlines], images.rig, kind, table)[outlines, kind][0] for kind in (BOX, HEX_PRISM)]
    has_rival = False
    for each in exactly(images, nearest, table):
        there = adjusted([each.fit], images.maps, images.rig, table, known=True)[0][0]
        if there.is_astray or there.shown < found.shown - CHANCE:
            continue
        if there.is_creased and there.has_creases:
            return blobs, by_supported(images.rig, each)
        has_rival = True
    return (blobs, replace(where, doubt=where.doubt + of_thickness(found.fit))) if has_rival else None


def _as_cylinder(images: Images, row: Row, found: Adjusted, table: Table | None) -> Row | None:
    """The same object as the cylinder that the edges support, if they do, and that shows its creases, or as much of its
    silhouette."""
    blobs, _ = row
    outlines = convex_outlines(blobs)
    if not can_be_fitted(outlines):
        return None
    nearest, _ = nearest_of_kind([outlines], images.rig, CYLINDER, table)[outlines, CYLINDER]
    other = most_supported(images, [nearest], table)
    if other is None:
        return None
    there = adjusted([other.fit], images.maps, images.rig, table, known=True)[0][0]
    is_shown = (there.is_clear and there.has_creases) or there.shown >= max(found.shown - CHANCE, MOST_SHOWN)
    return (blobs, by_supported(images.rig, other)) if is_shown else None
