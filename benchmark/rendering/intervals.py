"""Where rays are inside a slab, a ball or an endless cylinder: from `near` to `far` times the ray.

Where they never are, near is inf and far is -inf. `start` is (N, D) or (1, D), `ahead` is (N, D). Vectors lie in memory
coordinate by coordinate, in which order numpy computes with few columns two to ten times as fast.
"""

from __future__ import annotations

import numpy as np

from stereo_pick.core.arrays import Floats, Ints


def dot(one: Floats, other: Floats) -> Floats:
    """Row by row, (N,) of (N, D) or (1, D)."""
    return np.asarray(np.einsum("ij,ij->i", one, other))


def turned(vectors: Floats, axes: Floats) -> Floats:
    """Vectors (N, D) @ axes (D, K)."""
    return np.asarray(axes.T @ vectors.T).T


def taken(vectors: Floats, rows: Ints) -> Floats:
    """Some rows (K,) of vectors (N, D), in their order."""
    return vectors.T.take(rows, axis=1).T


def slabs(start: Floats, ahead: Floats, half: Floats) -> tuple[Floats, Floats]:
    """Between -half and +half, axis by axis: both (N, D)."""
    with np.errstate(divide="ignore", invalid="ignore"):
        inverse = 1 / ahead
        one, other = (-half - start) * inverse, (half - start) * inverse
    return np.fmin(one, other), np.fmax(one, other)


def ball(start: Floats, ahead: Floats, radius: float) -> tuple[Floats, Floats]:
    """Within a radius of the origin; with two coordinates, of an endless cylinder's axis: both (N,)."""
    a, b, c = dot(ahead, ahead), dot(ahead, start), dot(start, start) - radius**2
    with np.errstate(divide="ignore", invalid="ignore"):
        root = np.sqrt(b * b - a * c)
        near, far = (-b - root) / a, (-b + root) / a
    missed, always = ~np.isfinite(near), (a == 0) & (c < 0)  # along the axis, within
    return (
        np.where(always, -np.inf, np.where(missed, np.inf, near)),
        np.where(always, np.inf, np.where(missed, -np.inf, far)),
    )
