"""Prints among what was taken for solids: nothing shows that they stand up.

Looked down at, a bar of print has the outlines of a lying cylinder, and a round label those of a ball.
"""

from __future__ import annotations

from collections.abc import Sequence

import cv2
import numpy as np

from stereo_pick.core.camera import Camera
from stereo_pick.core.objects import Blob
from stereo_pick.core.places.located import ends_sharply, refused_as
from stereo_pick.core.places.one_plane import FACING, FLAT_PX, Sides, common_plane, height_m, plane_with
from stereo_pick.core.places.position import BlobPair, Located, Row
from stereo_pick.core.rig import StereoRig
from stereo_pick.core.shapes.common_normal import common_normal
from stereo_pick.core.shapes.common_table import common_table, stands_on, surely_on
from stereo_pick.core.shapes.faces import face_areas_px2
from stereo_pick.core.shapes.kinds import SPHERE
from stereo_pick.core.shapes.solid_fit import SolidFit
from stereo_pick.core.shapes.table import Table

_ALIKE = 0.1  # by this part an outline may be larger or smaller than the face it is ...
_ALL = 0.85  # ... which is less than this part of the solid's silhouette
_LEAST_LEVEL = 2
_TRIED = 5  # of the largest, whose plane others may share
_LIES = 0.25  # of its own height above the table, up to which what may be flat rather lies on it ...
_SIGMAS = 2  # ... and by which the table's height is not sure

Outlined = tuple[Row, Sides]


def prints_among(
    rows: Sequence[Row], rig: StereoRig, table: Table | None, is_known: bool, refused: Sequence[BlobPair] = ()
) -> list[Row]:
    """Those that may be prints, or the lit top of something that shows nothing else.

    table: what the objects stand on, and prints lie on; is_known: whether it is known without them. A table that only
    prints speak for is none: all of them lie on another, higher up. refused: others that are flat.
    """
    flat = [(row, Sides.of(*row[0], rig)) for row in rows if _may_be_flat(*row, rig)]
    if table is None:
        others = [(row, Sides.of(*row[0], rig)) for row in rows if not any(row is each for each, _ in flat)]
        return [row for row, _ in _without_a_table(flat, others)]
    level = [each for each in flat if _on_one_plane([each])]
    if not is_known and _speak_alone(level, rows):
        return [row for row, _ in level]
    shown = None if is_known else _that_others_show(rows, flat)
    below = [] if is_known or shown else _below_all_others(rows, flat, rig, refused)
    return [each[0] for each in flat if each in below or _is_level(shown or table, each, rig)]


def _speak_alone(level: Sequence[Outlined], rows: Sequence[Row]) -> bool:
    """Whether these lie on one plane, and no other solid says where a table is."""
    if not level or not _on_one_plane(level):
        return False
    return all(row[1].fit is None or any(row is each for each, _ in level) for row in rows)


def _that_others_show(rows: Sequence[Row], flat: Sequence[Outlined]) -> Table | None:
    """The table as those show it that stand up: what may lie on it has put it where it would stand itself."""
    may_lie = [row for row, _ in flat]
    return common_table([row[1].fit for row in rows if not any(row is each for each in may_lie)])


def _below_all_others(
    rows: Sequence[Row], flat: Sequence[Outlined], rig: StereoRig, refused: Sequence[BlobPair]
) -> list[Outlined]:
    """Those that lie on one plane, with what is refused perhaps, on which all others stand, of which balls alone would
    not do: if they were objects themselves the others would have to stand lower."""
    lying = [((pair, refused_as(pair, "flat")), Sides.of(*pair, rig)) for pair in refused]
    level = _most_on_one_plane([each for each in [*flat, *lying] if _on_one_plane([each])])
    fits = [row[1].fit for row in rows if row[1].fit is not None and not any(row is each for each, _ in level)]
    if len(level) < _LEAST_LEVEL or all(fit.kind == SPHERE.name for fit in fits):
        return []
    several = [sides for _, sides in level]
    below = [_plane_below(fit, several, rig) for fit in fits]
    return level if all(stands_on(*each) and surely_on(*each) for each in zip(below, fits)) else []


def _plane_below(fit: SolidFit, several: Sequence[Sides], rig: StereoRig) -> Table:
    """The plane that is nearest to all of these outlines, as sure below a solid as they lie on it."""
    plane = common_plane(several)
    away_m = rig.baseline_m / float(np.linalg.norm(plane))
    terms = np.concatenate([sides.terms * np.sqrt(sides.weight)[:, None] for sides in several])
    there = fit.centre_m / fit.centre_m[2] * rig.focal_px
    off_px = max(sides.off_px(plane) for sides in several)
    sigma_px = off_px * float(np.sqrt(there @ np.linalg.inv(terms.T @ terms) @ there))
    sigma_m = sigma_px * float(fit.centre_m[2]) ** 2 / (rig.focal_px * rig.baseline_m)
    return Table(-plane * away_m / rig.baseline_m, away_m, sigma_m)


def _without_a_table(flat: Sequence[Outlined], others: Sequence[Outlined]) -> list[Outlined]:
    """Those that lie on what may be a table, as the others stand, and what else is printed there.

    From wherever it is seen, a ball's outline lies on a plane, which is its own: balls are believed where there are
    others, and none of these is on the same.
    """
    every = [*flat, *others]
    level = [each for each in flat if _on_one_plane([each])]
    upright = common_normal([each[0][1].fit for each in every if each not in level])
    if upright is not None:
        level = [(row, sides) for row, sides in level if sides.off_px(plane_with(upright, sides)) < FLAT_PX]
    prints = [each for each in level if len(every) == 1 or not _is_ball(each[0][1])]
    together = _most_on_one_plane(level)
    if len(together) > 1:
        prints += [each for each in every if each not in prints and _on_one_plane([*together, each])]
    return prints


def _is_ball(where: Located) -> bool:
    return where.fit is not None and where.fit.kind == SPHERE.name


def _most_on_one_plane(flat: Sequence[Outlined]) -> list[Outlined]:
    """The most of them that lie on the plane of one of the largest."""
    by_size = sorted(flat, key=lambda each: -each[0][0][0].area_px2)
    found: list[list[Outlined]] = []
    for first in by_size[:_TRIED]:
        group = [first]
        for other in by_size:
            if other is not first and _on_one_plane([*group, other]):
                group.append(other)
        found.append(group)
    return max(found, key=len, default=[])


def _may_be_flat(blobs: BlobPair, where: Located, rig: StereoRig) -> bool:
    """Whether one outline is sharp, and they are not one face of a solid that shows more."""
    if not any(ends_sharply(blob) for blob in blobs):
        return False
    return where.fit is None or not _is_a_face_of(blobs, where.fit, rig, _ALL)


def _is_a_face_of(blobs: BlobPair, fit: SolidFit, rig: StereoRig, most: float = np.inf) -> bool:
    """Whether outlines are as large as one of the faces that is seen of a solid, which is less than this part of all
    that is."""
    return all(_is_one_face(*each, fit, most) for each in zip(blobs, (rig.left, rig.right)))


def _is_one_face(blob: Blob, camera: Camera, fit: SolidFit, most: float) -> bool:
    faces_px2 = face_areas_px2(fit, camera)
    of_all = float(cv2.contourArea(fit.silhouette_px(camera).astype(np.float32)))
    alike = faces_px2[np.abs(faces_px2 / blob.area_px2 - 1) < _ALIKE]
    return bool((alike < most * of_all).any())


def _on_one_plane(several: Sequence[Outlined]) -> bool:
    outlines = [sides for _, sides in several]
    plane = common_plane(outlines)
    return all(each.off_px(plane) < FLAT_PX for each in outlines)


def _is_level(table: Table, flat: Outlined, rig: StereoRig) -> bool:
    """Whether outlines that may be flat lie along the table: on it, or above it as no face of the solid.

    On it is what is nearer to it than the middle of the solid would be. What is above it must be seen obliquely: from
    above, the outlines of round bodies are level, too.
    """
    (blobs, where), sides = flat
    fit = where.fit
    plane = plane_with(table.normal, sides)
    if sides.off_px(plane) > FLAT_PX:
        return False
    own_m = fit.reach_m(table.normal) + fit.reach_m(-table.normal) if fit else 0.0
    if abs(height_m(plane, table, rig)) < _LIES * own_m + _SIGMAS * table.sigma_m:
        return True
    ahead = sides.terms.mean(axis=0)
    is_oblique = abs(float(ahead @ table.normal)) < FACING * float(np.linalg.norm(ahead))
    return is_oblique and (fit is None or not _is_a_face_of(blobs, fit, rig))
