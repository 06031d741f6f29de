"""Solids on a known table, of which the images show a part clearly: the table says where the rest ends.

A lit top tells all of a standing part but its height, and the table tells that. What remains is to see whether the
edges that such a solid must have are there in both views.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from stereo_pick.core.arrays import Floats
from stereo_pick.core.edges.flush import resting
from stereo_pick.core.edges.growing import shown_parts
from stereo_pick.core.edges.hypotheses import Images
from stereo_pick.core.edges.shared_face import shared_face
from stereo_pick.core.edges.supported import CHANCE, Supported
from stereo_pick.core.shapes.common_table import stands_on
from stereo_pick.core.shapes.fitting import Pair, can_be_fitted, nearest_of_kind
from stereo_pick.core.shapes.kinds import BOX, KINDS, SPHERE
from stereo_pick.core.shapes.solid_fit import SolidFit
from stereo_pick.core.shapes.solids import Solids
from stereo_pick.core.shapes.table import Table

_UPRIGHT = np.cos(np.deg2rad(25))  # of an axis that the outlines alone put so near to upright
_OPEN = 0.25  # of a solid's size by which a rival's centre may be off
_AGREE = 7.8  # squared sigmas, in three dimensions
_TINY = 1e-12
_FOOT = 0.5  # part of what a body has below its top, and of its far end, that must lie on edges
_HALF = 1 / 2  # of a silhouette


def standing(images: Images, pairs: Sequence[Pair], table: Table) -> list[Supported | None]:
    """For each object's outlines, the solid on the table with the most support among those that they hint at; None
    where there is none to believe in."""
    candidates = _candidates(images, [pair for pair in pairs if can_be_fitted(pair)], table)
    images.all_locked([solid for several in candidates.values() for solid in several], table)
    found = [most_supported(images, candidates.get(pair, []), table) for pair in pairs]
    return [each or _below_face(images, pair, table) for each, pair in zip(found, pairs)]


def standing_candidates(images: Images, pair: Pair, table: Table) -> list[Solids]:
    """The solids on the table that an object's outlines hint at."""
    return _candidates(images, [pair], table)[pair] if can_be_fitted(pair) else []


def exactly(images: Images, candidates: Sequence[Solids], table: Table | None) -> list[Supported]:
    """Those that lie on their edges exactly; the best first."""
    found = images.all_locked(candidates, table)
    return sorted((each for each in found if each.is_exact), key=lambda each: -each.score)


def nearly(images: Images, candidates: Sequence[Solids], table: Table) -> list[Supported]:
    """Those that edges beside them hint at, more of which may show once all have their say; the best first."""
    found = images.all_locked(candidates, table)
    return sorted((each for each in found if each.raises_doubt), key=lambda each: -each.score)


def most_shown(images: Images, candidates: Sequence[Solids], table: Table) -> list[Supported]:
    """Those of which more than half shows; the best first."""
    found = images.all_locked(candidates, table)
    return sorted((each for each in found if each.support > _HALF), key=lambda each: -each.support)


def _below_face(images: Images, pair: Pair, table: Table) -> Supported | None:
    """The body from the lit top that the outlines share down to the table.

    Where the top is known and the table is, too, faint sides will do, if the edges are there at which it stands.
    """
    face = shared_face(pair, images.rig, images.maps, table)
    if face is None:
        return None
    tops = [images.of_kind(face, kind)[0] for kind in KINDS.values() if kind is not SPHERE]
    bodies = [(top, body) for top in tops for body in (down_to(top, table),) if body is not None]
    found = images.all_locked([body for _, body in bodies], table)
    seen = [each for each, (top, _) in zip(found, bodies) if each.raises_doubt and _shows_foot(images, each, top)]
    return max(seen, key=lambda each: each.score, default=None)


def _shows_foot(images: Images, body: Supported, top: Solids) -> bool:
    return float(shown_parts(body.fit.solid, top, images.eyes_m, images.maps)[0]) > _FOOT


def standing_alike(
    images: Images, pairs: Sequence[Pair], fits: Sequence[SolidFit], table: Table
) -> list[Supported | None]:
    """The same of objects that solids explain already: these, others of the same kinds, and below the same tops."""
    candidates = []
    for pair, fit in zip(pairs, fits):
        kind = KINDS[fit.kind]
        on_table = [nearest_of_kind([pair], images.rig, kind, table)[pair, kind][0]] if can_be_fitted(pair) else []
        itself = [set_down(fit.solid, table)] if stands_on(table, fit) else []
        below = down_to(fit.solid, table)
        candidates.append([*on_table, *itself, *([] if below is None else [below])])
    images.all_locked([solid for several in candidates for solid in several], table)
    return [most_supported(images, several, table) for several in candidates]


def most_supported(images: Images, candidates: Sequence[Solids], table: Table | None) -> Supported | None:
    """The solid of these, or longer than these, that the edges show best; None where none is to be believed.

    A piece of a solid has the support of the sides that it shares with the whole: what goes on further, with as much
    support, is the whole.
    """
    found = [each for each in images.all_locked(candidates, table) if each.believable]
    best = max(found, key=lambda each: each.score, default=None)
    if best is None:
        return None
    longer = images.longer(best.fit.solid, table)
    if longer is None or longer.support < best.support - CHANCE:
        return no_surer_than_rivals(best, found)
    return longer if longer.believable else None


def no_surer_than_rivals(best: Supported, others: Sequence[Supported]) -> Supported | None:
    """The same, its centre as unsure as it is which of several solids it is that are supported about as well and do not
    agree with it; None where that leaves its place open."""
    rivals = [each for each in others if each.score > best.score - CHANCE and not agree(each.fit, best.fit)]
    offs_m = [each.fit.centre_m - best.fit.centre_m for each in rivals]
    off_m = max(offs_m, key=lambda off: float(off @ off), default=np.zeros(3))
    if np.linalg.norm(off_m) > _OPEN * best.fit.size_m.mean():
        return None
    return replace(best, doubt=float(off_m @ off_m) * np.eye(3))  # it may be neither of them


def agree(one: SolidFit, other: SolidFit) -> bool:
    """Whether two solids are at one place, as far as that is known."""
    off_m = one.centre_m - other.centre_m
    return bool(off_m @ np.linalg.solve(one.covariance + other.covariance, off_m) < _AGREE)


def _candidates(images: Images, pairs: Sequence[Pair], table: Table) -> dict[Pair, list[Solids]]:
    found: dict[Pair, list[Solids]] = {pair: [] for pair in pairs}
    for kind in KINDS.values() if pairs else ():
        on_table = nearest_of_kind(pairs, images.rig, kind, table)
        if kind is not SPHERE:
            images.search(pairs, kind)
        for pair, solids in found.items():
            solids.append(on_table[pair, kind][0])
            lengthened = None if kind is SPHERE else down_to(images.of_kind(pair, kind)[0], table)
            if lengthened is not None:
                solids.append(lengthened)
    return found


def down_to(solid: Solids, table: Table) -> Solids | None:
    """The solid (S = 1) set upright, from its top down to the table.

    None where none of its axes is nearly upright, or its top is not above the table.
    """
    kind, axes = solid.kind, solid.rotation[0].T
    axis = int(np.abs(axes @ table.normal).argmax()) if kind is BOX else 2
    up = axes[axis] * np.sign(axes[axis] @ table.normal)
    if up @ table.normal < _UPRIGHT:
        return None
    half_m = solid.half_m[0].copy()
    which = kind.axes[axis]
    top_m = solid.centre_m[0] + up * half_m[which]
    height_m = float(table.height_m(top_m))
    if height_m <= 0:
        return None
    half_m[which] = height_m / 2
    rotation = _shortest_turn(up, table.normal) @ solid.rotation[0]
    centre_m = top_m - table.normal * height_m / 2
    found = Solids(kind, centre_m[None], rotation[None], half_m[None], np.zeros((1, 3, 0)))
    return found.turning_about(table.normal)


def set_down(solid: Solids, table: Table) -> Solids:
    """The solid (S = 1), which nearly stands or lies on a table, turned and moved as little as need be to do so."""
    own, flat = resting(solid.kind, table.normal @ solid.rotation)
    axis = solid.rotation[0] @ own[0]
    level = axis - table.normal * (axis @ table.normal)
    to = table.normal if flat[0] else level / max(float(np.linalg.norm(level)), _TINY)
    turned = replace(solid, rotation=_shortest_turn(axis, to) @ solid.rotation)
    return table.put_down(turned.turning_about(table.normal))


def _shortest_turn(one: Floats, other: Floats) -> Floats:
    """The rotation (3, 3) that turns one unit vector (3,) to another, less than 180 degrees away."""
    axis = np.cross(one, other)
    x, y, z = axis
    across = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.asarray(np.eye(3) + across + across @ across / (1 + one @ other))
