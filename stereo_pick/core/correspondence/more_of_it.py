"""What touches an object in both views and is refused: another part, or more of the same one, of a shape unknown here.

An angle bracket looks like a box and something else that touches it, a bottle like a cylinder with something on it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from stereo_pick.core.arrays import Floats
from stereo_pick.core.camera import Camera
from stereo_pick.core.correspondence.left_over import Unread
from stereo_pick.core.correspondence.position import Row
from stereo_pick.core.objects import Blob
from stereo_pick.core.objects.beside import are_beside
from stereo_pick.core.rig import StereoRig
from stereo_pick.core.shapes.predicted import inside, silhouettes
from stereo_pick.core.shapes.sight import normalized
from stereo_pick.core.shapes.solid_fit import SolidFit

_TOUCHES_PX = 2.0
_SHADE = "beside_bright"
_OUTSIDE = 0.5  # of its outline, from which it is not a piece of what the solid explains


def as_unsure_as_whole(rows: Sequence[Row], unread: Sequence[Unread], rig: StereoRig) -> list[Row]:
    """The same, each as unsure as its centre would move if what touches it and is refused were a piece of it."""
    others = [each for each in unread if each.reason != _SHADE]
    return [_as_unsure(row, others, rig) for row in rows]


def _as_unsure(row: Row, unread: Sequence[Unread], rig: StereoRig) -> Row:
    (left, right), where = row
    touching = [each for each in unread if _touch(left, each.left) and _touch(right, each.right)]
    if where.fit is None or not touching:
        return row
    off_px = max(_moved_px(row, each, where.fit, rig) for each in touching)
    off_m = off_px * float(where.fit.centre_m[2]) / rig.focal_px
    return (left, right), replace(where, covariance=where.covariance + off_m**2 * np.eye(3))


def _touch(blob: Blob, other: Blob | None) -> bool:
    return other is not None and are_beside(blob, other, _TOUCHES_PX)


def _moved_px(row: Row, other: Unread, fit: SolidFit, rig: StereoRig) -> float:
    """By how much the centre of the outlines [px] moves with the other's, if that lies outside of the solid."""
    moved_px = []
    for blob, more, camera, outline in zip(
        row[0], other[1:], (rig.left, rig.right), silhouettes(fit.solid, rig.eyes_m)[0]
    ):
        if more is None or not _is_outside(more, camera, outline):
            return 0.0
        share = more.area_px2 / (blob.area_px2 + more.area_px2)
        moved_px.append(share * float(np.linalg.norm(more.centroid_px - blob.centroid_px)))
    return max(moved_px)


def _is_outside(blob: Blob, camera: Camera, outline: Floats) -> bool:
    is_inside = inside(normalized(blob.contour_px, camera)[None], outline[None])[0]
    return float((is_inside < 0).mean()) > _OUTSIDE
