"""Stretches of silhouettes along which edges are found, or only by chance.

Within reach of most points of a silhouette there is something that passes for a weak edge, be it noise. Such say little
each, but a whole side of them passes for known, a solid that is a centimetre too short for sure. What is an edge goes
on: of chance there is little around.
"""

from __future__ import annotations

import numpy as np

from stereo_pick.core.arrays import Bools, Floats
from stereo_pick.core.shapes.kinds import dot

_REACH = 8  # points to either side
_STRAIGHT = 0.9  # cosine of the turn within which it is the same side
_MOST = 0.5  # so much of a stretch that is trusted is enough


def stretches_found(across: Floats, trusted: Floats, open_: Bools) -> Floats:
    """What each point (S, 2, N) of closed lines in two views counts, from 0 to 1, as there are edges around it.

    across: (S, 2, N, 3), the direction in which the line is passed there; trusted: (S, 2, N), how far its edge is;
    open_: (S, 2, N), where nothing hides it.
    """
    across = across / np.sqrt(dot(across, across))[..., None]
    closed = [np.concatenate([each[:, :, -_REACH:], each, each[:, :, :_REACH]], 2) for each in (across, trusted, open_)]
    found, most = np.zeros(trusted.shape), np.zeros(trusted.shape)
    for start in range(2 * _REACH + 1):
        there, its_trust, is_open = (each[:, :, start : start + trusted.shape[2]] for each in closed)
        same = dot(across, there) > _STRAIGHT
        found += same * its_trust
        most += same * is_open
    return np.asarray(np.minimum(found / np.maximum(_MOST * most, 1e-9), 1.0) ** 2)
