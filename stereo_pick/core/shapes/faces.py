"""The flat faces of a solid, as a camera sees them: light that falls on one of them only shows that one."""

from __future__ import annotations

import cv2
import numpy as np

from stereo_pick.core.arrays import Floats
from stereo_pick.core.camera import Camera
from stereo_pick.core.shapes.kinds import CYLINDER, KINDS, Prism
from stereo_pick.core.shapes.sight import seen_px
from stereo_pick.core.shapes.solid_fit import SolidFit

_RIM = 48  # points on a round one
_ON_IT = 1e-4


def face_areas_px2(fit: SolidFit, camera: Camera) -> Floats:
    """Areas (F,) [px²] of the faces that a rectified camera sees; a sphere has none."""
    corners, normals = _corners_and_normals(fit.kind)
    half_m = fit.solid.half_m[0][list(KINDS[fit.kind].axes)]
    corners_m = corners * half_m @ fit.rotation.T + fit.centre_m
    eye_m = -camera.P[:, 3] / camera.P[0, 0]
    pixels = seen_px(corners_m, camera).astype(np.float32)
    areas = []
    for normal in normals:
        reach = corners @ normal
        face = reach > reach.max() - _ON_IT
        if (eye_m - corners_m[face][0]) @ (fit.rotation @ normal) > 0:
            areas.append(cv2.contourArea(cv2.convexHull(pixels[face])))
    return np.array(areas)


def _corners_and_normals(kind_name: str) -> tuple[Floats, Floats]:
    """Corners (C, 3) of the solid whose half sizes are 1, and the outward normals (F, 3) of its flat faces."""
    kind = KINDS[kind_name]
    if isinstance(kind, Prism):
        return kind.corners, kind.normals
    angle = np.linspace(0, 2 * np.pi, _RIM, endpoint=False)
    ring = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    ends = (-1.0, 1.0) if kind is CYLINDER else ()
    return np.concatenate([np.c_[ring, np.full(_RIM, end)] for end in (-1.0, 1.0)]), np.array([(0, 0, e) for e in ends])
