"""What is seen before the surface of a solid, within its outline: there is more to the object, as to a bottle that is
seen from above, or something stands on it.

The right view is warped onto the left one by the solid's surface. What is printed on it looks the same in both then;
what light mirrors in it lies behind it, as in any mirror that does not curve inwards. Only what stands out is seen
nearer than the surface.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from stereo_pick.core.arrays import Floats, Ints
from stereo_pick.core.frames import RectifiedPair
from stereo_pick.core.rig import StereoRig
from stereo_pick.core.shapes.solid_fit import SolidFit
from stereo_pick.core.windows.warped_surface import ALIKE, LEAST, SIDE_PX, WarpedSurface
from stereo_pick.core.windows.window import Grey

_PLACED_PX = 0.1  # sigma that the edges in a window promise: half a pixel is told from none, on dark parts, too
_LEAD = 0.1  # of correlation, by which the best place must beat the surface, and what lies behind that ...
_CHANCE = 3 * float(np.sqrt(2 / (SIDE_PX**2 - 3)))  # ... and, of Fisher's z of that, by three sigma of two windows
_LIMIT = 0.999  # of correlation, of which z is finite
_NEAREST_PX, _STEP_PX = 1.0, 0.5  # before the surface; the steps in which it is looked for
_AGREE_PX = 1.5  # from what most of them say
_ENOUGH = 128  # windows: in large views there are thousands, and each is looked for along a long line


def stands_out(pair: RectifiedPair, fit: SolidFit, others: Sequence[SolidFit]) -> bool:
    """Whether something is seen before a solid's surface that is none of the others."""
    surface = WarpedSurface.of(pair, fit, others, _PLACED_PX)
    if surface is None:
        return False
    places = _unlike(surface)
    if len(places) < LEAST:
        return False
    out_px = _out_px(surface, places, _most_px(fit, pair.rig))
    if len(out_px) < LEAST:
        return False
    return int((np.abs(out_px - np.median(out_px)) < _AGREE_PX).sum()) >= LEAST


def _unlike(surface: WarpedSurface) -> Ints:
    """Enough of the windows (N, 2), column and row, that are not alike where the surface shows them."""
    alike = np.max([surface.alike(off) for off in (-_STEP_PX, 0.0, _STEP_PX)], axis=0)
    unlike = surface.windows(alike < ALIKE)
    return unlike[:: 1 + len(unlike) // _ENOUGH]


def _out_px(surface: WarpedSurface, places: Ints, most_px: float) -> Floats:
    """By how much (M,) the disparity of those of these is more than the surface's that are seen before it; of none
    where these are too few to say anything, whatever lies behind."""
    offs = np.arange(-most_px, most_px + _STEP_PX, _STEP_PX)
    before, behind = offs[offs >= _NEAREST_PX], offs[offs < _NEAREST_PX]
    if not len(before):
        return np.zeros(0)
    alike = np.array([surface.alike_at(places, off) for off in before])
    best = alike.max(axis=0)
    likely = np.flatnonzero(best > ALIKE)
    if len(likely) < LEAST:
        return np.zeros(0)
    back = np.max([surface.alike_at(places[likely], off) for off in behind], axis=0)
    ahead = (best[likely] > back + _LEAD) & (_fisher_z(best[likely]) > _fisher_z(back) + _CHANCE)
    return np.asarray(before[alike.argmax(axis=0)[likely]][ahead])


def _fisher_z(correlation: Grey) -> Floats:
    """What the same noise moves by as much whatever the correlation is (Fisher 1915)."""
    return np.arctanh(np.clip(correlation, -_LIMIT, _LIMIT)).astype(np.float64)


def _most_px(fit: SolidFit, rig: StereoRig) -> float:
    """By how much the disparity is more of what is nearer by the greatest size of a solid."""
    away_m = float(fit.centre_m[2])
    nearer_m = max(away_m - float(fit.size_m.max()), away_m / 2)
    return rig.focal_px * rig.baseline_m * (1 / nearer_m - 1 / away_m)
