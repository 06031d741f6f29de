"""The silhouettes of solids as polygons, and points spread evenly along them."""

from __future__ import annotations

import numpy as np

from stereo_pick.core.arrays import Floats
from stereo_pick.core.shapes.sight import tangent_planes
from stereo_pick.core.shapes.solids import Solids

_DIRECTIONS = 48


def silhouettes(solids: Solids, eyes_m: Floats) -> Floats:
    """Outlines (S, E, 48, 2), normalized, as seen from eyes (E, 3): the points that touch tangents all around.

    A tangent's offset is found as where the point lies that the last one touched: Newton's method, since the support
    is convex. They turn from x towards y.
    """
    angles = np.arange(_DIRECTIONS) * (2 * np.pi / _DIRECTIONS)
    around = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    centre = solids.seen_from(eyes_m)
    at = np.broadcast_to(centre[..., :2] / centre[..., 2:], (*centre.shape[:2], _DIRECTIONS, 2))
    for _ in range(3):
        touched = _touched(solids, tangent_planes(at, np.broadcast_to(around, at.shape))) + centre
        at = touched[..., :2] / touched[..., 2:]
    return np.asarray(at)


def _touched(solids: Solids, planes: Floats) -> Floats:
    """The solids' points (S, E, N, 3) [m], relative to their centres, that lie furthest in such directions."""
    own = planes.reshape(len(planes), -1, 3) @ solids.rotation
    touched = solids.kind.touch(own, solids.half_m) @ solids.rotation.transpose(0, 2, 1)
    return np.asarray(touched.reshape(planes.shape))


def along_polygon(corners: Floats, count: int) -> tuple[Floats, Floats]:
    """Points (S, count, 2), evenly spaced along closed polygons (S, K, 2), and the outward normals there.

    The polygons turn from x towards y.
    """
    ahead = np.roll(corners, -1, axis=1) - corners
    length = np.linalg.norm(ahead, axis=2)
    end = np.cumsum(length, axis=1)
    at = (np.arange(count) + 0.5) / count * end[:, -1:]
    side = (end[:, None, :] <= at[:, :, None]).sum(axis=2).clip(0, corners.shape[1] - 1)
    row = np.arange(len(corners))[:, None]
    tangent = ahead / (length[..., None] + 1e-12)
    past = at - (end - length)[row, side]
    points = corners[row, side] + past[..., None] * tangent[row, side]
    chosen = tangent[row, side]
    return points, np.stack([chosen[..., 1], -chosen[..., 0]], axis=2)
