"""Solids of which the outlines show a part only: the rest found by the edges that it must have.

A side as bright as the table leaves no outline, only the faint edges around it. A solid that was fitted to the bright
part is stretched, away from each of its faces, until its new silhouette lies on edges in both views.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from stereo_pick.core.arrays import Floats
from stereo_pick.core.edges.edge_map import EdgeMap
from stereo_pick.core.shapes.kinds import HEX_PRISM, SPHERE
from stereo_pick.core.shapes.occluders import Occluders
from stereo_pick.core.shapes.predicted import along_polygon, inside, silhouettes
from stereo_pick.core.shapes.sight import in_pixels
from stereo_pick.core.shapes.solids import Solids
from stereo_pick.core.shapes.table import Table

_STEP_PX = 3.0
_NEW_PX = 4.0  # how far a point lies outside the old silhouette to be one of the new part
_LEAST = 0.15  # of the size of the part that was seen, and ...
_LEAST_PX = 6.0  # ... in pixels: the shadow where an object stands has edges, too
FAR = 0.7  # part of the greatest such distance: the far end tells the length, the sides are there for any
_POINTS_TO_SEE = 12  # a twelfth of a silhouette must be new
_LEVEL = 0.5  # sine of the angle by which an axis that lies on the table may be off
_TOGETHER = 3  # lengths of which only the middle one is looked at first
_FARTHEST = 1.6  # times the size of the part that was seen


class _Look(NamedTuple):
    """At how many points of a silhouette, how far to either side of it, and what part of the new silhouette must lie
    on edges: by chance one in ten points does."""

    points: int
    reach_px: float
    enough: float


_FEW, _ALL = _Look(24, 1.5 + _STEP_PX, 0.5), _Look(72, 1.5, 0.75)


def grown(
    solid: Solids,
    eyes_m: Floats,
    views: Sequence[EdgeMap],
    table: Table | None = None,
    occluders: Occluders | None = None,
) -> Solids | None:
    """The stretched solid whose new silhouette the views show best, or None where none shows; solid: S = 1. occluders:
    what hides a part of it.

    Where there is nothing around the object, a few lengths seen by one eye show that already. What is left of a
    hexagonal prism without one of its sides is no such prism: only its bare face can be part of a longer one.
    """
    if solid.kind is SPHERE or (solid.kind is HEX_PRISM and not _is_face(solid)):
        return None
    ways = ways_along(solid, table)
    if not ways:
        return None
    old = silhouettes(solid, eyes_m)[0]
    lengths_m = _lengths_m(solid, views[0])
    few = stretched_by(solid, ways, lengths_m[_TOGETHER // 2 :: _TOGETHER])
    share, _ = _shown(few, old, eyes_m, views, 0, _FEW, occluders)
    likely = np.repeat((share >= _FEW.enough).reshape(-1, len(lengths_m) // _TOGETHER), _TOGETHER, axis=1)
    if not likely.any():
        return None
    candidates = stretched_by(solid, ways, lengths_m).only(np.flatnonzero(likely))
    share, count = np.ones(len(candidates.centre_m)), np.zeros(len(candidates.centre_m))
    for i in range(len(views)):
        part, points = _shown(candidates, old, eyes_m, views, i, _ALL, occluders)
        left = np.flatnonzero(part >= _ALL.enough)
        if not len(left):
            return None
        candidates = candidates.only(left)
        share, count = np.minimum(share, part)[left], (count + points)[left]
    best = candidates.only(np.array([(share + count / (4 * _ALL.points)).argmax()]))
    return best.turning_about(table.normal) if table else best.turning_freely()


def shown_parts(solids: Solids, face: Solids, eyes_m: Floats, views: Sequence[EdgeMap]) -> Floats:
    """The part (S,) of each solid's silhouette outside that of their face (S = 1) which lies on edges, and of its far
    end: the least of both views."""
    old = silhouettes(face, eyes_m)[0]
    seen = [_shown(solids, old, eyes_m, views, i, _ALL)[0] for i in range(len(views))]
    return np.asarray(np.min(seen, axis=0))


def _shown(
    solids: Solids,
    old: Floats,
    eyes_m: Floats,
    views: Sequence[EdgeMap],
    side: int,
    look: _Look,
    occluders: Occluders | None = None,
) -> tuple[Floats, Floats]:
    """The part (S,) of each solid's silhouette outside the old one (E, K, 2) that one view shows, as far as it is not
    hidden, and on how many points; side: which view."""
    view = views[side]
    focal = view.camera.P[0, 0]
    points, normals = along_polygon(silhouettes(solids, eyes_m[side : side + 1])[:, 0], look.points)
    distance_px = -inside(points, old[side][None]) * focal
    fresh = distance_px > _NEW_PX
    if occluders is not None:
        fresh &= ~occluders.hide(solids, points, side)
    far = fresh & (distance_px > FAR * distance_px.max(axis=1, keepdims=True))
    pixels, total = in_pixels(points, view.camera), fresh.sum(axis=1)
    enough = total * _POINTS_TO_SEE >= look.points
    shown = view.shows(pixels, normals, look.reach_px, fresh & enough[:, None])
    found = shown.sum(axis=1)
    ends = (shown & far).sum(axis=1) / np.maximum(far.sum(axis=1), 1)
    return np.where(enough, np.minimum(found / np.maximum(total, 1), ends), 0.0), found


def is_longer(one: Solids, other: Solids, focal_px: float) -> bool:
    """Whether one solid (S = 1) is so much larger than another of its kind that it shows another part."""
    longer_m = 2 * float((one.half_m - other.half_m).max())
    return longer_m > least_change_m(other, float(other.centre_m[0, 2]) / focal_px)


def least_change_m(solid: Solids, m_per_px: float) -> float:
    """By how much [m] a solid must differ in length to show another part."""
    return max(_LEAST * 2 * float(solid.half_m.max()), _LEAST_PX * m_per_px)


def _lengths_m(solid: Solids, view: EdgeMap) -> Floats:
    """By how much a solid may be longer, in steps of some pixels: a multiple of those looked at together, and no more
    than what a view can show at the solid's distance."""
    m_per_px = float(solid.centre_m[0, 2]) / view.camera.P[0, 0]
    step_m, least_m = _STEP_PX * m_per_px, least_change_m(solid, m_per_px)
    shown_m = float(np.hypot(*view.image.shape)) * m_per_px
    farthest_m = max(min(_FARTHEST * 2 * float(solid.half_m.max()), shown_m), 4 * step_m)
    groups = max(np.ceil((farthest_m - least_m) / (step_m * _TOGETHER)), 1)
    return np.asarray(least_m + step_m * np.arange(1, groups * _TOGETHER + 1))


def ways_along(solid: Solids, table: Table | None) -> list[tuple[int, float]]:
    """The axes along which a solid may go on, and to which side: not up from a known table, nor down into it."""
    axes = [2] if solid.kind.sizes == 2 else [0, 1, 2]
    if table is not None:
        axes = [axis for axis in axes if abs(float(solid.rotation[0, :, axis] @ table.normal)) < _LEVEL]
    return [(axis, sign) for axis in axes for sign in (1.0, -1.0)]


def stretched_by(solid: Solids, ways: Sequence[tuple[int, float]], lengths_m: Floats) -> Solids:
    """The solid made longer by these lengths (L,) along these of its own axes, to these sides: length by length."""
    kind = solid.kind
    longer = np.array([np.arange(kind.sizes) == kind.axes[axis] for axis, _ in ways])
    towards = np.array([sign * solid.rotation[0, :, axis] for axis, sign in ways])
    half = solid.half_m + longer[:, None] * lengths_m[:, None] / 2
    centre = solid.centre_m + towards[:, None] * lengths_m[:, None] / 2
    every = len(ways) * len(lengths_m)
    rotation = np.repeat(solid.rotation, every, axis=0)
    return Solids(kind, centre.reshape(-1, 3), rotation, half.reshape(-1, kind.sizes), np.zeros((every, 3, 0)))


def _is_face(solid: Solids) -> bool:
    return float(solid.half_m.min()) < _LEAST * float(solid.half_m.max())
