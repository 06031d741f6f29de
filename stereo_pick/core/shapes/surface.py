"""Where lines of sight meet the surface of a solid."""

from __future__ import annotations

import numpy as np

from stereo_pick.core.arrays import Floats
from stereo_pick.core.shapes.kinds import CYLINDER, Prism, dot
from stereo_pick.core.shapes.solid_fit import SolidFit

_TINY = 1e-12
_BESIDE = 1e-5  # of their length, by which lines differ that show how a surface is turned


def entered(fit: SolidFit, eye_m: Floats, ahead: Floats) -> Floats:
    """How many times its length each line ahead (N, 3) from an eye (3,) is long where it meets the solid, (N,); NaN
    where it misses. All in the rectified left frame."""
    solid = fit.solid
    origin, way = (eye_m - fit.centre_m) @ fit.rotation, ahead @ fit.rotation
    half = solid.half_m[0]
    if isinstance(solid.kind, Prism):
        normals = solid.kind.normals
        reach = dot(solid.kind.touch(normals[None], solid.half_m)[0], normals)
        near, far = _between_planes(origin, way, normals, reach)
    elif solid.kind is CYLINDER:
        ends = np.array([[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]])
        slab = _between_planes(origin, way, ends, half[[1, 1]])
        side = _within_round(origin[:2], way[:, :2], float(half[0]))
        near, far = np.maximum(slab[0], side[0]), np.minimum(slab[1], side[1])
    else:
        near, far = _within_round(origin, way, float(half[0]))
    return np.where((near < far) & (near > 0), near, np.nan)


def facing(fit: SolidFit, eye_m: Floats, ahead: Floats) -> Floats:
    """Normals (N, 3), towards the eye, of the surface where lines ahead (N, 3) from it meet the solid; NaN where they
    miss."""
    length = np.linalg.norm(ahead, axis=1, keepdims=True)
    across, beside, _ = np.eye(3) * _BESIDE
    lines = [ahead, ahead + length * across, ahead + length * beside]
    here, right, below = (each * entered(fit, eye_m, each)[:, None] for each in lines)
    normal = np.cross(below - here, right - here)
    return np.asarray(normal / np.linalg.norm(normal, axis=1, keepdims=True), np.float64)


def _between_planes(origin: Floats, way: Floats, normals: Floats, reach: Floats) -> tuple[Floats, Floats]:
    """Where lines enter, and leave (N,), what lies below all planes."""
    towards = normals @ way.T
    towards = np.where(np.abs(towards) < _TINY, _TINY, towards)
    at = (reach - normals @ origin)[:, None] / towards
    return np.where(towards < 0, at, -np.inf).max(axis=0), np.where(towards > 0, at, np.inf).min(axis=0)


def _within_round(origin: Floats, way: Floats, radius_m: float) -> tuple[Floats, Floats]:
    """Where lines enter, and leave (N,), a circle, or a ball, about the origin."""
    square, across = np.maximum(dot(way, way), _TINY), way @ origin
    root = across**2 - square * (origin @ origin - radius_m**2)
    half = np.sqrt(np.where(root > 0, root, np.nan))
    near, far = (-across - half) / square, (-across + half) / square
    return np.where(root > 0, near, np.inf), np.where(root > 0, far, -np.inf)
