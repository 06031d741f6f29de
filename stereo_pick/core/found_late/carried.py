"""An outline that one view shows, carried to where the other view would have it: it is taken to be half as high above
the table as it is wide.

The views often show different pieces of the same object, or one of them shows it together with another.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from stereo_pick.core.arrays import Floats
from stereo_pick.core.matches.left_over import Unread
from stereo_pick.core.objects import Blob
from stereo_pick.core.objects.blob import CUT
from stereo_pick.core.places.position import BlobPair
from stereo_pick.core.rig import StereoRig
from stereo_pick.core.shapes.sight import normalized
from stereo_pick.core.shapes.solid_fit import SolidFit
from stereo_pick.core.shapes.table import Table
from stereo_pick.core.shapes.transferred import transferred


def carried(unread: Unread, rig: StereoRig, table: Table) -> BlobPair | None:
    """What one view alone shows, and its outline in the other view, without edges; None where it does not lie on the
    table, or the other camera does not look there."""
    blob, own = unread.alone, 0 if unread.left else 1
    height_m = _height_m(blob, own, rig, table) if blob else None
    if blob is None or height_m is None:
        return None
    [contour_px] = transferred(blob.contour_px, np.array([height_m]), rig, own, table)
    other = without_edges(blob, contour_px)
    if not (other.centroid_px >= 0).all() or not (other.centroid_px < rig.left.frame_size).all():
        return None
    return (blob, other) if own == 0 else (other, blob)


def as_predicted(unread: Unread, blobs: BlobPair, fit: SolidFit, rig: StereoRig) -> BlobPair:
    """The same with the outline that was carried where the solid that was found there has it."""
    left, right = blobs
    if unread.left:
        return left, without_edges(right, fit.silhouette_px(rig.right))
    return without_edges(left, fit.silhouette_px(rig.left)), right


def own_outlines(blobs: BlobPair, fit: SolidFit, rig: StereoRig) -> BlobPair:
    """A solid's silhouettes, in place of outlines that are not its own alone."""
    left, right = blobs
    return without_edges(left, fit.silhouette_px(rig.left)), without_edges(right, fit.silhouette_px(rig.right))


def without_edges(blob: Blob, contour_px: Floats) -> Blob:
    """An outline (N, 2) that was not seen in the image, in the place of one that was."""
    return replace(blob, contour_px=contour_px, sharpness=np.full(len(contour_px), CUT))


def _height_m(blob: Blob, own: int, rig: StereoRig, table: Table) -> float | None:
    """How high above the table an outline is, half its width [m].

    None where it reaches beyond the table's horizon, or is as high as the camera.
    """
    camera = (rig.left, rig.right)[own]
    sinks = -(np.insert(normalized(blob.contour_px, camera), 2, 1.0, axis=1) @ table.normal)
    if sinks.min() <= 0:
        return None
    camera_m = float(table.height_m(rig.eyes_m[own]))
    height_m = blob.rectangle[1] / 2 * camera_m / float(np.median(sinks)) / rig.focal_px
    return height_m if height_m < camera_m else None
