"""What the edges of both views say of solids: those beside their silhouettes, and those of their creases."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import NamedTuple

import numpy as np

from stereo_pick.core.arrays import Bools, Floats
from stereo_pick.core.edges.arcs import Arcs, arcs_of
from stereo_pick.core.edges.creases import POINTS as CREASE_POINTS
from stereo_pick.core.edges.creases import creases
from stereo_pick.core.edges.edge_map import EdgeMap
from stereo_pick.core.edges.edge_rows import CreaseRows, EdgeRows
from stereo_pick.core.edges.locking import ON_EDGE_PX, Beside, Limbs, edges_beside, trust
from stereo_pick.core.edges.own_shadow import heights
from stereo_pick.core.edges.rounding import however_rounded, rounding_px
from stereo_pick.core.edges.stretches import stretches_found
from stereo_pick.core.objects.edge_model import OFFSETS_PX
from stereo_pick.core.rig import StereoRig
from stereo_pick.core.sampling import places_along, sampled
from stereo_pick.core.shapes.kinds import cross, dot
from stereo_pick.core.shapes.nearest import nearest_tangents
from stereo_pick.core.shapes.occluders import Hide, Occluders, share_seen
from stereo_pick.core.shapes.predicted import inside, silhouettes
from stereo_pick.core.shapes.refinement import robust_scale
from stereo_pick.core.shapes.residuals import residuals
from stereo_pick.core.shapes.sight import in_pixels, turning
from stereo_pick.core.shapes.solids import Solids
from stereo_pick.core.shapes.table import Table

_POINTS = 120  # of a silhouette
_CLEAR_PX = 3.0  # from the silhouette, nearer than which its edge is in the way of a crease's
_REACH_PX = 1.15  # the farthest edge that is found
_TINY = 1e-12
_STILL = np.zeros(2)


class EdgeEvidence(NamedTuple):
    """normal: (S, P + 2, P + 2) and right: (S, P + 2), the normal equations of a step, by their noise, of the solids
    and, last, of the right camera about its x and z axis [rad]; scale_px: (S,), robust standard
    deviation of the distances; shown, creased: (S,), the part of the silhouettes (the least of both views)
    and of the creases (1 where there are none) that lies on edges; has_creases: (S,), whether there are any; denied:
    (S,), the part of the silhouettes (the most of both views) of which the edges lie beside it."""

    normal: Floats
    right: Floats
    scale_px: Floats
    shown: Floats
    creased: Floats
    has_creases: Bools
    denied: Floats


class Seen(NamedTuple):
    """What is seen beside solids (S) and across them; slid: the creases' edges once each crease has slid; scale_px:
    (S,), robust standard deviation of all their distances; shown, denied: (S,), the part of the silhouettes (the least
    and the most of both views) that lies on edges, and clearly beside such; arcs: how far these lie off them; found:
    (S, M), by how much less a point of the silhouette counts as that is not found around it."""

    outer: EdgeRows
    inner: CreaseRows
    slid: EdgeRows
    scale_px: Floats
    shown: Floats
    denied: Floats
    arcs: Arcs
    found: Floats

    def evidence(self, sigma_px: Floats, edge_radius_m: float = 0.0) -> EdgeEvidence:
        """What that says of them, if light moves arcs by so much (S,), and edges may be rounded so far."""
        normal, right = self.outer.equations(self.found * self.outer.weights(self.scale_px, sigma_px))
        more, more_right = self.inner.equations(self.slid.weights(self.scale_px, sigma_px))
        there = np.asarray(self.inner.there.any(axis=1))
        creased = self.inner.shown()
        normal, right = however_rounded(normal + more, right + more_right, edge_radius_m)
        return EdgeEvidence(normal, right, self.scale_px, self.shown, creased, there, self.denied)


def edges_seen(
    groups: Sequence[Solids],
    views: Sequence[EdgeMap],
    rig: StereoRig,
    turn_rad: Floats = _STILL,
    hides: Sequence[Hide] = (),
    shaded_on: Table | None = None,
) -> list[Seen]:
    """What two rectified views show beside and across the solids (S) of groups of one kind each; turn_rad: (2,), how
    the right camera has turned; hides: for each group, which of its places (S, N, 2), normalized, in a view are hidden
    (S, N); none, unless given. shaded_on: the table, if their own shadows on it may hide where they end.

    Where two faces meet parts are rounded, and it is a matter of the light where on the round the edge appears: each
    crease may slide, as one in both views.
    """
    hides = hides or [_hide_nothing] * len(groups)
    corners = [silhouettes(solids, rig.eyes_m) for solids in groups]
    found = []
    high = [heights(solids, rig.eyes_m, shaded_on) for solids in groups] if shaded_on else []
    for solids, at, beside, hide in zip(groups, corners, _beside(groups, corners, views, rig, hides, high), hides):
        outer, inner = _silhouettes(solids, beside, rig), _creases(solids, at, views, rig, hide)
        found.append(_seen(outer.turned(turn_rad), inner.turned(turn_rad), beside.hidden, views[0].is_exact))
    return found


def creases_shown(
    solids: Solids, views: Sequence[EdgeMap], rig: StereoRig, occluders: Occluders | None = None
) -> Floats:
    """The part (S,) of the creases of solids that lies on edges, the least of both views; 0 where a view has none."""
    hide = partial(occluders.hide, solids) if occluders else _hide_nothing
    corners = silhouettes(solids, rig.eyes_m)
    sides = _creases_in_each(solids, corners, views, rig, hide)
    return np.asarray(np.min([np.where(each.there.any(axis=1), each.shown(), 0.0) for each in sides], axis=0))


def _hide_nothing(places: Floats, view: int) -> Bools:
    return np.zeros(places.shape[:2], bool)


def _seen(outer: EdgeRows, inner: CreaseRows, hidden: Bools, is_exact: bool) -> Seen:
    slid = inner.at_edges()
    scale = _scale_px(outer, slid)
    in_views = (len(scale), 2, -1)
    shown = share_seen(outer.on_edge().reshape(in_views), hidden).min(axis=1)
    denied = share_seen(outer.beside_edge().reshape(in_views), hidden).max(axis=1)
    near = (outer.weight * outer.nearness(scale)).reshape(in_views)
    length_px = outer.length_px.reshape(in_views).sum(axis=2)
    arcs = arcs_of(outer.residual_px.reshape(in_views), near, length_px, outer.jacobian.shape[2] - 3)
    across = outer.jacobian[..., :3].reshape(*near.shape, 3)
    found = stretches_found(across, near, ~hidden) if is_exact else np.ones(near.shape)
    return Seen(outer, inner, slid, scale, shown, denied, arcs, found.reshape(outer.weight.shape))


def _scale_px(outer: EdgeRows, inner: EdgeRows) -> Floats:
    residual = np.concatenate([outer.residual_px, inner.residual_px], axis=1)
    scale = robust_scale(residual, np.concatenate([outer.weight, inner.weight], axis=1))
    return np.where(np.isfinite(scale), scale, ON_EDGE_PX)


def _beside(
    groups: Sequence[Solids],
    corners: Sequence[Floats],
    views: Sequence[EdgeMap],
    rig: StereoRig,
    hides: Sequence[Hide],
    high: Sequence[Floats],
) -> list[Beside]:
    """The edges next to the silhouettes (S, 2, K, 2) of each group, with these heights (S, 2, K) if any are given:
    looked for at once, since they are so few."""
    ends = np.cumsum([len(each) for each in corners])[:-1]

    def hide(places: Floats, view: int) -> Bools:
        return np.concatenate([of_group(each, view) for of_group, each in zip(hides, np.split(places, ends))])

    limbs = Limbs(*(np.concatenate(each) for each in zip(*(Limbs.of(each, rig) for each in groups))))
    height = np.concatenate(high) if high else None
    found = edges_beside(np.concatenate(corners), limbs, views, _POINTS, hide=hide, height=height)
    return [Beside(*of_group) for of_group in zip(*(np.split(each, ends) for each in found))]


def _silhouettes(solids: Solids, beside: Beside, rig: StereoRig) -> EdgeRows:
    sight = beside.sight(rig)
    residual, jacobian = residuals(sight, solids, nearest_tangents(sight, solids))
    ahead = np.diff(sight.points, axis=2, append=sight.points[:, :, :1]) * rig.focal_px
    around_px = np.median(np.sqrt(dot(ahead, ahead)), axis=2)
    length_px = np.repeat(around_px, _POINTS, axis=1)
    weight = sight.weight.reshape(residual.shape)
    by_turns = np.zeros((*residual.shape, 2))
    by_turns[:, _POINTS:] = _turning_px(sight.points[:, 1], sight.normals[:, 1], rig.focal_px)
    columns = [jacobian, rounding_px(jacobian, solids.kind.sizes)[..., None], by_turns]
    return EdgeRows(residual, np.concatenate(columns, axis=2), weight, length_px)


def _turning_px(points: Floats, normals: Floats, focal_px: float) -> Floats:
    """How much further (..., 2) [px/rad] something reaches beyond edges of the right view when its camera has turned
    about its x or its z axis; at normalized points (..., 2) with normals (..., 2)."""
    return -focal_px * np.stack([dot(normals, moved) for moved in turning(points)], axis=-1)


def _creases(solids: Solids, corners: Floats, views: Sequence[EdgeMap], rig: StereoRig, hide: Hide) -> CreaseRows:
    sides = _creases_in_each(solids, corners, views, rig, hide)
    rows = EdgeRows(*(np.concatenate(each, axis=1) for each in zip(*(side.rows for side in sides))))
    slides, there, hidden = (np.concatenate(each, axis=1) for each in zip(*(side[1:] for side in sides)))
    return CreaseRows(rows, slides, there, hidden)


def _creases_in_each(
    solids: Solids, corners: Floats, views: Sequence[EdgeMap], rig: StereoRig, hide: Hide
) -> list[CreaseRows]:
    return [_creases_in(solids, corners[:, i], rig.eyes_m[i], view, i, hide) for i, view in enumerate(views)]


def _creases_in(solids: Solids, corners: Floats, eye_m: Floats, view: EdgeMap, side: int, hide: Hide) -> CreaseRows:
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
    hidden = hide(image, side)
    offset, weight = _measured(view, in_pixels(image, view.camera), normals, seen & ~hidden)
    # How a point's image moves across its crease with the point: (S, K, 3).
    across = np.concatenate([normals, -dot(image, normals)[..., None]], axis=2) * focal / depth_m
    turned = across @ solids.rotation
    turns = cross(own, turned) @ solids.turns
    sizes = (own * turned) @ (solids.kind.shares / solids.half_m[:, None])
    by_turns = _turning_px(image, normals, focal) * side  # of the right camera
    rounding = np.zeros((*offset.shape, 1))  # a crease slides
    jacobian = np.concatenate([across, turns, sizes, rounding, by_turns], axis=2)
    rows = EdgeRows(offset, jacobian, weight, _spacing_px(image * focal))
    clear = seen & (inside(image, corners) * focal > _CLEAR_PX)
    return CreaseRows(rows, dot(turned, inner.slide[:, 0]), clear, hidden)


def _measured(view: EdgeMap, points_px: Floats, normals: Floats, seen: Bools) -> tuple[Floats, Floats]:
    """How far (S, K) [px] beyond an edge each point that is seen lies along its normal, and the trust in that edge."""
    offset, weight = np.zeros(seen.shape), np.zeros(seen.shape)
    if not seen.any():
        return offset, weight
    edges = view.edges(sampled(view.image, places_along(points_px[seen], normals[seen], -OFFSETS_PX)))
    offset[seen] = edges.place_px
    weight[seen] = np.where(np.abs(edges.place_px) < _REACH_PX, trust(edges, view.noise), 0.0)
    return offset, weight


def _spacing_px(points_px: Floats) -> Floats:
    """How far (S, K) apart the points of each crease lie."""
    several = points_px.reshape(len(points_px), -1, CREASE_POINTS, 2)
    ahead = several[:, :, 1:] - several[:, :, :-1]
    spacing = np.sqrt(dot(ahead, ahead)).mean(axis=2, keepdims=True)
    return np.repeat(spacing, CREASE_POINTS, axis=2).reshape(points_px.shape[:2])
