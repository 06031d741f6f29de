"""What may stand below a flat face that is refused: it may be the lit top of something of which nothing else shows."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from stereo_pick.core.matches.left_over import Unread
from stereo_pick.core.objects import Blob
from stereo_pick.core.places.position import BlobPair
from stereo_pick.core.rig import StereoRig
from stereo_pick.core.shapes.common_normal import across
from stereo_pick.core.shapes.kinds import BOX
from stereo_pick.core.shapes.predicted import along_polygon
from stereo_pick.core.shapes.solid_fit import SolidFit

_POINTS = 200  # along an outline


def bodies_below(refused: Sequence[Unread], beside: SolidFit, rig: StereoRig) -> list[BlobPair]:
    """The outlines of what would reach from faces, that are refused as flat, down to where a solid beside them ends."""
    faces = [(each.fit, each.pair) for each in refused if each.reason == "flat" and each.fit and each.pair]
    return [
        (_drawn(body, left, rig, 0), _drawn(body, right, rig, 1))
        for fit, (left, right) in faces
        if (body := _down_to_end_of(beside, fit)) is not None
    ]


def _down_to_end_of(beside: SolidFit, face: SolidFit) -> SolidFit | None:
    """A face as the top of a body that ends where a solid does; None where that does not end below it."""
    thin = int(face.size_m.argmin())
    if face.kind != BOX.name and thin != 2:  # a rod
        return None
    up = across(face)
    height_m = float(up @ (face.centre_m - beside.centre_m)) + beside.reach_m(-up)
    if height_m < face.size_m[thin]:
        return None
    size_m = np.where(np.arange(3) == thin, height_m, face.size_m)
    return replace(face, centre_m=face.centre_m - height_m / 2 * up, size_m=size_m)


def _drawn(body: SolidFit, face: Blob, rig: StereoRig, side: int) -> Blob:
    corners_px = body.silhouette_px((rig.left, rig.right)[side])
    (outline_px,), _ = along_polygon(corners_px[None], _POINTS)
    return replace(face, contour_px=outline_px, sharpness=np.zeros(0))
