"""How far from each other things of one robot cell can be."""

from __future__ import annotations

import numpy as np

from stereo_pick.core.arrays import Floats
from stereo_pick.core.errors import CalibrationError

MAX_REACH_M = 20.0


def check_reach(what: str, xyz: Floats, origin: str) -> None:
    """Raise CalibrationError where a position (3,) [m] is so far from its frame's origin that it is in millimetres."""
    reach_m = float(np.linalg.norm(xyz))
    if reach_m > MAX_REACH_M:
        raise CalibrationError(
            f"{what} is {reach_m:.0f} m from the {origin}: its position is in millimetres, give metres"
        )
