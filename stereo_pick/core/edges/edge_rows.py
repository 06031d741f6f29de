"""Distances between solids and edges, and the least squares equations they give."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from stereo_pick.core.arrays import Bools, Floats
from stereo_pick.core.edges.arcs import USUAL_SIGMA_PX
from stereo_pick.core.edges.creases import POINTS as CREASE_POINTS
from stereo_pick.core.edges.locking import ON_EDGE_PX
from stereo_pick.core.shapes.evidence import ARC_PX
from stereo_pick.core.shapes.occluders import share_seen
from stereo_pick.core.shapes.refinement import LEAST_SCALE_PX, tukey

_ROUNDED_M = 0.0003  # one sigma of how far a crease slides


class EdgeRows(NamedTuple):
    """residual_px: (S, M), how far solids reach beyond edges; jacobian: (S, M, P + 3), last by how far their edges are
    rounded [m] and by how far the right camera has turned [rad]; weight: (S, M), trust in them; length_px: (S, M), of
    what each point stands for."""

    residual_px: Floats
    jacobian: Floats
    weight: Floats
    length_px: Floats

    def turned(self, turn_rad: Floats) -> EdgeRows:
        """The same with the edges of the right view where they are without a turn (2,) of its camera."""
        return self._replace(residual_px=self.residual_px + self.jacobian[..., -2:] @ turn_rad)

    def nearness(self, scale_px: Floats) -> Floats:
        """The less (S, M) each point lies off the rest, which scatter by so much (S,), the nearer it is to 1."""
        return tukey(self.residual_px, np.maximum(scale_px, LEAST_SCALE_PX)[:, None])

    def weights(self, scale_px: Floats, sigma_px: Floats) -> Floats:
        """What each point (S, M) counts [1/px²]: as its part of an arc does, which light moves by sigma_px (S,), and
        less the more it lies off the rest, which scatter by scale_px (S,)."""
        counts = self.weight * self.nearness(scale_px)
        return np.asarray(counts * self.length_px / (ARC_PX * sigma_px[:, None] ** 2))

    def equations(self, weight: Floats) -> tuple[Floats, Floats]:
        """Normal matrices (S, P + 3, P + 3) and right-hand sides (S, P + 3)."""
        weighted = (self.jacobian * weight[..., None]).transpose(0, 2, 1)
        return weighted @ self.jacobian, (weighted @ self.residual_px[..., None])[..., 0]

    def on_edge(self) -> Bools:
        """Where (S, M) there is an edge."""
        return np.asarray((self.weight > 0) & (np.abs(self.residual_px) < ON_EDGE_PX))

    def beside_edge(self) -> Bools:
        """Where (S, M) there is one, but clearly beside."""
        return np.asarray((self.weight > 0) & (np.abs(self.residual_px) >= ON_EDGE_PX))


class CreaseRows(NamedTuple):
    """rows; slides: (S, M), by how many pixels each point moves as its crease slides towards the one face [px/m];
    there: (S, M), whether the crease would be seen, clear of the silhouette; hidden: (S, M), by others."""

    rows: EdgeRows
    slides: Floats
    there: Bools
    hidden: Bools

    def turned(self, turn_rad: Floats) -> CreaseRows:
        """As of `EdgeRows`."""
        return self._replace(rows=self.rows.turned(turn_rad))

    def along(self, values: Floats) -> Floats:
        """Sums (S, C, ...) along each crease, in both views, of values (S, M, ...)."""
        count = len(values)
        each = values.reshape(count, 2, -1, CREASE_POINTS, *values.shape[2:])
        return np.asarray(each.sum(axis=(1, 3)))

    def slid(self, weight: Floats) -> tuple[Floats, Floats]:
        """How far (S, C) [m] each crease slides to be nearest to its edges, counted with weights (S, M) [1/px²], and
        how well that is known (S, C) [1/m²]."""
        known = self.along(weight * self.slides**2) + 1 / _ROUNDED_M**2
        return -self.along(weight * self.slides * self.rows.residual_px) / known, known

    def at_edges(self) -> EdgeRows:
        """The rows after each crease has slid."""
        by_m, _ = self.slid(self.rows.weight * self.rows.length_px / (ARC_PX * USUAL_SIGMA_PX**2))
        moved_px = self.slides * np.tile(np.repeat(by_m, CREASE_POINTS, axis=1), 2)
        return self.rows._replace(residual_px=self.rows.residual_px + moved_px)

    def equations(self, weight: Floats) -> tuple[Floats, Floats]:
        """Normal matrices (S, P + 3, P + 3) and right-hand sides (S, P + 3), how far each slides eliminated (Schur)."""
        normal, right = self.rows.equations(weight)
        by_m, known = self.slid(weight)
        shared = self.along((weight * self.slides)[..., None] * self.rows.jacobian)
        normal -= (shared / known[..., None]).transpose(0, 2, 1) @ shared
        return normal, right + (shared * by_m[..., None]).sum(axis=1)

    def shown(self) -> Floats:
        """The part (S,) of what is there that lies on edges, as of `share_seen`; 1 where nothing is."""
        found = share_seen(self.rows.on_edge() & self.there, self.hidden, self.there)
        return np.where(self.there.any(axis=1), found, 1.0)
