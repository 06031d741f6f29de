"""The silhouettes of solids as polygons, and points spread evenly along them."""

from __future__ import annotations

import numpy as np

from stereo_pick.core.arrays import Floats
from stereo_pick.core.shapes.kinds import dot
from stereo_pick.core.shapes.solids import Solids

_DIRECTIONS = 48


def silhouettes(solids: Solids, eyes_m: Floats) -> Floats:
    """Outlines (S, E, 48, 2), normalized, as seen from eyes (E, 3): the points that touch tangents all around.

    A tangent's offset is found as where the point lies that the last one touched: Newton's method, since the support
    is convex. They turn from x towards y.
    """
    angles = np.arange(_DIRECTIONS) * (2 * np.pi / _DIRECTIONS)
    centre = solids.seen_from(eyes_m)
    planes = np.empty((*centre.shape[:2], _DIRECTIONS, 3))
    cosine, sine = planes[..., 0], planes[..., 1] = np.cos(angles), np.sin(angles)
    u, v = (centre[..., axis] / centre[..., 2] for axis in (0, 1))
    back = solids.rotation.transpose(0, 2, 1)
    for _ in range(3):
        planes[..., 2] = -(u * cosine + v * sine)
        own = planes.reshape(len(planes), -1, 3) @ solids.rotation
        touched = (solids.kind.touch(own, solids.half_m) @ back).reshape(planes.shape) + centre
        u, v = touched[..., 0] / touched[..., 2], touched[..., 1] / touched[..., 2]
    return np.stack([u, v], axis=-1)


def inside(points: Floats, corners: Floats) -> Floats:
    """How far (S, N) points (S, N, 2) lie inside convex polygons (S, K, 2), or one (1, K, 2), turning from x to y."""
    ahead = np.concatenate([corners[:, 1:], corners[:, :1]], axis=1) - corners
    length = np.sqrt(dot(ahead, ahead))
    inward = np.stack([-ahead[..., 1], ahead[..., 0]], axis=2) / np.maximum(length, 1e-12)[..., None]
    at = np.where(length > 1e-9, dot(inward, corners), -np.inf)  # what has no length is no side
    off = points @ inward.transpose(0, 2, 1)
    off -= at[:, None]
    return np.asarray(off.min(axis=2))


def along_polygon(corners: Floats, count: int) -> tuple[Floats, Floats]:
    """Points (S, count, 2), evenly spaced along closed polygons (S, K, 2), and the outward normals there.

    The polygons turn from x towards y.
    """
    ahead = np.concatenate([corners[:, 1:], corners[:, :1]], axis=1) - corners
    length = np.sqrt(dot(ahead, ahead))
    end = np.cumsum(length, axis=1)
    at = (np.arange(count) + 0.5) / count * end[:, -1:]
    turn = np.arange(len(corners))[:, None]  # one polygon after the other
    side = np.searchsorted((turn + end / end[:, -1:]).ravel(), (turn + at / end[:, -1:]).ravel(), side="right")
    side = side.clip(0, end.size - 1).reshape(at.shape)
    tangent = (ahead / (length[..., None] + 1e-12)).reshape(-1, 2)[side]
    past = at - (end - length).ravel()[side]
    points = corners.reshape(-1, 2)[side] + past[..., None] * tangent
    return points, np.stack([tangent[..., 1], -tangent[..., 0]], axis=2)
