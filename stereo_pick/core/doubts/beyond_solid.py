"""Whether outlines show more than a solid: they have edges clear of its silhouette."""

from __future__ import annotations

import numpy as np

from stereo_pick.core.arrays import Floats
from stereo_pick.core.camera import Camera
from stereo_pick.core.edges.creases import crease_points_m
from stereo_pick.core.edges.hypotheses import Images
from stereo_pick.core.matches.left_over import Unread
from stereo_pick.core.objects import Blob
from stereo_pick.core.objects.blob import SHARP
from stereo_pick.core.places.overlap import covers
from stereo_pick.core.places.position import BlobPair
from stereo_pick.core.shapes.kinds import KINDS, Prism
from stereo_pick.core.shapes.predicted import inside
from stereo_pick.core.shapes.sight import normalized, seen_px
from stereo_pick.core.shapes.solid_fit import SolidFit

_MORE = 0.05  # of an outline, sharp and clear of the solid, from which the object is more than that ...
_CLEAR_PX = 3.0  # ... by so much
_WITHIN_PX = 4.0  # its silhouette, and clear of its creases
_TO_CORNER = 2.5  # from the last point on a crease, in distances of two of them


def goes_on_beyond(blobs: BlobPair, fit: SolidFit, images: Images) -> bool:
    """Whether the object of these outlines seems to be more than the solid."""
    polygons = fit.silhouettes(images.rig)
    cameras = images.rig.left, images.rig.right
    return any(_shows_more(*each) for each in zip(blobs, cameras, polygons))


def ends_within(blobs: BlobPair, fit: SolidFit, images: Images) -> bool:
    """Whether the outlines of both views end, sharp, in the middle of the solid's flat faces: as an angle's do, which a
    box around it explains but for its notch. On round ones light ends there as well."""
    rig = images.rig
    if not isinstance(KINDS[fit.kind], Prism):
        return False
    sides = zip(blobs, (rig.left, rig.right), fit.silhouettes(rig), rig.eyes_m)
    return all(_share_within(blob, camera, polygon, fit, eye_m) > _MORE for blob, camera, polygon, eye_m in sides)


def _share_within(blob: Blob, camera: Camera, polygon: Floats, fit: SolidFit, eye_m: Floats) -> float:
    """The part of an outline that does."""
    if not len(blob.sharpness):
        return 0.0
    inside_px = outline_inside_px(blob, camera, polygon)
    ends = (inside_px > _WITHIN_PX) & (blob.sharpness >= SHARP)
    for crease_m in crease_points_m(fit.solid, eye_m):
        crease_px = seen_px(crease_m, camera)
        apart_px = float(np.linalg.norm(np.diff(crease_px, axis=0), axis=1).max())
        away_px = np.linalg.norm(blob.contour_px[:, None] - crease_px, axis=2).min(axis=1)
        ends &= away_px > _WITHIN_PX + _TO_CORNER * apart_px
    return float(ends.mean())


def is_seen_alone(unread: Unread, fit: SolidFit, images: Images) -> bool:
    """Whether what one view alone shows is the solid, and nothing more."""
    return _is_more(unread, fit, images) is False


def is_seen_to_be_more(unread: Unread, fit: SolidFit, images: Images) -> bool:
    """Whether one view alone shows that the solid is a piece of something."""
    blob = unread.alone
    return blob is not None and not blob.fault and _is_more(unread, fit, images) is True


def _is_more(unread: Unread, fit: SolidFit, images: Images) -> bool | None:
    """Whether what one view alone shows is more than the solid; None where it is something else."""
    blob = unread.alone
    if blob is None:
        return None
    side = 0 if unread.left else 1
    camera, polygon = (images.rig.left, images.rig.right)[side], fit.silhouettes(images.rig)[side]
    return _shows_more(blob, camera, polygon) if covers(fit, blob.centroid_px, camera) else None


def is_part_of(unread: Unread, fit: SolidFit, images: Images) -> bool:
    """Whether what is refused is a piece of the solid, or all of it, and nothing more."""
    if unread.left is None or unread.right is None:
        return is_seen_alone(unread, fit, images)
    middle_px = unread.left.centroid_px
    return covers(fit, middle_px, images.rig.left) and not goes_on_beyond((unread.left, unread.right), fit, images)


def _shows_more(blob: Blob, camera: Camera, polygon: Floats) -> bool:
    """Whether part of an outline is sharp, as far as that was measured, and lies clear of a silhouette (K, 2),
    normalized."""
    inside_px = outline_inside_px(blob, camera, polygon)
    is_sharp = blob.sharpness >= SHARP if len(blob.sharpness) else np.ones(len(inside_px), bool)
    return float(((inside_px < -_CLEAR_PX) & is_sharp).mean()) > _MORE


def outline_inside_px(blob: Blob, camera: Camera, polygon: Floats) -> Floats:
    """How far (N,) [px] an outline lies inside a silhouette (K, 2), normalized; less than 0 outside."""
    return np.asarray(inside(normalized(blob.contour_px, camera)[None], polygon[None])[0] * camera.P[0, 0], np.float64)
