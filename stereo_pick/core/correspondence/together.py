"""Objects and their table adjusted together, once it is known what each is, as far as its edges bear that out."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from stereo_pick.core.correspondence.reading import Reader, Reading
from stereo_pick.core.correspondence.sureness import placed_surely, seen_in_part
from stereo_pick.core.doubts.outvoted_table import unless_outvoted
from stereo_pick.core.doubts.rising_outline import rises_beside
from stereo_pick.core.doubts.second_thoughts import CREASED, WELL_SHOWN, is_flat_after_all, reconsidered
from stereo_pick.core.doubts.standing_out import stands_out
from stereo_pick.core.edges.adjusted import Adjusted
from stereo_pick.core.edges.adjustment import adjusted
from stereo_pick.core.edges.hypotheses import Images
from stereo_pick.core.edges.open_end import has_open_end
from stereo_pick.core.found_late.found_after_all import found_after_all
from stereo_pick.core.found_late.last_look import LastLook, Seen
from stereo_pick.core.found_late.shaded_foot import in_its_shadow
from stereo_pick.core.matches.left_over import Unread
from stereo_pick.core.places.clear_of import clear_of
from stereo_pick.core.places.position import Row, may_have_dark_ends, with_dark_ends
from stereo_pick.core.shapes.common_table import base_m, stands_on
from stereo_pick.core.shapes.solid_fit import SolidFit
from stereo_pick.core.shapes.table import Table
from stereo_pick.core.tables.lying_flat import WarpedViews

_BY_CHANCE = 0.1  # of a silhouette, with edges clearly beside it


@dataclass(frozen=True, eq=False)
class Together:
    """kept: the objects, where they are; refused: what was and is not found after all, what is not what its outlines
    seem to be, and what is flat after all; warped: what the views show of the table, as far as that is known."""

    kept: list[Row]
    refused: list[Unread]
    warped: WarpedViews | None

    @property
    def table(self) -> Table | None:
        """What the objects stand on."""
        return self.warped.table if self.warped else None


def adjusted_together(reader: Reader, reading: Reading, known: bool, edge_radius_m: float) -> Together:
    """The objects where all edges together put them that solids explain, if need be at a last look, and the others as
    they are.

    known: whether the table is known without them; edge_radius_m: one sigma of how far their edges are rounded.
    """
    images, rows, table = reader.images, reading.kept, reading.table
    whole = [_with_dark_ends(images, row, rows, table) for row in rows]
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
    warped = WarpedViews(images.pair, common) if common else None
    seen, refused, rest = _looked_for_again(reader, reading.aside, open_, seen, rest, astray, warped)
    exact = _exactly(images, seen, table if known else common, known, edge_radius_m)
    placed = placed_surely(images, seen, exact, table, warped)
    if not known:
        placed = unless_outvoted(common, placed, refused)
    both = [(row, each) for row, (_, each) in zip(placed, seen)]
    fits = [each.fit for _, each in both] + [where.fit for _, where in rest if where.fit is not None]
    more = _standing_out(images, both, fits)
    more += [row for row in _pieces(images, both, common) if row not in more]
    more += [row for row in _outgrown(images, both, fits, common) if row not in more]
    more += [row for row in _seen_through(both, warped) if row not in more]
    flat = [] if reader.flat_parts else [row for row in placed if is_flat_after_all(row, common)]
    if warped is not None and not reader.flat_parts:
        flat += _printed(warped, [(row, each) for row, each in both if row not in flat])
    refused += [Unread("flat", *blobs) for blobs, _ in flat]
    refused += [Unread("other_shape", *row[0]) for row in more if row not in flat]
    rest = [seen_in_part(row, images.rig, common) for row in rest]
    return Together(rest + astray + [row for row in placed if row not in flat + more], refused, warped)


def _with_dark_ends(images: Images, row: Row, rows: Sequence[Row], table: Table | None) -> Row:
    """The same with the ends that its own outlines, where they are clear of the others, leave out; but what stands on
    the table does not go on below it, though a mirror may show it there."""
    blobs, where = row
    if where.fit is None or not may_have_dark_ends(where):
        return row
    others = [each.fit for _, each in rows if each is not where and each.fit is not None]
    whole = with_dark_ends(images.rig, clear_of(blobs, images.behind(others), where.fit), where)
    return row if table is not None and _sinks(where.fit, whole.fit, table) else (blobs, whole)


def _sinks(stands: SolidFit, whole: SolidFit | None, table: Table) -> bool:
    """Whether what stands on the table would go on below it."""
    return whole is not None and stands_on(table, stands) and not stands_on(table, whole) and base_m(table, whole) < 0


def _adjusted(
    images: Images, rows: Sequence[Row], table: Table | None, known: bool
) -> tuple[list[Adjusted], Table | None]:
    fits = [where.fit for _, where in rows if where.fit is not None]
    return adjusted(fits, images.maps, images.rig, table, known) if fits else ([], table)


def _exactly(
    images: Images, seen: Sequence[Seen], table: Table | None, known: bool, edge_radius_m: float
) -> list[SolidFit]:
    """The solids where their edges put them once these are placed as exactly as can be; what is astray as it was."""
    clear = [each.fit for _, each in seen if not each.is_astray]
    if not clear:
        return [each.fit for _, each in seen]
    exact, _ = adjusted(clear, images.exact_maps, images.rig, table, known, edge_radius_m=edge_radius_m)
    found = iter(exact)
    return [each.fit if each.is_astray else next(found).fit for _, each in seen]


def _looked_for_again(
    reader: Reader,
    aside: Sequence[Unread],
    open_: Sequence[Unread],
    seen: Sequence[Seen],
    rest: Sequence[Row],
    astray: Sequence[Row],
    warped: WarpedViews | None,
) -> tuple[list[Seen], list[Unread], list[Row]]:
    """Those that are seen, some of them as another solid on the table as it is at last; what stays refused; and what of
    the rest is no solid."""
    if warped is None:
        return list(seen), list(open_), list(rest)
    images, before = reader.images, _known(seen)
    look = LastLook(images.as_rough_as(before), warped.table, before, [where for _, where in [*rest, *astray]])
    seen = _read_better(look, seen)
    before = _known(seen)
    look = replace(look, images=look.images.behind(before), before=before)
    found, rest = _read_again(look, warped, seen, rest)
    if not reader.last_look:
        return found, list(open_), rest
    look = replace(look, besides=[where for _, where in [*rest, *astray]], may_be_astray=True)
    return *found_after_all(images, look, open_, aside, found, warped), rest


def _known(seen: Sequence[Seen]) -> list[SolidFit]:
    """What is hardly anything else, so that it may hide others."""
    return [each.fit for _, each in seen if _is_settled(each) and each.is_clear]


def _read_better(look: LastLook, seen: Sequence[Seen]) -> list[Seen]:
    """The same, where some of a silhouette has edges beside it instead perhaps as another solid that shows clearly more
    of its own, or less sure: a part and its shadow together may pass for one, and stand on the table as well."""
    found = list(seen)
    for i, (row, as_it_was) in enumerate(seen):
        if as_it_was.shown > WELL_SHOWN or as_it_was.denied <= _BY_CHANCE or not _is_settled(as_it_was):
            continue
        before = [fit for fit in look.before if fit is not as_it_was.fit]
        alone = replace(look, images=look.images.behind(before), before=before)
        others = [each.fit for j, (_, each) in enumerate(found) if j != i]
        another, off_m = alone.instead(row[0], others, as_it_was)
        doubted = row[0], replace(row[1], doubt=row[1].doubt + float(off_m @ off_m) * np.eye(3))
        found[i] = another or (doubted, as_it_was)
    return found


def _read_again(
    look: LastLook, warped: WarpedViews, seen: Sequence[Seen], rest: Sequence[Row]
) -> tuple[list[Seen], list[Row]]:
    """What is seen, where it lacks its creases perhaps as another solid, and what no solid explained but one does now;
    and the others of these."""
    found = [(row, each) for row, each in seen if _is_settled(each)]
    for row, as_it_was in [one for one in seen if one not in found]:
        others = [each.fit for one, each in [*seen, *found] if one is not row]
        found.append(look.at(row[0], others, as_it_was.shown) or (row, as_it_was))
    left = []
    for row in rest:
        alone = look.without(row[1])
        another = _explained(alone, warped, row, [each.fit for _, each in found])
        if another is None:
            left.append(row)
            continue
        found.append(another)
        look = alone
    return found, left


def _explained(look: LastLook, warped: WarpedViews, row: Row, others: Sequence[SolidFit]) -> Seen | None:
    """What no solid explained, as one that does."""
    blobs, where = row
    if where.fit is not None:
        return None
    return look.at(blobs, others) or in_its_shadow(look, warped, blobs, others)


def _is_settled(found: Adjusted) -> bool:
    """Whether what an object is needs no other look: its creases show, or, of a cylinder whose ends are not seen, most
    of its silhouette."""
    return found.creased >= CREASED and not found.may_be_another


def _standing_out(images: Images, placed: Sequence[Seen], solids: Sequence[SolidFit]) -> list[Row]:
    """Those before the surface of which something is seen that is none of the solids."""
    return [
        row for row, each in placed if stands_out(images.pair, each.fit, [fit for fit in solids if fit is not each.fit])
    ]


def _pieces(images: Images, placed: Sequence[Seen], table: Table | None) -> list[Row]:
    """Those that go on beyond one of their ends."""
    return [row for row, each in placed if has_open_end(each.fit.solid, images.eyes_m, images.maps, table)]


def _outgrown(images: Images, placed: Sequence[Seen], solids: Sequence[SolidFit], table: Table | None) -> list[Row]:
    """Those of which the outlines show something that rises from the table beside the solids."""
    return [row for row, _ in placed if table is not None and rises_beside(row[0], solids, images.rig, table)]


def _seen_through(placed: Sequence[Seen], warped: WarpedViews | None) -> list[Row]:
    """Those that are taken to reach farther than they do: the table is seen there."""
    return [row for row, each in placed if warped is not None and warped.is_seen_in_place_of_some(each.fit)]


def _printed(warped: WarpedViews, placed: Sequence[Seen]) -> list[Row]:
    """Those of which no crease, and nothing else, rises from the table, or through which it is seen."""
    fits = [each.fit for _, each in placed]
    return [
        row
        for row, each in placed
        if warped.shows_through(each.fit)
        or (not each.shows_creases and warped.is_all_of(row[0][0], [fit for fit in fits if fit is not each.fit]))
    ]
