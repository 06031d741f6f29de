"""A cylinder whose dark end is missing in its outlines: its lit side ends at the rim, which looks like a bite.

Rays that meet the side of a cylinder at one of its rims all meet it at the same height, from wherever one looks; those
past an end that shows its face do not.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import cv2
import numpy as np

from stereo_pick.core.arrays import Bools, Floats, Ints
from stereo_pick.core.camera import Camera
from stereo_pick.core.rig import StereoRig
from stereo_pick.core.shapes.kinds import dot
from stereo_pick.core.shapes.solid_fit import SolidFit

_ON_IT_PX = 0.75
_SEEN = np.deg2rad(70)  # of the side, both ways from what faces a camera; farther off a ray only grazes it
_PIECES = 14  # of what is seen of a rim
_SHARE = 0.5  # of these that the outline must follow for the end to be where it is ...
_LIT = 0.3  # ... and to be somewhere else: the side may be as dark as the end where it turns away from the light


@dataclass(frozen=True, eq=False)
class _Met:
    """Where N points of an outline meet a cylinder's side: height_m (N,) along its axis; pixel_m (N,), by how much a
    pixel changes that; piece (N,) of the rim; explained (N,), whether the cylinder's silhouette is there."""

    height_m: Floats
    pixel_m: Floats
    piece: Ints
    explained: Bools

    def share(self, which: Bools) -> float:
        """The part of a rim that these points (N,) cover."""
        return len(np.unique(self.piece[which])) / _PIECES

    def beyond(self, end: float) -> _Met:
        """Those on one half of the side."""
        half = self.height_m * end > 0
        return _Met(self.height_m[half], self.pixel_m[half], self.piece[half], self.explained[half])


def to_rims(fit: SolidFit, rig: StereoRig, contours_px: Sequence[Floats]) -> SolidFit:
    """The cylinder with its ends moved to the rims that its outlines follow; itself where they follow its silhouette.

    contours_px: the points (N, 2) of the outline that are on edges, in each view.
    """
    views = [_met(fit, camera, contour) for camera, contour in zip((rig.left, rig.right), contours_px)]
    half_m = float(fit.size_m[2]) / 2
    low, high = (_end_m([view.beyond(end) for view in views], end * half_m) for end in (-1.0, 1.0))
    if (low, high) == (-half_m, half_m):
        return fit
    size_m = np.array([*fit.size_m[:2], high - low])
    return replace(fit, centre_m=fit.centre_m + fit.rotation[:, 2] * (low + high) / 2, size_m=size_m)


def _met(fit: SolidFit, camera: Camera, contour_px: Floats) -> _Met:
    focal, middle = camera.P[[0, 1], [0, 1]], camera.P[:2, 2]
    eye_m = np.array([-camera.P[0, 3] / focal[0], 0.0, 0.0])
    start = (eye_m - fit.centre_m) @ fit.rotation
    way = np.column_stack([(contour_px - middle) / focal, np.ones(len(contour_px))]) @ fit.rotation
    across = dot(way[:, :2], way[:, :2])
    ahead = way[:, :2] @ start[:2]
    room = ahead**2 - across * (start[:2] @ start[:2] - (fit.size_m[0] / 2) ** 2)
    depth_m = (-ahead - np.sqrt(np.maximum(room, 0.0))) / across
    point = start + depth_m[:, None] * way
    angle = np.arctan2(point[:, 1], point[:, 0]) - np.arctan2(start[1], start[0])
    angle = (angle + np.pi) % (2 * np.pi) - np.pi
    pixel_m = depth_m * dot(way, way) / np.sqrt(across) / focal[0]
    seen = (room > 0) & (np.abs(angle) < _SEEN)
    piece = np.floor((angle[seen] / _SEEN + 1) / 2 * _PIECES).astype(np.int64)
    silhouette = fit.silhouette_px(camera).astype(np.float32)
    off = [cv2.pointPolygonTest(silhouette, (x, y), True) for x, y in contour_px[seen].tolist()]
    return _Met(point[seen, 2], pixel_m[seen], piece, np.abs(np.array(off)) < _ON_IT_PX)


def _end_m(views: Sequence[_Met], end_m: float) -> float:
    """The height of the rim at an end that is not explained otherwise."""
    if min(view.share(view.explained) for view in views) >= _SHARE:
        return end_m
    most, found = 0.0, end_m
    for height_m in np.concatenate([view.height_m for view in views]):
        on_it = [np.abs(view.height_m - height_m) < _ON_IT_PX * view.pixel_m for view in views]
        shares = [view.share(which) for view, which in zip(views, on_it)]
        if min(shares) >= _LIT and sum(shares) > most:
            heights = np.concatenate([view.height_m[which] for view, which in zip(views, on_it)])
            most, found = sum(shares), float(np.median(heights))
    return found
