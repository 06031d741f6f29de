"""Many small systems of linear equations, some of which may be singular."""

from __future__ import annotations

import numpy as np

from stereo_pick.core.arrays import Floats


def solutions(systems: Floats) -> Floats:
    """Solutions (S, K) of S systems of K equations (K, K + 1, S), the last of the K + 1 being their right sides, and
    anything, or no numbers, where a system is singular: np.linalg.solve gives none at all then. They are overwritten.
    """
    with np.errstate(all="ignore"):
        for i, pivot in enumerate(systems):
            for below in systems[i + 1 :]:
                larger = np.abs(below[i]) > np.abs(pivot[i])
                pivot[i:], below[i:] = np.where(larger, below[i:], pivot[i:]), np.where(larger, pivot[i:], below[i:])
            pivot[i + 1 :] /= pivot[i]
            for other in (*systems[:i], *systems[i + 1 :]):
                other[i + 1 :] -= other[i] * pivot[i + 1 :]
    return systems[:, -1].T
