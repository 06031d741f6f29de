"""The silhouettes of solids as polygons, and points spread evenly along them."""

from __future__ import annotations

import numpy as np

from stereo_pick.core.arrays import Floats, Ints
from stereo_pick.core.shapes.kinds import dot
from stereo_pick.core.shapes.solids import Solids

_DIRECTIONS = 48


def silhouettes(solids: Solids, eyes_m: Floats) -> Floats:
    """Outlines (S, E, 48, 2), normalized, as seen from eyes (E, 3): the points that touch tangents all around.

    They turn from x towards y.
    """
    points_m = touched(solids, eyes_m)
    return np.stack([points_m[..., 0] / points_m[..., 2], points_m[..., 1] / points_m[..., 2]], axis=-1)


def touched(solids: Solids, eyes_m: Floats) -> Floats:
    """Where (S, E, 48, 3) [m], from each eye (E, 3), rays all around touch solids.

    A tangent's offset is found as where the point lies that the last one touched: Newton's method, since the support
    is convex.
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
        points = (solids.kind.touch(own, solids.half_m) @ back).reshape(planes.shape) + centre
        u, v = points[..., 0] / points[..., 2], points[..., 1] / points[..., 2]
    return np.asarray(points)


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
    ahead, length, side, past = _spread(corners, count)
    tangent = (ahead / (length[..., None] + 1e-12)).reshape(-1, 2)[side]
    points = corners.reshape(-1, 2)[side] + past[..., None] * tangent
    return points, np.stack([tangent[..., 1], -tangent[..., 0]], axis=2)


def values_along(corners: Floats, values: Floats, count: int) -> Floats:
    """What corners (S, K, 2) have (S, K), at the same points (S, count)."""
    _, length, side, past = _spread(corners, count)
    rise = (np.concatenate([values[:, 1:], values[:, :1]], axis=1) - values) / (length + 1e-12)
    return np.asarray(values.ravel()[side] + past * rise.ravel()[side])


def _spread(corners: Floats, count: int) -> tuple[Floats, Floats, Ints, Floats]:
    """From each corner to the next one (S, K, 2), and how far (S, K); the sides (S, count), of all, on which points
    evenly spaced lie, and how far along (S, count)."""
    ahead = np.concatenate([corners[:, 1:], corners[:, :1]], axis=1) - corners
    length = np.sqrt(dot(ahead, ahead))
    end = np.cumsum(length, axis=1)
    at = (np.arange(count) + 0.5) / count * end[:, -1:]
    turn = np.arange(len(corners))[:, None]  # one polygon after the other
    side = np.searchsorted((turn + end / end[:, -1:]).ravel(), (turn + at / end[:, -1:]).ravel(), side="right")
    side = side.clip(0, end.size - 1).reshape(at.shape)
    return ahead, length, side, at - (end - length).ravel()[side]
