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
from stereo_pick.core.shapes.faces import face_areas_px2
from stereo_pick.core.shapes.solid_fit import SolidFit
from stereo_pick.core.shapes.table import Table

_ALIKE = 0.1  # by this part an outline may be larger or smaller than the face it is ...
_ALL = 0.85  # ... which is less than this part of the solid's silhouette
_SHARP = 0.75  # of an outline: the light on a round body fades towards it, that on a print ends there
_TELL_A_PLANE = 2  # prints, which tell how it lies
_LIES = 0.25  # of its own height above the table, up to which what may be flat rather lies on it ...
_SIGMAS = 2  # ... and by which the table's height is not sure


def prints_among(rows: Sequence[Row], rig: StereoRig, table: Table | None, is_known: bool) -> list[Row]:
    """Those that may be prints.

    table: what the objects stand on, and prints lie on; is_known: whether it is known without them. A table that only
    prints speak for is none: all of them lie on another, higher up. Without a table a print may lie on any plane, and
    on that of two or more lies what else is printed there.
    """
    every = [(row, Sides.of(*row[0], rig)) for row in rows]
    flat = [(row, sides) for row, sides in every if _may_be_flat(*row, rig)]
    if table is None:
        prints = [each for each in flat if _on_one_plane([each])]
        if len(prints) >= _TELL_A_PLANE:
            prints = [each for each in every if each in prints or _on_one_plane([*prints, each])]
        return [row for row, _ in prints]
    if not is_known and 0 < len(flat) == len(rows) and _on_one_plane(flat):
        return list(rows)
    return [row for row, sides in flat if _lies_on(table, row[1].fit, sides, rig)]


def _may_be_flat(blobs: BlobPair, where: Located, rig: StereoRig) -> bool:
    """Whether an object's outline is sharp in a view, and the outlines are not those of one face of a solid with others."""
    if not any(len(blob.sharpness) and float(np.median(blob.sharpness)) > _SHARP for blob in blobs):
        return False
    return where.fit is None or not _is_a_face_of(blobs, where.fit, rig)


def _is_a_face_of(blobs: BlobPair, fit: SolidFit, rig: StereoRig) -> bool:
    return all(_is_one_face(*each, fit) for each in zip(blobs, (rig.left, rig.right)))


def _is_one_face(blob: Blob, camera: Camera, fit: SolidFit) -> bool:
    """Whether an outline is as large as one of the faces that a camera sees of a solid, which is not all it sees."""
    faces_px2 = face_areas_px2(fit, camera)
    of_all = float(cv2.contourArea(fit.silhouette_px(camera).astype(np.float32)))
    alike = faces_px2[np.abs(faces_px2 / blob.area_px2 - 1) < _ALIKE]
    return bool((alike < _ALL * of_all).any())


def _on_one_plane(several: Sequence[tuple[Row, Sides]]) -> bool:
    outlines = [sides for _, sides in several]
    plane = common_plane(outlines)
    return all(each.off_px(plane) < FLAT_PX for each in outlines)


def _lies_on(table: Table, fit: SolidFit | None, sides: Sides, rig: StereoRig) -> bool:
    """Whether outlines that may be flat lie nearer to the table than the middle of a solid on it; those of what has no
    solid were looked at before."""
    if fit is None:
        return False
    above_m, off_px = height_above(table, sides, rig)
    own_m = fit.reach_m(table.normal) + fit.reach_m(-table.normal)
    return off_px < FLAT_PX and abs(above_m) < _LIES * own_m + _SIGMAS * table.sigma_m
