"""Whether the surface of a solid is seen where the solid is: what is printed on it is there in both views, all over it,
and no nearer or farther.

It tells what edges do not of parts with patterns that are as dark, here and there, as what is behind them: much of
their silhouette has no edge then. Where such a part ends is still told by the edges that there are.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from stereo_pick.core.arrays import Bools, Floats
from stereo_pick.core.correspondence.warped_surface import LEAST, WarpedSurface
from stereo_pick.core.frames import RectifiedPair
from stereo_pick.core.objects.edge_model import vertex
from stereo_pick.core.shapes.solid_fit import SolidFit

_ALIKE = 0.7  # correlation
_REACH_PX, _STEP_PX = 2.0, 0.5  # of disparity, before and behind the surface: how far, in which steps, is looked
_TOGETHER_PX = 0.5  # by which all of it may be off
_APART_PX = 0.25  # ... and each window from that: a surface of another kind bends away by more
_TOLD, _MOST = 1 / 2, 0.9  # of the surface that shows a pattern; of its windows that agree


def is_surface_seen(pair: RectifiedPair, fit: SolidFit, others: Sequence[SolidFit]) -> bool:
    """Whether most of a solid's surface shows a pattern, and nearly all of that is where the surface is; others: what
    may be before it."""
    surface = WarpedSurface.of(pair, fit, others)
    if surface is None or surface.share < _TOLD:
        return False
    off_px, alike = _nearer_px(surface)
    if alike.sum() < LEAST:
        return False
    together_px = np.median(off_px[alike])
    agree = alike & (np.abs(off_px - together_px) < _APART_PX)
    return bool(agree.mean() > _MOST and abs(together_px) < _TOGETHER_PX)


def _nearer_px(surface: WarpedSurface) -> tuple[Floats, Bools]:
    """By how much (N,) the disparity of windows is more than the surface's, and whether (N,) they are alike there."""
    places = surface.windows(np.ones_like(surface.usable))
    offs_px = np.arange(-_REACH_PX, _REACH_PX + _STEP_PX, _STEP_PX)
    alike = np.array([surface.alike_at(places, off) for off in offs_px], np.float64)
    each = np.arange(len(places))
    best = np.clip(alike.argmax(axis=0), 1, len(offs_px) - 2)
    before, at, after = (-alike[best + step, each] for step in (-1, 0, 1))
    return offs_px[best] + _STEP_PX * vertex(before, at, after), -at > _ALIKE
