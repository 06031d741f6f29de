"""A solid brought to lie on the edges next to its predicted silhouette (as in Harris and Stennett 1990)."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import NamedTuple

import numpy as np

from stereo_pick.core.arrays import Bools, Floats
from stereo_pick.core.edges.edge_map import NOISE_OF_PIXELS, EdgeMap
from stereo_pick.core.edges.fading_limb import SIGMA_PX, fading_limbs
from stereo_pick.core.edges.foot import shadow_px
from stereo_pick.core.edges.own_shadow import heights, in_own_shadow
from stereo_pick.core.objects.edge_model import OFFSETS_PX, Edges
from stereo_pick.core.rig import StereoRig
from stereo_pick.core.sampling import places_along, sampled
from stereo_pick.core.shapes.kinds import Round
from stereo_pick.core.shapes.occluders import Occluders, share_seen
from stereo_pick.core.shapes.outline import POINTS
from stereo_pick.core.shapes.predicted import along_polygon, silhouettes, values_along
from stereo_pick.core.shapes.refinement import Fitted, fitted, refine
from stereo_pick.core.shapes.sight import Sight, in_pixels
from stereo_pick.core.shapes.solids import Solids
from stereo_pick.core.shapes.table import Table

_ROUNDS = 4
_SHIFTS_PX = (0.0, -1.2, 1.2)
_MIDDLE_PX = 0.5  # so that edges are looked for farther outside than inside, where a part has creases of its own
# One sigma of the place of a step as high as the gradient's noise, by the root of its blur: the least there can be
# (Cramér and Rao), and 1.45 times that since the levels beside it are not known either.
_NOISE_PX = 1.45 * float(np.sqrt(2 * np.sqrt(np.pi))) * NOISE_OF_PIXELS
_MIN_STEP = 4.0  # noise sigmas
_MIN_SHARPNESS = 0.25
_UNSURE_PX = 0.25  # sigma of a place that counts for half
ON_EDGE_PX = 0.6
_FADING = 0.2  # trust in a limb that fades: half a pixel, by `_UNSURE_PX`
_LEAST_HELD = 8  # points on edges, in each view, without which a solid stays where it is


@dataclass(frozen=True, eq=False)
class Locked:
    """fit: solids (S) and their residuals on the edges; shown: (S, 2), the share of each one's silhouette in each view
    that lies on an edge; sigma_px: (S, 2N), by how much the noise of the pixels alone moves each of these edges."""

    fit: Fitted
    shown: Floats
    sigma_px: Floats


def lock(
    solids: Solids,
    views: Sequence[EdgeMap],
    rig: StereoRig,
    table: Table | None = None,
    occluders: Occluders | None = None,
) -> Locked:
    """Refine solids, each by itself, on the edges of the two rectified views near its silhouette, of either sign.

    occluders: what hides a part of it.
    """
    for round_ in range(_ROUNDS + 1):
        corners = silhouettes(solids, rig.eyes_m)
        shifts_px = _SHIFTS_PX if round_ == 0 else (0.0,)
        hide = partial(occluders.hide, solids) if occluders else None
        beside = edges_beside(corners, Limbs.of(solids, rig), views, POINTS, shifts_px, hide)
        sight = beside.sight(rig, table)
        now = fitted(sight, solids)
        held = np.flatnonzero(sight.weight.sum(axis=2).min(axis=1) >= _LEAST_HELD)
        if round_ == _ROUNDS or not len(held):
            break
        solids = solids.replaced(held, refine(sight.only(held), now.only(held), rounds=3).solids)
    return _locked(now, beside)


def seen_in_shadow(
    solids: Solids, views: Sequence[EdgeMap], rig: StereoRig, table: Table, occluders: Occluders | None = None
) -> Locked:
    """The same of solids where they are, their own shadows on the table being what may hide where they end: edges of
    these would draw them along."""
    corners, height = silhouettes(solids, rig.eyes_m), heights(solids, rig.eyes_m, table)
    hide = partial(occluders.hide, solids) if occluders else None
    beside = edges_beside(corners, Limbs.of(solids, rig), views, POINTS, hide=hide, height=height)
    return _locked(fitted(beside.sight(rig, table), solids), beside)


def _locked(now: Fitted, beside: Beside) -> Locked:
    shown = share_seen(beside.off_px < ON_EDGE_PX, beside.hidden)
    return Locked(now, shown, beside.sigma_px.reshape(len(shown), -1))


class Limbs(NamedTuple):
    """Which of S solids are limbs all around (S,), as balls are; and of which (S,) a limb may fade to what is behind:
    they are round, and so thick that what is looked at inside of it lies before their middle."""

    all_around: Bools
    fade: Bools

    @staticmethod
    def of(solids: Solids, rig: StereoRig) -> Limbs:
        """Those of solids of one kind."""
        radius_px = solids.half_m[:, 0] * rig.focal_px / solids.centre_m[:, 2]
        return Limbs(solids.is_ball, (radius_px > OFFSETS_PX[-1]) & isinstance(solids.kind, Round))


class Beside(NamedTuple):
    """The edges next to N points of each silhouette in both views.

    points_px, normals: (S, 2, N, 2); trust: (S, 2, N); off_px: (S, 2, N), how far they lie off the silhouette, infinite
    where there is none; sigma_px: (S, 2, N); hidden: (S, 2, N), where an edge would be.
    """

    points_px: Floats
    normals: Floats
    trust: Floats
    off_px: Floats
    sigma_px: Floats
    hidden: Bools

    def sight(self, rig: StereoRig, table: Table | None = None) -> Sight:
        """The edges as outlines without corners."""
        return Sight.of_points(self.points_px, self.normals, self.trust, np.ones(self.trust.shape), rig, table)


def edges_beside(
    corners: Floats,
    limbs: Limbs,
    views: Sequence[EdgeMap],
    points: int,
    shifts_px: Sequence[float] = (0.0,),
    hide: Callable[[Floats, int], Bools] | None = None,
    height: Floats | None = None,
) -> Beside:
    """The edges next to so many points of silhouettes (S, 2, K, 2).

    limbs: which parts of them are limbs; shifts_px: where along each normal they are looked for; hide:
    which places (S, N, 2), normalized, of a view are hidden (S, N); height: (S, 2, K), of the corners, as of `heights`,
    where what ends in its own shadow counts as hidden, too, unless an edge is seen there.
    """
    places, normals = (
        each.reshape(*corners.shape[:2], points, 2)
        for each in along_polygon(corners.reshape(-1, *corners.shape[2:]), points)
    )
    sides = []
    for i, view in enumerate(views):
        pixels, across = in_pixels(places[:, i], view.camera), normals[:, i]
        offset, weight, sigma = _edges_near(view, pixels, across, shifts_px, limbs)
        hidden = hide(places[:, i], i) if hide else np.zeros(weight.shape, bool)
        if height is not None:
            on_edge = (weight > 0) & (np.abs(offset) < ON_EDGE_PX)
            high = values_along(corners[:, i], height[:, i], points)
            hidden = hidden | (in_own_shadow(view.image, pixels, across, high) & ~on_edge)
        weight[hidden] = 0.0
        off = np.where(weight > 0, np.abs(offset), np.inf)
        sides.append((pixels - offset[..., None] * across, across, weight, off, sigma, hidden))
    return Beside(*(np.stack(each, axis=1) for each in zip(*sides)))


def _edges_near(
    view: EdgeMap, points_px: Floats, normals: Floats, shifts_px: Sequence[float], limbs: Limbs
) -> tuple[Floats, Floats, Floats]:
    """Offset (S, N) [px, inwards] of the clearest edge near each point (S, N, 2), the trust in it, and its sigma [px].

    Where that is the outer edge of a narrow shadow, the part ends behind it. But a dark ball darkens further towards
    its limb, which looks like one all around: it ends where more of these edges lie.
    """
    shape, noise, blur_px = points_px.shape[:-1], view.noise, view.modelled_blur_px
    points_px, normals = points_px.reshape(-1, 2), normals.reshape(-1, 2)
    best = np.zeros((3, len(points_px)))  # offset, trust, step
    straight = np.empty((0, len(OFFSETS_PX)))
    solid = np.repeat(np.arange(shape[0]), shape[1])
    for shift in shifts_px:
        inwards = OFFSETS_PX - _MIDDLE_PX + shift
        profiles = view.together(sampled(view.image, places_along(points_px, normals, -inwards)), shape[1])
        straight = profiles if shift == 0 else straight
        edges = view.edges(profiles, solid)
        offset = edges.place_px - _MIDDLE_PX + shift
        best = np.where(np.abs(edges.step) > np.abs(best[2]), [offset, trust(edges, noise), edges.step], best)
    darker = np.flatnonzero((best[2] < 0) & (best[1] > 0))
    outer_px = best[0, darker]
    edges_px = points_px[darker] - outer_px[:, None] * normals[darker]
    inner_px = outer_px + shadow_px(view.image, edges_px, -normals[darker], -best[2, darker], noise)
    part = solid[darker]
    on_outer, on_inner = (np.bincount(part, np.abs(px) < ON_EDGE_PX, shape[0]) for px in (outer_px, inner_px))
    best[0, darker] = np.where((limbs.all_around & (on_outer > on_inner))[part], outer_px, inner_px)
    together = view.noise_together
    sigma_px = _NOISE_PX * np.sqrt(blur_px) * together / np.maximum(np.abs(best[2]), together)
    faint = np.flatnonzero((best[1] == 0) & limbs.fade[solid] & view.fading_limbs)
    fading_px = _fading_px(view, straight[faint])
    there = np.abs(fading_px) < ON_EDGE_PX
    best[0, faint[there]], best[1, faint[there]], sigma_px[faint[there]] = fading_px[there], _FADING, SIGMA_PX
    return best[0].reshape(shape), best[1].reshape(shape), sigma_px.reshape(shape)


def _fading_px(view: EdgeMap, profiles: Floats) -> Floats:
    """How far inwards (N,) [px] limbs are that fade in profiles across silhouettes; infinite where there is none."""
    place_px, found = fading_limbs(profiles, view.modelled_blur_px)
    return np.asarray(np.where(found, place_px - _MIDDLE_PX, np.inf))


def trust(edges: Edges, noise: float) -> Floats:
    """How far (N,) each is an edge: 0 where it is no clear one; less, the less sure its place is."""
    sharp = np.abs(edges.sharpness)
    clear = (np.abs(edges.step) > _MIN_STEP * noise) & (sharp > _MIN_SHARPNESS)
    sure = 1 / (1 + (edges.spread_px / _UNSURE_PX) ** 2)
    return np.asarray(np.where(clear, np.minimum(1.5 * sharp, 1.0) * sure, 0.0))
