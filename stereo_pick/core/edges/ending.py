"""Cylinders that end where a rim shows, whatever their silhouettes show there.

The end of a part may be as dark as the shadow in front of it, so that no outline tells where it is. Where its lit side
ends, and with it the part, is seen all the same: at the rim between the two.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from stereo_pick.core.arrays import Floats
from stereo_pick.core.edges.adjusted import MOST_CREASES
from stereo_pick.core.edges.edge_evidence import creases_shown
from stereo_pick.core.edges.edge_map import EdgeMap
from stereo_pick.core.edges.growing import stretched_by, ways_along
from stereo_pick.core.rig import StereoRig
from stereo_pick.core.shapes.kinds import CYLINDER
from stereo_pick.core.shapes.occluders import Occluders
from stereo_pick.core.shapes.solids import Solids
from stereo_pick.core.shapes.table import Table

_STEP_PX = 1.0
_SHORTER, _LONGER = 0.6, 1.0  # of its length
_MOST = 2  # for each end ...
_APART_PX = 3.0  # ... with so much between them


def ended(
    solid: Solids, views: Sequence[EdgeMap], rig: StereoRig, table: Table | None, occluders: Occluders | None
) -> list[Solids]:
    """The cylinders (S = 1 each), shorter or longer at one end than this one, of which both views show most of the rims
    that they see, the clearest first; solid: S = 1. None of anything else. occluders: what hides a part of them."""
    if solid.kind is not CYLINDER:
        return []
    length_m = 2 * float(solid.half_m[0, 1])
    step_m = _STEP_PX * float(solid.centre_m[0, 2]) / rig.focal_px
    by_m = np.arange(-_SHORTER * length_m, _LONGER * length_m, step_m)
    found = list[tuple[float, Solids]]()
    for way in ways_along(solid, table):
        several = stretched_by(solid, [way], by_m)
        several = several.turning_about(table.normal) if table else several.turning_freely()
        shown = creases_shown(several, views, rig, occluders)
        found += [(float(shown[i]), several.only(np.array([i]))) for i in _clearest(shown)]
    return [each for _, each in sorted(found, key=lambda one: -one[0])]


def _clearest(shown: Floats) -> list[int]:
    """The few of successive lengths (L,) at which most of the rims show, each clearly another one."""
    left, kept = np.where(shown < MOST_CREASES, 0.0, shown), list[int]()
    while left.any() and len(kept) < _MOST:
        kept.append(int(left.argmax()))
        left[np.abs(np.arange(len(left)) - kept[-1]) * _STEP_PX < _APART_PX] = 0.0
    return kept
