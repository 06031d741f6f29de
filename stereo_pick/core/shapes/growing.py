"""Solids of which the outlines show a part only: the rest found by the edges that it must have.

A side as bright as the table leaves no outline, only the faint edges around it. A solid that was fitted to the bright
part is stretched, away from each of its faces, until its new silhouette lies on edges in both views.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from stereo_pick.core.arrays import Floats
from stereo_pick.core.shapes.edge_map import EdgeMap
from stereo_pick.core.shapes.predicted import along_polygon, silhouettes
from stereo_pick.core.shapes.sight import Solids

_STEP_PX = 3.0
_NEW_PX = 4.0  # how far a point lies outside the old silhouette to be one of the new part
_LEAST = 0.15  # of the size of the part that was seen, and ...
_LEAST_PX = 6.0  # ... in pixels: the shadow where an object stands has edges, too
_FAR = 0.7  # part of the greatest such distance: the far end tells the length, the sides are there for any
_MIN_POINTS = 6
_POINTS = 72
_SHOWN = 0.75  # part of the new silhouette that must lie on edges: by chance one in ten points does
_FARTHEST = 1.6  # times the size of the part that was seen


def grown(solid: Solids, eyes_m: Floats, views: Sequence[EdgeMap]) -> Solids | None:
    """The stretched solid whose new silhouette the views show best, or None where none shows; solid: S = 1."""
    candidates = _stretched(solid, _STEP_PX / views[0].camera.P[0, 0])
    if candidates is None:
        return None
    old, new = silhouettes(solid, eyes_m)[0], silhouettes(candidates, eyes_m)
    share, count = np.ones(len(new)), np.zeros(len(new))
    for side, view in enumerate(views):
        focal = view.camera.P[0, 0]
        points, normals = along_polygon(new[:, side], _POINTS)
        distance_px = _outside(points, old[side]) * focal
        fresh = distance_px > _NEW_PX
        far = fresh & (distance_px > _FAR * distance_px.max(axis=1, keepdims=True))
        pixels = points.reshape(-1, 2) * focal + view.camera.P[:2, 2]
        shown = view.shows(pixels, normals.reshape(-1, 2)).reshape(fresh.shape) & fresh
        total, found = fresh.sum(axis=1), shown.sum(axis=1)
        ends = (shown & far).sum(axis=1) / np.maximum(far.sum(axis=1), 1)
        share = np.minimum(share, np.where(total >= _MIN_POINTS, np.minimum(found / np.maximum(total, 1), ends), 0.0))
        count += found
    best = int(np.where(share >= _SHOWN, share + count / (4 * _POINTS), 0.0).argmax())
    return candidates.only(np.array([best])) if share[best] >= _SHOWN else None


def is_longer(one: Solids, other: Solids, focal_px: float) -> bool:
    """Whether one solid (S = 1) is so much larger than another of its kind that it shows another part."""
    longer_m = 2 * float((one.half_m - other.half_m).max())
    return longer_m > _least_m(other, float(other.centre_m[0, 2]) / focal_px)


def _least_m(solid: Solids, m_per_px: float) -> float:
    return max(_LEAST * 2 * float(solid.half_m.max()), _LEAST_PX * m_per_px)


def _stretched(solid: Solids, step: float) -> Solids | None:
    """The solid made longer by many lengths along each of its own axes, to either side; step: [m] per metre away."""
    kind = solid.kind
    if kind.sizes == 1:
        return None
    size = 2 * float(solid.half_m.max())
    step_m = step * solid.centre_m[0, 2]
    lengths = np.arange(_least_m(solid, step_m / _STEP_PX) + step_m, max(_FARTHEST * size, 4 * step_m), step_m)
    centres, halves = [], []
    for axis in (2,) if kind.sizes == 2 else (0, 1, 2):
        which = kind.axes[axis]
        for sign in (1.0, -1.0):
            half = np.repeat(solid.half_m, len(lengths), axis=0)
            half[:, which] += lengths / 2
            halves.append(half)
            centres.append(solid.centre_m + sign * lengths[:, None] / 2 * solid.rotation[0, :, axis])
    count = sum(len(part) for part in halves)
    return Solids(
        kind,
        np.concatenate(centres),
        np.repeat(solid.rotation, count, axis=0),
        np.concatenate(halves),
        np.tile(np.eye(3)[:, list(kind.turns)], (count, 1, 1)),
    )


def _outside(points: Floats, corners: Floats) -> Floats:
    """How far (S, N) points (S, N, 2) lie outside a convex polygon (K, 2) that turns from x towards y."""
    ahead = np.roll(corners, -1, axis=0) - corners
    length = np.linalg.norm(ahead, axis=1)
    real = length > 1e-9
    outward = np.stack([ahead[real, 1], -ahead[real, 0]], axis=1) / length[real, None]
    return np.asarray((points @ outward.T - (outward * corners[real]).sum(axis=1)).max(axis=2))
