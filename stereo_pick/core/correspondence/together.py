"""Objects and their table adjusted together, once it is known what each is, as far as its edges bear that out."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from stereo_pick.core.arrays import Floats
from stereo_pick.core.correspondence.beyond_solid import goes_on_beyond, is_seen_alone
from stereo_pick.core.correspondence.clear_of import clear_of
from stereo_pick.core.correspondence.last_look import LastLook, Seen, may_be_found
from stereo_pick.core.correspondence.left_over import Unread
from stereo_pick.core.correspondence.position import (
    BlobPair,
    Row,
    by_adjusted,
    centres_by_outlines_px,
    of_size,
    with_dark_ends,
)
from stereo_pick.core.correspondence.reading import Reading
from stereo_pick.core.correspondence.second_thoughts import (
    CREASED,
    WELL_SHOWN,
    is_flat_after_all,
    reconsidered,
)
from stereo_pick.core.rig import StereoRig
from stereo_pick.core.shapes.adjusted import Adjusted
from stereo_pick.core.shapes.adjustment import adjusted
from stereo_pick.core.shapes.common_table import stands_on
from stereo_pick.core.shapes.hypotheses import BODY, Images
from stereo_pick.core.shapes.kinds import KINDS, Prism
from stereo_pick.core.shapes.solid_fit import SolidFit
from stereo_pick.core.shapes.table import Table

_WELL_SEEN = 1 / 2  # of its silhouette and its creases, with less of which an object is in doubt
_HANGS = 0.5  # of its least size above the table, where a solid is mistaken rather than on top of something


@dataclass(frozen=True, eq=False)
class Together:
    """kept: the objects, where they are; refused: what was and is not found after all, what is not what its outlines
    seem to be, and what is flat after all; table: what the objects stand on, as far as that is known."""

    kept: list[Row]
    refused: list[Unread]
    table: Table | None


def adjusted_together(images: Images, reading: Reading, known: bool, flat_parts: bool) -> Together:
    """The objects where all edges together put them that solids explain, and the others as they are.

    known: whether the table is known without them; flat_parts: whether parts may be flat.
    """
    rows, table = reading.kept, reading.table
    whole = [_with_dark_ends(images, row, rows) for row in rows]
    rest = [row for row in whole if row[1].fit is None or row[1].is_rough]
    solids = [row for row in whole if row not in rest]
    found, common = _adjusted(images, solids, table, known)
    # on the table as it was: what is mistaken has its part in how it is now
    behind = images.behind([each.fit for each in found if each.is_clear])
    others = [reconsidered(behind, row, each, table) for row, each in zip(solids, found)]
    unlike = [row for row, other in zip(solids, others) if other is None]
    astray = [row for row, other, each in zip(solids, others, found) if other is row and each.is_astray]
    sound = [other for other in others if other is not None and other not in astray]
    if sound != solids:
        found, common = _adjusted(images, sound, table, known)
    unlike += [row for row, each in zip(sound, found) if not each.is_seen]
    seen = [(row, each) for row, each in zip(sound, found) if each.is_seen]
    open_ = [Unread("other_shape", *blobs) for blobs, _ in unlike] + list(reading.unread)
    seen, refused = _looked_for_again(images, open_, seen, rest + astray, common)
    placed = [row if each.is_astray else _placed(images, row, each, common) for row, each in seen]
    flat = [] if flat_parts else [row for row in placed if is_flat_after_all(row, common)]
    refused += [Unread("flat", *blobs) for blobs, _ in flat]
    return Together(rest + astray + [row for row in placed if row not in flat], refused, common)


def _with_dark_ends(images: Images, row: Row, rows: Sequence[Row]) -> Row:
    """The same with the ends that its own outlines, where they are clear of the others, leave out."""
    blobs, where = row
    others = [each.fit for _, each in rows if each is not where and each.fit is not None]
    return blobs, with_dark_ends(images.rig, clear_of(blobs, images.behind(others), where.fit), where)


def _adjusted(
    images: Images, rows: Sequence[Row], table: Table | None, known: bool
) -> tuple[list[Adjusted], Table | None]:
    fits = [where.fit for _, where in rows if where.fit is not None]
    return adjusted(fits, images.maps, images.rig, table, known) if fits else ([], table)


def _looked_for_again(
    images: Images, open_: Sequence[Unread], seen: Sequence[Seen], besides: Sequence[Row], table: Table | None
) -> tuple[list[Seen], list[Unread]]:
    """Those that are seen, some of them as another solid on the table as it is at last: what lacks its creases, and
    what was refused, is looked for again where none of the others, or of those besides, is; and what stays refused."""
    if table is None:
        return list(seen), list(open_)
    found = [(row, each) for row, each in seen if each.creased >= CREASED]
    before = [each.fit for _, each in found if each.is_clear]
    look = LastLook(images.as_rough_as(before).behind(before), table, before, [where for _, where in besides])
    for row, as_it_was in [one for one in seen if one not in found]:
        others = [each.fit for one, each in [*seen, *found] if one is not row]
        found.append(look.at(row[0], others, as_it_was.shown) or (row, as_it_was))
    refused = list(open_)
    for unread in may_be_found(open_):
        another = look.at_refused(unread, [each.fit for _, each in found])
        if another is None:
            continue
        (blobs, _), there = another
        found.append(another)
        if not goes_on_beyond(blobs, there.fit, images):  # else the rest of it is refused still
            refused.remove(unread)
        refused = [each for each in refused if not is_seen_alone(each, there.fit, images)]
    return found, refused


def _placed(images: Images, row: Row, found: Adjusted, table: Table | None) -> Row:
    """Where the solid is, and how sure that is."""
    (blobs, where), fit = row, found.fit
    doubt = where.doubt + (_as_if_it_stood(found, table, images.rig) if table else 0.0)
    if goes_on_beyond(blobs, fit, images):
        doubt = doubt + _off_its_outlines(blobs, fit, images.rig)
    if _may_be_longer(found, table):
        doubt = doubt + of_size(fit)
    if _may_be_a_side(found, table):
        doubt = doubt + float(fit.size_m.min()) ** 2 / 12 * np.eye(3)  # anywhere within its thickness
    if _may_be_a_streak(found, table):
        doubt = doubt + (float(fit.size_m.max()) / 2) ** 2 * np.eye(3)
    return blobs, by_adjusted(images.rig, where, fit, doubt)


def _may_be_longer(found: Adjusted, table: Table | None) -> bool:
    """Whether much of its edges does not show; or, without a table, some: it may go on to the end of its shadow."""
    if found.shown < WELL_SHOWN and table is None:
        return True
    is_in_doubt = isinstance(KINDS[found.fit.kind], Prism) or found.shown < WELL_SHOWN
    return is_in_doubt and found.shown * found.creased < _WELL_SEEN


def _may_be_a_streak(found: Adjusted, table: Table | None) -> bool:
    """Whether a rod may be light that mirrors along a thicker one: no table, and not all of its edges, are there to
    tell."""
    return table is None and found.shown < WELL_SHOWN and found.fit.flatness < BODY


def _may_be_a_side(found: Adjusted, table: Table | None) -> bool:
    """Whether nothing tells how far away a solid is that lacks its creases, but as much of its silhouette as shows."""
    return table is None and found.shown < WELL_SHOWN and not found.is_creased


def _as_if_it_stood(found: Adjusted, table: Table, rig: StereoRig) -> Floats:
    """Covariance (3, 3) [m²] from where it hangs above the table to where another solid that is seen alike would stand.

    Nothing hangs in the air, and what lies on something else is higher up than a part of its own size, and shows by its
    creases what it is; a ball, which has none, is believed.
    """
    fit = found.fit
    height_m = float(table.under(fit.solid)[0][0])
    if stands_on(table, fit) or height_m < 0:
        return np.zeros((3, 3))
    if height_m > _HANGS * float(fit.size_m.min()) and found.is_creased:
        return np.zeros((3, 3))
    ahead = fit.centre_m - rig.eyes_m.mean(axis=0)
    down_m = -ahead * height_m / float(table.normal @ ahead)
    return np.outer(down_m, down_m) / 4 + of_size(fit)


def _off_its_outlines(blobs: BlobPair, fit: SolidFit, rig: StereoRig) -> Floats:
    """Covariance (3, 3) [m²] of the centre of what may have that of its outlines as well as the solid's."""
    per_px = float(fit.centre_m[2]) / rig.focal_px
    own = fit.centre_px(rig.left), fit.centre_px(rig.right)
    off_px = [np.linalg.norm(seen - px) for seen, px in zip(centres_by_outlines_px(rig, blobs, fit), own)]
    return np.asarray((max(off_px) * per_px) ** 2 * np.eye(3))
