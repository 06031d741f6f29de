"""Two solids that are hardly two: a turned part of two diameters, a bolt's head and its shank.

What is put on top of another part hardly ever stands exactly on its axis.
"""

from __future__ import annotations

import numpy as np

from stereo_pick.core.arrays import Floats
from stereo_pick.core.shapes.kinds import CYLINDER, HEX_PRISM
from stereo_pick.core.shapes.solid_fit import SolidFit

_WITH_AXIS = CYLINDER.name, HEX_PRISM.name
_TURNED_ALIKE = np.sin(np.deg2rad(1.5))
_UPRIGHT = np.cos(np.deg2rad(5))
_OFF = 0.02  # of the largest size: from the axis, and between the ends


def are_coaxial(one: SolidFit, other: SolidFit, up: Floats | None = None, open_m: float = 0.0) -> bool:
    """Whether two cylinders or hexagonal prisms have one axis, and the second begins where the first ends; or, where
    that axis is upright, anywhere beyond that: nothing hangs above another one.

    up: (3,), of the table, if known; open_m: how far off either may be, of which no more counts than as much again.
    """
    if one.kind not in _WITH_AXIS or other.kind not in _WITH_AXIS:
        return False
    axis, apart_m = one.rotation[:, 2], other.centre_m - one.centre_m
    usual_m = _OFF * float(max(one.size_m.max(), other.size_m.max()))
    off_m = usual_m + min(open_m, usual_m)
    beside_m = float(np.linalg.norm(np.cross(axis, apart_m)))
    if float(np.linalg.norm(np.cross(axis, other.rotation[:, 2]))) > _TURNED_ALIKE or beside_m > off_m:
        return False
    gap_m = abs(float(axis @ apart_m)) - float(one.size_m[2] + other.size_m[2]) / 2
    is_upright = up is not None and abs(float(axis @ up)) > _UPRIGHT
    return -off_m < gap_m and (is_upright or gap_m < off_m)
