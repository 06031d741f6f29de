"""What touches an object in both views and is refused: another part, or more of the same one, of a shape unknown here.

An angle bracket looks like a box and something else that touches it, or like two boxes, which are flush then; a bottle
looks like a cylinder with something on it, a step like two on one axis.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import cv2
import numpy as np

from stereo_pick.core.arrays import Floats
from stereo_pick.core.camera import Camera
from stereo_pick.core.doubts.below_face import bodies_below
from stereo_pick.core.doubts.beyond_solid import outline_inside_px
from stereo_pick.core.doubts.coaxial import are_coaxial
from stereo_pick.core.doubts.flush_boxes import are_flush, moved_m
from stereo_pick.core.matches.left_over import Unread
from stereo_pick.core.objects import Blob
from stereo_pick.core.objects.beside import BESIDE_PX, are_beside
from stereo_pick.core.places.position import BlobPair, Located, Row, of_size
from stereo_pick.core.rig import StereoRig
from stereo_pick.core.shapes.kinds import SPHERE
from stereo_pick.core.shapes.solid_fit import SolidFit
from stereo_pick.core.tables.lying_flat import WarpedViews

_SHADE = "beside_bright"
_CUT = "cut_by_border"
_HARDLY = 1 / 4  # of its least size, one sigma


def as_unsure_as_whole(
    rows: Sequence[Row],
    unsure: Sequence[Row],
    unread: Sequence[Unread],
    rig: StereoRig,
    warped: WarpedViews | None,
) -> list[Row]:
    """The same, each as unsure as its centre would move if what touches it and is refused, or is flush with it, sure or
    unsure, were a piece of it; and where two parts were cut apart, and one is none, the other may end elsewhere.
    warped: what lies there, and so is no piece of what stands there."""
    others = [each.pair for each in unread if each.pair and each.reason != _SHADE]
    others += _alone_on_same_rows([each for each in unread if each.reason not in (_SHADE, _CUT)])
    fits = [where.fit for _, where in rows if where.fit]

    def lies_flat(pair: BlobPair, fit: SolidFit) -> bool:
        if warped is None:
            return False
        return warped.is_surely_all_of(fit, pair[0], fits) or warped.is_surely_all_beside(fit, pair[0], fits)

    up = warped.table.normal if warped else None
    both = [_or_both(row, rows, unsure, up) for row in rows]
    return [_as_unsure(row, [*others, *_below_faces(row, unread, rig)], rig, lies_flat) for row in both]


def _below_faces(row: Row, unread: Sequence[Unread], rig: StereoRig) -> list[BlobPair]:
    fit = row[1].fit
    if fit is None or fit.kind == SPHERE.name:  # a ball is no piece of another
        return []
    return bodies_below(unread, fit, rig)


def _alone_on_same_rows(unread: Sequence[Unread]) -> list[BlobPair]:
    """What one view alone shows, with all that the other alone shows on the same rows: outlines of one thing that are
    too different to be matched."""
    left_only = [each.left for each in unread if each.left and not each.right]
    right_only = [each.right for each in unread if each.right and not each.left]
    return [(left, right) for left in left_only for right in right_only if _on_same_rows(left, right)]


def _on_same_rows(one: Blob, other: Blob) -> bool:
    (top, bottom), (other_top, other_bottom) = one.rows_px, other.rows_px
    return top < other_bottom and other_top < bottom


def _or_both(row: Row, sure: Sequence[Row], unsure: Sequence[Row], up: Floats | None) -> Row:
    """The same, which may be one with another box that touches it, or with what has the same axis; or, where no table
    tells which way is up, with what is anywhere on its axis, or touches it and is hardly known. What is so unsure that
    it is refused counts elsewhere."""
    blobs, where = row
    fit, off_m = where.fit, [0.0]
    for pair, other in [*sure, *unsure]:
        if fit is None or other.fit is None or other.fit is fit:
            continue
        open_m = float(np.sqrt(np.linalg.eigvalsh(where.covariance + other.covariance).max()))
        touch = _touch(blobs, pair)
        upright = fit.rotation[:, 2] if up is None else up
        is_one = are_coaxial(fit, other.fit, upright, open_m) or are_flush(fit, other.fit, touch=touch, open_m=open_m)
        may_be_one = up is None and touch and _is_hardly_known(other) and any(other is each for _, each in sure)
        if is_one or may_be_one:
            off_m.append(moved_m(fit, other.fit))
    return blobs, replace(where, covariance=where.covariance + max(off_m) ** 2 * np.eye(3))


def _is_hardly_known(where: Located) -> bool:
    """Whether a solid may be about anywhere within its thickness: it may be another, and this a piece of it."""
    sigma_m = float(np.sqrt(np.linalg.eigvalsh(where.covariance).max()))
    return where.fit is not None and sigma_m > _HARDLY * float(where.fit.size_m.min())


def _touch(one: BlobPair, other: BlobPair) -> bool:
    """Whether two objects touch in both views."""
    return all(are_beside(*each) for each in zip(one, other))


def _as_unsure(
    row: Row, others: Sequence[BlobPair], rig: StereoRig, lies_flat: Callable[[BlobPair, SolidFit], bool]
) -> Row:
    blobs, where = row
    if where.fit is None:
        return row
    touching = [pair for pair in others if _touches(blobs, where.fit, pair, rig) and not lies_flat(pair, where.fit)]
    if not touching:
        return row
    off_px = max(_moved_px(where.fit, pair, rig) for pair in touching)
    if off_px == 0:  # the solid covers all of it
        return row
    off_m = off_px * float(where.fit.centre_m[2]) / rig.focal_px
    return blobs, replace(where, covariance=where.covariance + off_m**2 * np.eye(3) + of_size(where.fit))


def _touches(blobs: BlobPair, fit: SolidFit, other: BlobPair, rig: StereoRig) -> bool:
    """Whether another object touches this one in both views; in one of them that may be the solid, of which an outline
    may lack a face."""
    beside = [are_beside(*each) for each in zip(blobs, other)]
    sides = zip(beside, other, (rig.left, rig.right), fit.silhouettes(rig))
    return any(beside) and all(
        touches or bool(outline_inside_px(blob, camera, polygon).max() > -BESIDE_PX)
        for touches, blob, camera, polygon in sides
    )


def _moved_px(fit: SolidFit, pair: BlobPair, rig: StereoRig) -> float:
    """How far the centroid of the solid and the other [px] is from that of the solid alone: the least of both views."""
    cameras = rig.left, rig.right
    return min(_off_px(fit.silhouette_px(camera), other.contour_px, camera) for camera, other in zip(cameras, pair))


def _off_px(outline: Floats, more: Floats, camera: Camera) -> float:
    width, height = camera.frame_size
    covered = np.zeros((height, width), np.uint8)
    centroids = []
    for polygon in (outline, more):
        within = np.clip(np.round(polygon), 0, (width - 1, height - 1)).astype(np.int32)
        cv2.fillPoly(covered, [within], 1)
        moments = cv2.moments(covered, binaryImage=True)
        centroids.append(np.array([moments["m10"], moments["m01"]]) / moments["m00"])
    return float(np.linalg.norm(centroids[1] - centroids[0]))
