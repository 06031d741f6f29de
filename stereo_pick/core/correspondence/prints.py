"""Prints among what was taken for solids: nothing shows that they stand up.

Looked down at, a bar of print has the outlines of a lying cylinder, and a round label those of a ball.
"""

from __future__ import annotations

from collections.abc import Sequence

import cv2
import numpy as np

from stereo_pick.core.camera import Camera
from stereo_pick.core.correspondence.one_plane import FLAT_PX, Sides, common_plane, height_above
from stereo_pick.core.correspondence.position import BlobPair, Located, Row
from stereo_pick.core.objects import Blob
from stereo_pick.core.rig import StereoRig
from stereo_pick.core.shapes.common_normal import common_normal
from stereo_pick.core.shapes.faces import face_areas_px2
from stereo_pick.core.shapes.solid_fit import SolidFit
from stereo_pick.core.shapes.table import Table

_ALIKE = 0.1  # by this part an outline may be larger or smaller than the face it is ...
_ALL = 0.85  # ... which is less than this part of the solid's silhouette
_SHARP = 0.75  # of an outline: the light on a round body fades towards it, that on a print ends there
_TELL_A_PLANE = 2  # prints, which tell how it lies
_LIES = 0.25  # of its own height above the table, up to which what may be flat rather lies on it ...
_SIGMAS = 2  # ... and by which the table's height is not sure
_FROM_ABOVE = np.cos(np.deg2rad(20))

Outlined = tuple[Row, Sides]


def prints_among(rows: Sequence[Row], rig: StereoRig, table: Table | None, is_known: bool) -> list[Row]:
    """Those that may be prints, or the lit top of something that shows nothing else.

    table: what the objects stand on, and prints lie on; is_known: whether it is known without them. A table that only
    prints speak for is none: all of them lie on another, higher up.
    """
    every = [(row, Sides.of(*row[0], rig)) for row in rows]
    flat = [(row, sides) for row, sides in every if _may_be_flat(*row, rig)]
    if table is None:
        return [row for row, _ in _without_a_table(every, flat, rig)]
    if not is_known and 0 < len(flat) == len(rows) and _on_one_plane(flat):
        return list(rows)
    return [each[0] for each in flat if _is_level(table, each, rig)]


def _without_a_table(every: Sequence[Outlined], flat: Sequence[Outlined], rig: StereoRig) -> list[Outlined]:
    """Those that lie on what may be a table, as the others stand; and what else is printed on that of several."""
    prints = [each for each in flat if _on_one_plane([each])]
    upright = common_normal([each[0][1].fit for each in every if each not in prints])
    if upright is not None:
        level = Table(upright, 1.0, np.inf)
        prints = [each for each in prints if height_above(level, each[1], rig)[1] < FLAT_PX]
    if len(prints) < _TELL_A_PLANE:
        return prints
    return [each for each in every if each in prints or _on_one_plane([*prints, each])]


def _may_be_flat(blobs: BlobPair, where: Located, rig: StereoRig) -> bool:
    """Whether an outline is sharp, and they are not those of one face of a solid that has others."""
    if not any(len(blob.sharpness) and float(np.median(blob.sharpness)) > _SHARP for blob in blobs):
        return False
    return where.fit is None or not _is_a_face_of(blobs, where.fit, rig, _ALL)


def _is_a_face_of(blobs: BlobPair, fit: SolidFit, rig: StereoRig, most: float = 1.0) -> bool:
    """Whether outlines are as large as one of the faces that is seen of a solid, which is no more than this part of all
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
    """Whether outlines that may be flat are as level as the table, and on it, or no face of what stands there.

    On it is what is nearer to it than the middle of the solid would be. The outlines of round bodies face the cameras:
    that they are level is no chance only where they are seen from above.
    """
    (blobs, where), sides = flat
    fit = where.fit
    above_m, off_px = height_above(table, sides, rig)
    if off_px > FLAT_PX:
        return False
    own_m = fit.reach_m(table.normal) + fit.reach_m(-table.normal) if fit else 0.0
    if abs(above_m) < _LIES * own_m + _SIGMAS * table.sigma_m:
        return True
    ahead = sides.terms.mean(axis=0)
    is_oblique = abs(float(ahead @ table.normal)) < _FROM_ABOVE * float(np.linalg.norm(ahead))
    return is_oblique and (fit is None or not _is_a_face_of(blobs, fit, rig))
