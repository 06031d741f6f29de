"""What the edges of both views say of solids: those beside their silhouettes, and those of their creases."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from stereo_pick.core.arrays import Bools, Floats
from stereo_pick.core.objects.edge_model import OFFSETS_PX, find_edges
from stereo_pick.core.rig import StereoRig
from stereo_pick.core.sampling import sampled
from stereo_pick.core.shapes.creases import POINTS as CREASE_POINTS
from stereo_pick.core.shapes.creases import creases
from stereo_pick.core.shapes.edge_map import EdgeMap
from stereo_pick.core.shapes.evidence import ARC_PX, USUAL_PX
from stereo_pick.core.shapes.kinds import cross, dot
from stereo_pick.core.shapes.locking import ON_EDGE_PX, edges_beside, trust
from stereo_pick.core.shapes.nearest import nearest_tangents
from stereo_pick.core.shapes.predicted import inside, silhouettes
from stereo_pick.core.shapes.refinement import LEAST_SCALE_PX, robust_scale, tukey
from stereo_pick.core.shapes.residuals import residuals
from stereo_pick.core.shapes.sight import Sight, turning
from stereo_pick.core.shapes.solids import Solids

_POINTS = 120  # of a silhouette
_CLEAR_PX = 3.0  # from the silhouette, nearer than which its edge is in the way of a crease's
_REACH_PX = 1.15  # the farthest edge that is found
_ARC_SIGMA_PX = 0.11  # of arcs on edges; the more of a silhouette lies on none, the less the rest is trusted
_LEAST_SHOWN = 0.25
_ROUNDED_M = 0.0003  # one sigma of how far a crease slides
_TINY = 1e-12
_STILL = np.zeros(2)


class EdgeEvidence(NamedTuple):
    """normal: (S, P + 2, P + 2) and right: (S, P + 2), the normal equations of a step, by their noise, of the solids
    and, last, of the right camera about its x and z axis [rad]; scale_px: (S,), robust
    standard deviation of the distances; shown, creased: (S,), the part of the silhouettes (the least of both views)
    and of the creases (1 where there are none) that lies on edges."""

    normal: Floats
    right: Floats
    scale_px: Floats
    shown: Floats
    creased: Floats


class _Rows(NamedTuple):
    """residual_px: (S, M), how far solids reach beyond edges; jacobian: (S, M, P); weight: (S, M), trust in them;
    length_px: (S, M), of what each point stands for."""

    residual_px: Floats
    jacobian: Floats
    weight: Floats
    length_px: Floats

    def turned(self, turn_rad: Floats) -> _Rows:
        """The same with the edges of the right view where they are without a turn (2,) of its camera."""
        return self._replace(residual_px=self.residual_px + self.jacobian[..., -2:] @ turn_rad)

    def on_edge(self) -> Bools:
        """Where (S, M) there is an edge."""
        return np.asarray((self.weight > 0) & (np.abs(self.residual_px) < ON_EDGE_PX))


class _Creases(NamedTuple):
    """rows; slides: (S, M), by how many pixels each point moves as its crease slides towards the one face [px/m];
    there: (S, M), whether the crease is seen, clear of the silhouette."""

    rows: _Rows
    slides: Floats
    there: Bools

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

    def at_edges(self) -> _Rows:
        """The rows after each crease has slid."""
        by_m, _ = self.slid(self.rows.weight * self.rows.length_px / (ARC_PX * _ARC_SIGMA_PX**2))
        moved_px = self.slides * np.tile(np.repeat(by_m, CREASE_POINTS, axis=1), 2)
        return self.rows._replace(residual_px=self.rows.residual_px + moved_px)

    def equations(self, weight: Floats) -> tuple[Floats, Floats]:
        """Normal matrices (S, P, P) and right-hand sides (S, P), how far each slides eliminated (Schur)."""
        normal, right = _equations(self.rows, weight)
        by_m, known = self.slid(weight)
        shared = self.along((weight * self.slides)[..., None] * self.rows.jacobian)
        normal -= (shared / known[..., None]).transpose(0, 2, 1) @ shared
        return normal, right + (shared * by_m[..., None]).sum(axis=1)

    def shown(self) -> Floats:
        """The part (S,) of what is there that lies on edges; 1 where nothing is."""
        expected = self.there.sum(axis=1)
        found = (self.rows.on_edge() & self.there).sum(axis=1)
        return np.where(expected > 0, found / np.maximum(expected, 1), 1.0)


def edge_evidence(solids: Solids, views: Sequence[EdgeMap], rig: StereoRig, turn_rad: Floats = _STILL) -> EdgeEvidence:
    """What two rectified views show beside and across solids (S); turn_rad: (2,), how the right camera has turned.

    Where two faces meet parts are rounded, and it is a matter of the light where on the round the edge appears: each
    crease may slide, as one in both views.
    """
    corners = silhouettes(solids, rig.eyes_m)
    outer, inner = _silhouettes(solids, corners, views, rig), _creases(solids, corners, views, rig)
    outer, inner = outer.turned(turn_rad), inner._replace(rows=inner.rows.turned(turn_rad))
    slid = inner.at_edges()
    scale = _scale_px(outer, slid)
    shown = outer.on_edge().reshape(len(scale), 2, -1).mean(axis=2).min(axis=1)
    sigma = _ARC_SIGMA_PX * np.maximum(1.0, scale / USUAL_PX) / np.maximum(shown, _LEAST_SHOWN) ** 2
    normal, right = _equations(outer, _weights(outer, scale, sigma))
    more, more_right = inner.equations(_weights(slid, scale, sigma))
    return EdgeEvidence(normal + more, right + more_right, scale, shown, inner.shown())


def _equations(rows: _Rows, weight: Floats) -> tuple[Floats, Floats]:
    """Normal matrices (S, P, P) and right-hand sides (S, P)."""
    weighted = (rows.jacobian * weight[..., None]).transpose(0, 2, 1)
    return weighted @ rows.jacobian, (weighted @ rows.residual_px[..., None])[..., 0]


def _weights(rows: _Rows, scale_px: Floats, sigma_px: Floats) -> Floats:
    """What each point (S, M) counts [1/px²]: as its part of an arc does, and less the more it lies off the rest."""
    near = tukey(rows.residual_px, np.maximum(scale_px, LEAST_SCALE_PX)[:, None])
    return np.asarray(rows.weight * near * rows.length_px / (ARC_PX * sigma_px[:, None] ** 2))


def _scale_px(outer: _Rows, inner: _Rows) -> Floats:
    residual = np.concatenate([outer.residual_px, inner.residual_px], axis=1)
    scale = robust_scale(residual, np.concatenate([outer.weight, inner.weight], axis=1))
    return np.where(np.isfinite(scale), scale, ON_EDGE_PX)


def _silhouettes(solids: Solids, corners: Floats, views: Sequence[EdgeMap], rig: StereoRig) -> _Rows:
    outlines, *_ = edges_beside(corners, views, _POINTS)
    sight = Sight.of(outlines, rig)
    residual, jacobian = residuals(sight, solids, nearest_tangents(sight, solids))
    ahead = np.diff(sight.points, axis=2, append=sight.points[:, :, :1]) * rig.focal_px
    around_px = np.median(np.sqrt(dot(ahead, ahead)), axis=2)
    length_px = np.repeat(around_px, _POINTS, axis=1)
    weight = sight.weight.reshape(residual.shape)
    by_turns = np.zeros((*residual.shape, 2))
    by_turns[:, _POINTS:] = _turning_px(sight.points[:, 1], sight.normals[:, 1], rig.focal_px)
    return _Rows(residual, np.concatenate([jacobian, by_turns], axis=2), weight, length_px)


def _turning_px(points: Floats, normals: Floats, focal_px: float) -> Floats:
    """How much further (..., 2) [px/rad] something reaches beyond edges of the right view when its camera has turned
    about its x or its z axis; at normalized points (..., 2) with normals (..., 2)."""
    return -focal_px * np.stack([dot(normals, moved) for moved in turning(points)], axis=-1)


def _creases(solids: Solids, corners: Floats, views: Sequence[EdgeMap], rig: StereoRig) -> _Creases:
    sides = [_creases_in(solids, corners[:, i], rig.eyes_m[i], view, i == 1) for i, view in enumerate(views)]
    rows = _Rows(*(np.concatenate(each, axis=1) for each in zip(*(side.rows for side in sides))))
    slides, there = (np.concatenate(each, axis=1) for each in zip(*(side[1:] for side in sides)))
    return _Creases(rows, slides, there)


def _creases_in(solids: Solids, corners: Floats, eye_m: Floats, view: EdgeMap, may_turn: bool) -> _Creases:
    """Those of one view, each measured across the crease."""
    inner = creases(solids, eye_m[None])
    own = inner.unit[:, 0] * solids.half_m[:, None, solids.kind.axes]
    turn = solids.rotation.transpose(0, 2, 1)
    points_m, ahead_m = (solids.centre_m - eye_m)[:, None] + own @ turn, inner.ahead[:, 0] @ turn
    depth_m, focal = points_m[..., 2:], view.camera.P[0, 0]
    image = points_m[..., :2] / depth_m
    along = (ahead_m[..., :2] - image * ahead_m[..., 2:]) / depth_m
    length = np.sqrt(dot(along, along))
    normals = np.stack([along[..., 1], -along[..., 0]], axis=-1) / (length[..., None] + _TINY)
    seen = inner.seen[:, 0] & (length > _TINY)
    offset, weight = _measured(view, image * focal + view.camera.P[:2, 2], normals, seen)
    # How a point's image moves across its crease with the point: (S, K, 3).
    across = np.concatenate([normals, -dot(image, normals)[..., None]], axis=2) * focal / depth_m
    turned = across @ solids.rotation
    turns = cross(own, turned) @ solids.turns
    sizes = (own * turned) @ (solids.kind.shares / solids.half_m[:, None])
    by_turns = _turning_px(image, normals, focal) * may_turn
    jacobian = np.concatenate([across, turns, sizes, by_turns], axis=2)
    rows = _Rows(offset, jacobian, weight, _spacing_px(image * focal))
    clear = seen & (inside(image, corners) * focal > _CLEAR_PX)
    return _Creases(rows, dot(turned, inner.slide[:, 0]), clear)


def _measured(view: EdgeMap, points_px: Floats, normals: Floats, seen: Bools) -> tuple[Floats, Floats]:
    """How far (S, K) [px] beyond an edge each point that is seen lies along its normal, and the trust in that edge."""
    offset, weight = np.zeros(seen.shape), np.zeros(seen.shape)
    if not seen.any():
        return offset, weight
    places = points_px[seen][:, None] - OFFSETS_PX[:, None] * normals[seen][:, None]
    edges = find_edges(sampled(view.image, places), view.modelled_blur_px)
    offset[seen] = edges.place_px
    weight[seen] = np.where(np.abs(edges.place_px) < _REACH_PX, trust(edges, view.noise), 0.0)
    return offset, weight


def _spacing_px(points_px: Floats) -> Floats:
    """How far (S, K) apart the points of each crease lie."""
    several = points_px.reshape(len(points_px), -1, CREASE_POINTS, 2)
    ahead = several[:, :, 1:] - several[:, :, :-1]
    spacing = np.sqrt(dot(ahead, ahead)).mean(axis=2, keepdims=True)
    return np.repeat(spacing, CREASE_POINTS, axis=2).reshape(points_px.shape[:2])
