"""Where a solid's silhouette comes nearest to the points of an outline.

Normals taken from the outline itself would not do in the end: half a side's length away from where it touches, a
tangent that is off by its noise lies inside the solid, in whichever direction it is off. The distance of a point from
a convex figure is the largest of its distances from the figure's tangents: the nearest tangent is sought here.
"""

from __future__ import annotations

import numpy as np

from stereo_pick.core.arrays import Floats, Ints
from stereo_pick.core.shapes.kinds import SPHERE, Prism, Round, dot
from stereo_pick.core.shapes.residuals import Tangents
from stereo_pick.core.shapes.sight import Sight
from stereo_pick.core.shapes.solids import Solids

_SIDES = 24
_NEXT = np.roll(np.arange(_SIDES), -1)
_LEAST_SIDE = 1e-6  # [m at 1 m]
_TINY = 1e-15


def nearest_tangents(sight: Sight, solids: Solids) -> Tangents:
    """The tangents of the solids' silhouettes next to the points of their outlines."""
    if solids.kind is SPHERE:
        return _of_cones(sight, solids)
    if isinstance(solids.kind, Round):
        return _of_curves(sight, solids, solids.kind)
    return _of_edges(sight, solids, solids.kind)


def _of_cones(sight: Sight, solids: Solids) -> Tangents:
    """Of spheres: the tangent plane of the cone of rays around each, next to the point's ray."""
    to_centre = solids.seen_from(sight.eyes_m)
    distance = np.sqrt(dot(to_centre, to_centre))[..., None]
    ahead = to_centre / distance
    rays = np.concatenate([sight.points, np.ones((*sight.points.shape[:3], 1))], axis=3)
    across = _unit(rays - dot(rays, ahead)[..., None] * ahead)
    sine = np.minimum(solids.half_m[:, None, None] / distance, 0.99)
    planes = across * np.sqrt(1 - sine * sine) - ahead * sine
    touched = solids.kind.touch(planes.reshape(len(planes), -1, 3) @ solids.rotation, solids.half_m)
    return Tangents(_unit(planes[..., :2]), touched)


def _of_edges(sight: Sight, solids: Solids, kind: Prism) -> Tangents:
    """Of prisms: among the tangents along their edges, the one that the point is furthest outside of."""
    corners, (ends, starts) = kind.corners_m(solids.half_m), kind.edges
    seen = (corners @ solids.rotation.transpose(0, 2, 1))[:, None] + solids.seen_from(sight.eyes_m)
    image = seen[..., :2] / seen[..., 2:]
    along = image[:, :, ends] - image[:, :, starts]
    across = _unit(_outward(along))
    outward = np.concatenate([across, -across], axis=2)
    reach = (outward @ image.transpose(0, 1, 3, 2)).max(axis=3)
    side = (sight.points @ outward.transpose(0, 1, 3, 2) - reach[:, :, None]).argmax(axis=3)
    row, view = _rows(side)
    edge = side % len(ends)
    behind, ahead = starts[edge], ends[edge]
    share = _share(sight.points - image[row, view, behind], along[row, view, edge])
    touched = corners[row, behind] * (1 - share) + corners[row, ahead] * share
    return Tangents(outward[row, view, side], touched.reshape(len(side), -1, 3))


def _of_curves(sight: Sight, solids: Solids, kind: Round) -> Tangents:
    """Of solids without corners: a side of the polygon through points of the silhouette, and a point above the side."""
    start = solids.seen_from(sight.eyes_m)
    horizon = kind.horizon(-start[:, :, 0] @ solids.rotation, solids.half_m, _SIDES)
    placed = horizon.reshape(len(horizon), -1, 3) @ solids.rotation.transpose(0, 2, 1)
    seen = placed.reshape(horizon.shape) + start
    corners = seen[..., :2] / seen[..., 2:]
    ahead = corners[:, :, _NEXT] - corners
    length = np.sqrt(dot(ahead, ahead))
    outward = _outward(ahead) / (length + _TINY)[..., None]
    outward *= np.sign(dot(outward, corners - corners.mean(axis=2, keepdims=True)).sum(axis=2))[..., None, None]
    reach = np.where(length > _LEAST_SIDE, dot(outward, corners), np.inf)
    side = (sight.points @ outward.transpose(0, 1, 3, 2) - reach[:, :, None]).argmax(axis=3)
    row, view = _rows(side)
    share = _share(sight.points - corners[row, view, side], ahead[row, view, side])
    touched = horizon[row, view, side] * (1 - share) + horizon[row, view, (side + 1) % _SIDES] * share
    return Tangents(outward[row, view, side], kind.onto(touched.reshape(len(side), -1, 3), solids.half_m))


def _share(from_start: Floats, side: Floats) -> Floats:
    """How far along its side (..., 2) each point lies: (..., 1), 0 at the start, 1 at the end."""
    share = dot(from_start, side) / (dot(side, side) + _TINY)
    return np.asarray(np.clip(share, 0, 1)[..., None])


def _outward(ahead: Floats) -> Floats:
    """Perpendicular to directions (..., 2), to their left seen from in front of the image."""
    return np.stack([ahead[..., 1], -ahead[..., 0]], axis=-1)


def _rows(side: Ints) -> tuple[Ints, Ints]:
    """What indexes, beside sides (S, 2, N), the solid and the view."""
    return np.arange(len(side))[:, None, None], np.arange(2)[None, :, None]


def _unit(vectors: Floats) -> Floats:
    return np.asarray(vectors / (np.sqrt(dot(vectors, vectors)) + _TINY)[..., None])
