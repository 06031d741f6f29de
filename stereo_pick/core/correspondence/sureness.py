"""How sure it is where solids are, once all edges have put them there: each may be another solid, or a part of one."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from stereo_pick.core.arrays import Floats
from stereo_pick.core.doubts.beyond_solid import ends_within, goes_on_beyond
from stereo_pick.core.doubts.mirrored import mirrored_m
from stereo_pick.core.doubts.second_thoughts import WELL_SHOWN
from stereo_pick.core.edges.adjusted import Adjusted
from stereo_pick.core.edges.hypotheses import BODY, Images
from stereo_pick.core.found_late.last_look import Seen
from stereo_pick.core.places.position import (
    BlobPair,
    Row,
    by_adjusted,
    centres_by_outlines_px,
    depth_m,
    of_size,
    of_thickness,
)
from stereo_pick.core.rig import StereoRig
from stereo_pick.core.shapes.common_normal import ANGLE
from stereo_pick.core.shapes.common_table import hangs_clear, stands_on
from stereo_pick.core.shapes.kinds import CYLINDER, KINDS, Prism
from stereo_pick.core.shapes.sight import normalized
from stereo_pick.core.shapes.solid_fit import SolidFit
from stereo_pick.core.shapes.table import Table
from stereo_pick.core.tables.lying_flat import WarpedViews
from stereo_pick.core.tables.raised import raised_m

_WELL_SEEN = 1 / 2  # of its silhouette and its creases, with less of which an object is in doubt
_SIGMAS = 2.0  # of the table as it was found
_HANGS = 0.5  # of its least size above the table, where a solid is mistaken rather than on top of something


def placed_surely(
    images: Images, seen: Sequence[Seen], exact: Sequence[SolidFit], before: Table | None, warped: WarpedViews | None
) -> list[Row]:
    """Where the solids are, and how sure that is, but what is astray as it was; exact: where their edges put them
    exactly; before: the table as it was found."""
    table = warped.table if warped else None
    fits = [each.fit for _, each in seen]
    moved_m = table_moved_m(fits, before, table)
    higher_m = raised_m(images, [each for _, each in seen], table) if table else np.zeros(len(seen))
    imaged_m = mirrored_m(images, fits, table.normal if table else None)
    placed = []
    for (row, each), exactly, by_m, up_m, image_m in zip(seen, exact, moved_m, higher_m, imaged_m):
        if each.is_astray:
            placed.append(row)
            continue
        (blobs, where), fit = row, each.fit
        doubt = _doubt(images, row, each, table, by_m, up_m) + np.outer(image_m, image_m)
        is_more = goes_on_beyond(blobs, fit, images)
        if is_more and warped and warped.is_surely_all_of(fit, blobs[0], fits):
            is_more = False
        if is_more or ends_within(blobs, fit, images):
            doubt = doubt + _off_its_outlines(blobs, fit, images.rig)
        placed.append((blobs, by_adjusted(images.rig, where, exactly, doubt)))
    return placed


def seen_in_part(row: Row, rig: StereoRig, table: Table | None) -> Row:
    """What no solid explains may be a lit top alone: its centre is anywhere within its width, or, if the table is
    nearer, within half its height above that."""
    blobs, where = row
    if where.fit is not None:
        return row
    away_m = depth_m(where, rig)
    within_m = max(blob.rectangle[1] for blob in blobs) * away_m / rig.focal_px
    if table is not None:
        centre_m = np.append(normalized(where.left_px, rig.left), 1.0) * away_m
        within_m = min(within_m, abs(float(table.height_m(centre_m))))
    return blobs, replace(where, covariance=where.covariance + within_m**2 / 12 * np.eye(3))


def _doubt(images: Images, row: Row, found: Adjusted, table: Table | None, moved_m: float, up_m: float) -> Floats:
    """Covariance (3, 3) [m²] of a solid's centre as it may be another solid; moved_m: by how much the table below it
    may be mistaken; up_m: how high above that it may stand."""
    (_, where), fit = row, found.fit
    doubt = where.doubt
    if table is not None:
        if _hangs_whole(found, table):
            doubt = np.zeros((3, 3))  # that of standing there
        off_m = _ahead_m(fit, table, images.rig, moved_m)
        doubt = doubt + _as_if_it_stood(found, table, images.rig) + float(off_m @ off_m) * np.eye(3)
        doubt = doubt + (up_m / 2) ** 2 * np.outer(table.normal, table.normal)
    if _may_be_longer(found, table):
        doubt = doubt + of_size(fit)
    if _may_be_a_side(found, table) or _may_be_a_dome(found, table):
        doubt = doubt + of_thickness(fit)
    if _may_be_a_streak(found, table):
        doubt = doubt + (float(fit.size_m.max()) / 2) ** 2 * np.eye(3)
    return doubt


def table_moved_m(fits: Sequence[SolidFit], before: Table | None, after: Table | None) -> Floats:
    """How far (N,) [m] all edges together moved the table below each solid, if that is anywhere more than how it was
    found admits: somebody is mistaken then, and draws the others along."""
    if before is None or after is None or not fits:
        return np.zeros(len(fits))
    centres_m = np.array([fit.centre_m for fit in fits])
    moved_m = after.height_m(centres_m) - before.height_m(centres_m)
    away_m = np.linalg.norm(centres_m - centres_m.mean(axis=0), axis=1)
    admitted_m = _SIGMAS * np.hypot(before.sigma_m, before.tilt_rad * away_m)
    return moved_m if (np.abs(moved_m) > admitted_m).any() else np.zeros(len(fits))


def _may_be_longer(found: Adjusted, table: Table | None) -> bool:
    """Whether much of its edges does not show; or, without a table, some: it may go on to the end of its shadow."""
    if found.may_be_another or (found.shown < WELL_SHOWN and table is None):
        return True
    is_in_doubt = isinstance(KINDS[found.fit.kind], Prism) or found.shown < WELL_SHOWN
    return is_in_doubt and found.shown * found.creased < _WELL_SEEN


def _may_be_a_streak(found: Adjusted, table: Table | None) -> bool:
    """Whether a rod may be light that mirrors along a thicker one: no table, and not all of its edges, are there to
    tell."""
    return table is None and found.shown < WELL_SHOWN and found.fit.flatness < BODY


def _may_be_a_side(found: Adjusted, table: Table | None) -> bool:
    """Whether nothing tells how far away a solid is that lacks its creases, but as much of its silhouette as shows; or,
    however much that is, of a cylinder whose ends are not seen: that of a box may be as that."""
    if table is not None:
        return False
    hides_its_ends = found.fit.kind == CYLINDER.name and not found.has_creases
    return hides_its_ends or (found.shown < WELL_SHOWN and not found.is_creased)


def _may_be_a_dome(found: Adjusted, table: Table | None) -> bool:
    """Whether it is seen as a cylinder that stands, or without a table more of its end than of its side, but the rim of
    its top does not show: that may be rounded, as it is hardly ever as bright as the side."""
    fit = found.fit
    if fit.kind != CYLINDER.name or not found.has_creases or found.creased >= _WELL_SEEN:
        return False
    axis = fit.rotation[:, 2]
    if table is None:
        return bool(abs(axis @ fit.centre_m) > np.sqrt(0.5) * np.linalg.norm(fit.centre_m))
    return bool(abs(axis @ table.normal) > np.sqrt(1 - ANGLE**2))


def _as_if_it_stood(found: Adjusted, table: Table, rig: StereoRig) -> Floats:
    """Covariance (3, 3) [m²] from where it hangs above the table to where another solid that is seen alike would stand.

    Nothing hangs in the air. What lies on something else shows by its creases what it is, and is higher up than a part
    of its own size, or shows nearly all of itself; a ball, which has none, is believed if it is that high.
    """
    fit = found.fit
    height_m = float(table.under(fit.solid)[0][0])
    if stands_on(table, fit) or height_m < 0:
        return np.zeros((3, 3))
    if _hangs_whole(found, table) or (height_m > _HANGS * float(fit.size_m.min()) and found.is_creased):
        return np.zeros((3, 3))
    down_m = _ahead_m(fit, table, rig, -height_m)
    return np.outer(down_m, down_m) / 4 + of_size(fit)


def _hangs_whole(found: Adjusted, table: Table) -> bool:
    """Whether a solid hangs clear of the table and shows its creases, and so much of its silhouette, that nothing that
    stands there is seen alike."""
    return found.shows_creases and found.shown > WELL_SHOWN and hangs_clear(table, found.fit)


def _ahead_m(fit: SolidFit, table: Table, rig: StereoRig, higher_m: float) -> Floats:
    """The way (3,) [m] along which a solid is seen alike, as long as it leads so much higher."""
    ahead = fit.centre_m - rig.eyes_m.mean(axis=0)
    return np.asarray(ahead * higher_m / float(table.normal @ ahead))


def _off_its_outlines(blobs: BlobPair, fit: SolidFit, rig: StereoRig) -> Floats:
    """Covariance (3, 3) [m²] of the centre of what may have that of its outlines as well as the solid's."""
    per_px = float(fit.centre_m[2]) / rig.focal_px
    own = fit.centre_px(rig.left), fit.centre_px(rig.right)
    off_px = [np.linalg.norm(seen - px) for seen, px in zip(centres_by_outlines_px(rig, blobs, fit), own)]
    return np.asarray((max(off_px) * per_px) ** 2 * np.eye(3))
