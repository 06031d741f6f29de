"""Edges that are rounded, as those of real parts are.

What is rounded by r is a solid whose half sizes are less by r, and all that is within r of it (its Minkowski sum with
a ball): across its edges it reaches less far than the sharp-edged solid, by up to 0.41 r. How far edges are rounded is
an unknown of each solid, and hardly seen: little more is known of it than is told.
"""

from __future__ import annotations

import numpy as np

from stereo_pick.core.arrays import Floats
from stereo_pick.core.shapes.kinds import dot


def rounding_px(jacobian: Floats, sizes: int) -> Floats:
    """By how much further (S, M) [px/m] solids of the same sizes reach beyond edges if their own are rounded.

    jacobian: (S, M, P), of how far they reach, first by their centre [m] and last by their half sizes [m]. Each tangent
    moves inwards as the solid shrinks, and outwards by the radius.
    """
    outwards, centre = jacobian[..., -sizes:].sum(axis=-1), jacobian[..., :3]
    return np.asarray(np.sqrt(dot(centre, centre)) - outwards)


def however_rounded(normal: Floats, right: Floats, sigma_m: float) -> tuple[Floats, Floats]:
    """Normal matrices (S, P + 2, P + 2) and right-hand sides (S, P + 2) for any radius that is likely by its sigma.

    normal: (S, P + 3, P + 3), right: (S, P + 3), the radius before the last two unknowns: it is eliminated (Schur).
    """
    at, rest = normal.shape[1] - 3, np.r_[: normal.shape[1] - 3, -2, -1]
    shared = normal[:, rest, at]
    variance_m2 = sigma_m**2 / (1 + sigma_m**2 * normal[:, at, at])
    less = shared[:, :, None] * shared[:, None] * variance_m2[:, None, None]
    return normal[:, rest][:, :, rest] - less, right[:, rest] - shared * (variance_m2 * right[:, at])[:, None]
