"""Solids on a table brought onto what is seen of a surface, and roughly onto outlines (Levenberg and Marquardt).

A surface tells how a part is turned, and how high it is; where it ends, outlines tell.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from stereo_pick.core.arrays import Floats
from stereo_pick.core.rig import StereoRig
from stereo_pick.core.shapes.fitting import Pair, nearest_of_kind
from stereo_pick.core.shapes.kinds import KINDS
from stereo_pick.core.shapes.nearest import nearest_tangents
from stereo_pick.core.shapes.refinement import Fitted, bounded, firmly_on, fitted, moved, tukey
from stereo_pick.core.shapes.sight import Sight
from stereo_pick.core.shapes.solid_fit import SolidFit
from stereo_pick.core.shapes.solids import Solids
from stereo_pick.core.shapes.surface import entered
from stereo_pick.core.shapes.table import Table

_ROUNDS, _WIDE_ROUNDS = 10, 3
_HARDLY = 0.01  # of the cost, by which a step that matters lessens it
_WIDE, _NARROWING = 3.0, 0.7  # times its sigma, from which on a place of the surface counts less; in each round
_OUTLINE = 4.0  # sigma of the outlines, in those of the surface
_LEAST_HALF = 0.1  # of the object's radius
_STEP = 1e-4  # [m] and [rad], of the differences that stand for derivatives
_STEEPEST = 1e6  # pixels by metre: farther is where a line of sight comes to meet the solid, or to miss it
_DAMPING, _LESS, _MORE = 1e-3, 0.2, 10.0
_TINY = 1e-3


class Surface(NamedTuple):
    """N places seen of a surface. ahead: (N, 3), the lines of sight of the left camera, of depth 1; disparity_px:
    (N,), less what the views' principal points are apart; sigma_px: of each."""

    ahead: Floats
    disparity_px: Floats
    sigma_px: float


class _State(NamedTuple):
    """solids; off_px: (N,), by how much their disparity is more than the surface's, NaN where they are not seen; sides:
    how far they are off the outlines; cost: of both."""

    solids: Solids
    off_px: Floats
    sides: Fitted
    cost: float


def solids_onto(surface: Surface, outlines: list[Pair], rig: StereoRig, table: Table) -> list[Solids]:
    """The solids (S = 1 each) of all kinds on a table that come nearest to a surface and to one of several outlines
    that an object may have."""
    found = []
    for kind in KINDS.values() if outlines else ():
        near = nearest_of_kind(outlines, rig, kind, table)
        for pair in outlines:
            found.append(_Onto(surface, Sight.of([pair], rig, table), rig, table).brought(near[pair, kind][0]))
    return found


class _Onto(NamedTuple):
    """surface; sight: one object's outlines; rig; table: what it stands on."""

    surface: Surface
    sight: Sight
    rig: StereoRig
    table: Table

    def brought(self, solid: Solids) -> Solids:
        """A solid (S = 1) moved, turned about the table's normal, and made larger or smaller."""
        damping, now = _DAMPING, self._state(solid)
        for round_ in range(_ROUNDS):
            scale_px = self.surface.sigma_px * max(1.0, _WIDE * _NARROWING**round_)
            tried = self._state(self._moved(now.solids, self._step(now, scale_px, damping)))
            settled = round_ > _WIDE_ROUNDS and abs(now.cost - tried.cost) < _HARDLY * now.cost
            if tried.cost < now.cost:
                now, damping = tried, damping * _LESS
            else:
                damping *= _MORE
            if settled:
                break
        return now.solids

    def _state(self, solids: Solids) -> _State:
        sigma_px = self.surface.sigma_px
        off_px, sides = self._off_px(solids), fitted(self.sight, solids, nearest_tangents)
        missed = np.where(np.isnan(off_px), np.inf, off_px)
        cost = bounded(missed, sigma_px).sum() / sigma_px**2
        outline_px = _OUTLINE * sigma_px
        cost += (sides.weight * bounded(sides.residual_px, outline_px)).sum() / outline_px**2
        return _State(solids, off_px, sides, float(cost))

    def _off_px(self, solids: Solids) -> Floats:
        kind = solids.kind.name
        fit = SolidFit(kind, solids.centre_m[0], solids.rotation[0], solids.size_m()[0], 0.0, np.zeros((3, 3)))
        depth_m = entered(fit, self.rig.eyes_m[0], self.surface.ahead)
        return self.rig.focal_px * self.rig.baseline_m / depth_m - self.surface.disparity_px

    def _moved(self, solids: Solids, step: Floats) -> Solids:
        return self.table.put_down(moved(solids, step[None], _LEAST_HALF * self.sight.radius_m))

    def _step(self, now: _State, scale_px: float, damping: float) -> Floats:
        """The damped step (3 + Q + sizes) of iteratively reweighted least squares."""
        slopes = self._slopes(now)
        known = np.isfinite(now.off_px) & (np.abs(slopes) < _STEEPEST).all(axis=1)
        off_px, slopes = now.off_px[known], slopes[known]
        weight = tukey(off_px, scale_px) / self.surface.sigma_px**2
        normal, right = (slopes.T * weight) @ slopes, (slopes.T * weight) @ off_px
        outline_px = _OUTLINE * self.surface.sigma_px
        sides, jacobian = now.sides.residual_px[0], now.sides.jacobian[0]
        weight = now.sides.weight[0] * tukey(sides, outline_px) / outline_px**2
        normal, right = normal + (jacobian.T * weight) @ jacobian, right + (jacobian.T * weight) @ sides
        normal += np.diag(damping * np.diag(normal) + _TINY)
        normal += firmly_on(self.table, now.solids, self.sight.focal_px)[0][0]
        return np.asarray(-np.linalg.solve(normal, right))

    def _slopes(self, now: _State) -> Floats:
        """The derivatives (N, 3 + Q + sizes) of `off_px`; NaN where there are none."""
        steps = _STEP * np.eye(now.sides.jacobian.shape[2])
        return np.stack([self._off_px(self._moved(now.solids, step)) - now.off_px for step in steps], axis=1) / _STEP
