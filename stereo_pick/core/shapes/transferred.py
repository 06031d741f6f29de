"""Points of one view in the other one, as their height above the table has them."""

from __future__ import annotations

import numpy as np

from stereo_pick.core.arrays import Floats
from stereo_pick.core.rig import StereoRig
from stereo_pick.core.shapes.sight import normalized, seen_px
from stereo_pick.core.shapes.table import Table


def transferred(points_px: Floats, heights_m: Floats, rig: StereoRig, own: int, table: Table) -> Floats:
    """Where (K, N, 2) points (N, 2) of one view appear in the other, if they lie so high (K,) [m] above the table."""
    camera, other = (rig.left, rig.right) if own == 0 else (rig.right, rig.left)
    rays = np.insert(normalized(points_px, camera), 2, 1.0, axis=1)
    eye_m = np.array([own * rig.baseline_m, 0.0, 0.0])
    depth_m = (heights_m[:, None] - table.height_m(eye_m)) / (rays @ table.normal)
    return seen_px(eye_m + depth_m[..., None] * rays, other)
