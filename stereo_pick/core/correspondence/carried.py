"""An outline that one view shows, carried to where the other view would have it: it is about as high above the table
as it is wide.

The views often show different pieces of the same object, or one of them shows it together with another.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from stereo_pick.core.arrays import Floats
from stereo_pick.core.correspondence.left_over import Unread
from stereo_pick.core.correspondence.position import BlobPair
from stereo_pick.core.objects import Blob
from stereo_pick.core.objects.blob import CUT
from stereo_pick.core.rig import StereoRig
from stereo_pick.core.shapes.sight import normalized
from stereo_pick.core.shapes.solid_fit import SolidFit
from stereo_pick.core.shapes.table import Table


def carried(unread: Unread, rig: StereoRig, table: Table) -> BlobPair | None:
    """What one view alone shows, and its outline in the other view, without edges; None where it does not lie on the
    table, or the other camera does not look there."""
    blob = unread.alone
    points_m = None if blob is None else _above_table(blob, 0 if unread.left else 1, rig, table)
    if blob is None or points_m is None:
        return None
    camera, eye_m = (rig.right, rig.eyes_m[1]) if unread.left else (rig.left, rig.eyes_m[0])
    there_m = points_m - eye_m
    other = _without_edges(blob, there_m[:, :2] / there_m[:, 2:] * rig.focal_px + camera.P[:2, 2])
    if not (other.centroid_px >= 0).all() or not (other.centroid_px < camera.frame_size).all():
        return None
    return (blob, other) if unread.left else (other, blob)


def as_predicted(unread: Unread, blobs: BlobPair, fit: SolidFit, rig: StereoRig) -> BlobPair:
    """The same with the outline that was carried where the solid that was found there has it."""
    left, right = blobs
    if unread.left:
        return left, _without_edges(right, fit.silhouette_px(rig.right))
    return _without_edges(left, fit.silhouette_px(rig.left)), right


def _without_edges(blob: Blob, contour_px: Floats) -> Blob:
    return replace(blob, contour_px=contour_px, sharpness=np.full(len(contour_px), CUT))


def _above_table(blob: Blob, side: int, rig: StereoRig, table: Table) -> Floats | None:
    """The points (N, 3) [m] of an outline, half its width above the table; None where that is beyond its horizon, or
    as high as the camera."""
    camera, eye_m = (rig.left, rig.right)[side], rig.eyes_m[side]
    rays = np.append(normalized(blob.contour_px, camera), np.ones((len(blob.contour_px), 1)), axis=1)
    sinks = -rays @ table.normal
    if sinks.min() <= 0:
        return None
    eye_up_m = float(table.height_m(eye_m))
    m_per_px = eye_up_m / float(np.median(sinks)) / rig.focal_px
    up_m = blob.rectangle[1] / 2 * m_per_px
    if up_m >= eye_up_m:
        return None
    return np.asarray(eye_m + rays * ((eye_up_m - up_m) / sinks)[:, None])
