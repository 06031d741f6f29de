"""Whether the surface of a solid is seen where the solid is: what is printed on it is there in both views, all over it,
and no nearer or farther.

It tells what edges do not of parts with patterns that are as dark, here and there, as what is behind them: much of
their silhouette has no edge then. Where such a part ends is still told by the edges that there are.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from stereo_pick.core.arrays import Bools, Floats
from stereo_pick.core.frames import RectifiedPair
from stereo_pick.core.objects.edge_model import vertex
from stereo_pick.core.rig import StereoRig
from stereo_pick.core.shapes.kinds import BOX, SPHERE
from stereo_pick.core.shapes.solid_fit import SolidFit
from stereo_pick.core.windows.warped_surface import ALIKE, LEAST, WarpedSurface

_REACH_PX, _STEP_PX = 2.0, 0.5  # of disparity, before and behind the surface: how far, in which steps, is looked
_TOGETHER_PX = 0.5  # by which all of it may be off
_APART_PX = 0.25  # ... and each window from that: a surface of another kind bends away by more
_FARTHER_PX = 21.0  # so that some windows are clear of the solid, and well within one that reaches farther
_LEAST_SEEN = 0.3  # of a length, by which it is foreshortened
_TOLD, _MOST = 1 / 2, 0.9  # of the surface that shows a pattern; of its windows that agree


def is_surface_seen(pair: RectifiedPair, fit: SolidFit, others: Sequence[SolidFit]) -> bool:
    """Whether most of a solid's surface shows a pattern, and nearly all of that is where the surface is; others: what
    may be before it."""
    surface = WarpedSurface.of(pair, fit, others)
    if surface is None or surface.share < _TOLD:
        return False
    off_px, alike = _nearer_px(surface, np.ones_like(surface.usable))
    if alike.sum() < LEAST:
        return False
    together_px = np.median(off_px[alike])
    agree = alike & (np.abs(off_px - together_px) < _APART_PX)
    return bool(agree.mean() > _MOST and abs(together_px) < _TOGETHER_PX)


def is_seen_beyond(pair: RectifiedPair, fit: SolidFit, others: Sequence[SolidFit]) -> bool:
    """Whether the same is seen where a solid's surface would be if the solid reached farther: it is a piece then."""
    return any(_goes_on(pair, fit, farther, others) for farther in _farther(fit, pair.rig))


def _farther(fit: SolidFit, rig: StereoRig) -> Iterator[SolidFit]:
    """Solids of the same surface that reach some windows farther, each at another end: of boxes all sides are one."""
    ahead = fit.centre_m / np.linalg.norm(fit.centre_m)
    for axis in {SPHERE.name: (), BOX.name: (0, 1, 2)}.get(fit.kind, (2,)):
        way = fit.rotation[:, axis]
        seen = max(float(np.linalg.norm(np.cross(way, ahead))), _LEAST_SEEN)
        more_m = _FARTHER_PX / rig.focal_px * fit.centre_m[2] / seen
        size_m = fit.size_m + more_m * (np.arange(3) == axis)
        for side in (-0.5, 0.5):
            yield replace(fit, size_m=size_m, centre_m=fit.centre_m + side * more_m * way)


def _goes_on(pair: RectifiedPair, fit: SolidFit, farther: SolidFit, others: Sequence[SolidFit]) -> bool:
    surface = WarpedSurface.of(pair, farther, others)
    if surface is None:
        return False
    off_px, alike = _nearer_px(surface, surface.clear_of(fit.silhouette_px(pair.rig.left)))
    agree = alike & (np.abs(off_px) < _TOGETHER_PX)
    return int(agree.sum()) >= LEAST and bool(agree.mean() > _TOLD)


def _nearer_px(surface: WarpedSurface, chosen: Bools) -> tuple[Floats, Bools]:
    """By how much (N,) the disparity of windows at these pixels (h, w) is more than the surface's, and whether (N,)
    they are alike there."""
    places = surface.windows(chosen)
    offs_px = np.arange(-_REACH_PX, _REACH_PX + _STEP_PX, _STEP_PX)
    alike = np.array([surface.alike_at(places, off) for off in offs_px], np.float64)
    each = np.arange(len(places))
    best = np.clip(alike.argmax(axis=0), 1, len(offs_px) - 2)
    before, at, after = (-alike[best + step, each] for step in (-1, 0, 1))
    return offs_px[best] + _STEP_PX * vertex(before, at, after), -at > ALIKE
