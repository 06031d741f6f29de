"""Where rays are inside a slab, a ball or an endless cylinder: from `near` to `far` times the ray.

Where they never are, near is inf and far is -inf. `start` is (N, D) or (1, D), `ahead` is (N, D).
"""

from __future__ import annotations

import numpy as np

from stereo_pick.core.arrays import Floats


def slabs(start: Floats, ahead: Floats, half: Floats) -> tuple[Floats, Floats]:
    """Between -half and +half, axis by axis: both (N, D)."""
    with np.errstate(divide="ignore", invalid="ignore"):
        inverse = 1 / ahead
        one, other = (-half - start) * inverse, (half - start) * inverse
    return np.fmin(one, other), np.fmax(one, other)


def ball(start: Floats, ahead: Floats, radius: float) -> tuple[Floats, Floats]:
    """Within a radius of the origin; with two coordinates, of an endless cylinder's axis: both (N,)."""
    a = (ahead * ahead).sum(axis=1)
    b = (ahead * start).sum(axis=1)
    c = (start * start).sum(axis=1) - radius**2
    with np.errstate(divide="ignore", invalid="ignore"):
        root = np.sqrt(b * b - a * c)
        near, far = (-b - root) / a, (-b + root) / a
    missed = ~np.isfinite(near)
    return np.where(missed, np.inf, near), np.where(missed, -np.inf, far)
