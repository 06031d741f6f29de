"""Where a solid's silhouette comes nearest to the points of an outline.

Normals taken from the outline itself would not do in the end: half a side's length away from where it touches, a
tangent that is off by its noise lies inside the solid, in whichever direction it is off. The distance of a point from
a convex figure is the largest of its distances from the figure's tangents: the nearest tangent is sought here.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from stereo_pick.core.arrays import Floats
from stereo_pick.core.shapes.kinds import SPHERE, TUBE, Prism, Round, dot
from stereo_pick.core.shapes.residuals import Tangents
from stereo_pick.core.shapes.sight import Sight
from stereo_pick.core.shapes.solids import Solids

_SIDES = 24
_NEXT = np.roll(np.arange(_SIDES), -1)
_LEAST_SIDE = 1e-6  # [m at 1 m]
_TINY = 1e-15
_FAR = 1e6


def nearest_tangents(sight: Sight, solids: Solids) -> Tangents:
    """The tangents of the solids' silhouettes next to the points of their outlines."""
    if solids.kind is SPHERE:
        return _of_cones(sight, solids)
    if solids.kind is TUBE:
        return _of_tubes(sight, solids)
    if isinstance(solids.kind, Round):
        return _of_curves(sight, solids, solids.kind)
    return _of_edges(sight, solids, solids.kind)


def _of_cones(sight: Sight, solids: Solids) -> Tangents:
    """Of spheres: the tangent plane of the cone of rays around each, next to the point's ray."""
    to_centre = solids.seen_from(sight.eyes_m)
    distance = np.sqrt(dot(to_centre, to_centre))[..., None]
    ahead = to_centre / distance
    rays = sight.rays
    across = _unit(rays - dot(rays, ahead)[..., None] * ahead)
    sine = np.minimum(solids.half_m[:, None, None] / distance, 0.99)
    planes = across * np.sqrt(1 - sine * sine) - ahead * sine
    touched = solids.kind.touch(planes.reshape(len(planes), -1, 3) @ solids.rotation, solids.half_m)
    return Tangents.of(sight, solids, _unit(planes[..., :2]), touched)


def _of_edges(sight: Sight, solids: Solids, kind: Prism) -> Tangents:
    """Of prisms: among the tangents along either side of their edges, the one that the point is furthest outside of."""
    corners, (ends, starts) = kind.corners_m(solids.half_m), kind.edges
    seen = (corners @ solids.rotation.transpose(0, 2, 1))[:, None] + solids.seen_from(sight.eyes_m)
    image = seen[..., :2] / seen[..., 2:]
    begin, way = image[:, :, starts], image[:, :, ends] - image[:, :, starts]
    across = _outward(way) / (np.sqrt(dot(way, way)) + _TINY)[..., None]
    reach = across @ image.transpose(0, 1, 3, 2)
    lines = np.concatenate([across, -reach.max(axis=3, keepdims=True)], axis=3)
    opposite = np.concatenate([-across, reach.min(axis=3, keepdims=True)], axis=3)
    touched = np.concatenate([corners[:, starts], corners[:, ends] - corners[:, starts]], axis=2)
    sides = np.empty((*way.shape[:3], 12))
    sides[..., 3:6] = _along(begin, way)
    sides[..., 6:] = touched[:, None]
    sides = np.concatenate([sides, sides], axis=2)
    sides[..., :3] = np.concatenate([lines, opposite], axis=2)
    return Tangents.of(sight, solids, *_furthest(sight, sides))


class _Polygon(NamedTuple):
    """Solids without corners as polygons (S, 2, E) of what is seen of them: horizon (..., 3) [m], the corners in the
    solids' own axes; corners (..., 2), in the image; way (..., 2), from each to the next; normals (..., 2), outward."""

    horizon: Floats
    corners: Floats
    way: Floats
    normals: Floats

    @staticmethod
    def of(sight: Sight, solids: Solids, kind: Round) -> _Polygon:
        start = solids.seen_from(sight.eyes_m)
        horizon = kind.horizon(-start[:, :, 0] @ solids.rotation, solids.half_m, _SIDES)
        placed = horizon.reshape(len(horizon), -1, 3) @ solids.rotation.transpose(0, 2, 1)
        seen = placed.reshape(horizon.shape) + start
        corners = seen[..., :2] / seen[..., 2:]
        way = corners[:, :, _NEXT] - corners
        twice_area = dot(corners, _outward(way)).sum(axis=2)
        # Not 0 where a camera within a solid sees it as a line: without normals nothing would be off it.
        turn = np.copysign(1.0, twice_area)
        normals = _outward(way) * (turn[..., None] / (np.sqrt(dot(way, way)) + _TINY))[..., None]
        return _Polygon(horizon, corners, way, normals)


def _of_curves(sight: Sight, solids: Solids, kind: Round) -> Tangents:
    """Of solids without corners: a side of the polygon through points of the silhouette, and a point above the side."""
    horizon, corners, way, normals = _Polygon.of(sight, solids, kind)
    sides = np.empty((*way.shape[:3], 12))
    sides[..., :2] = normals
    sides[..., 2] = np.where(dot(way, way) > _LEAST_SIDE**2, -dot(normals, corners), -_FAR)
    sides[..., 3:6] = _along(corners, way)
    sides[..., 6:9] = horizon
    sides[..., 9:] = horizon[:, :, _NEXT] - horizon
    normals, touched = _furthest(sight, sides)
    return Tangents.of(sight, solids, normals, kind.onto(touched, solids.half_m))


def _of_tubes(sight: Sight, solids: Solids) -> Tangents:
    """Of tubes, which may look concave: the side of the polygon that the point is nearest to."""
    horizon, corners, way, normals = _Polygon.of(sight, solids, TUBE)
    off = sight.points[:, :, :, None] - corners[:, :, None]
    per_length = way / (dot(way, way) + _TINY)[..., None]
    share = np.clip(dot(off, per_length[:, :, None]), 0, 1)
    off -= share[..., None] * way[:, :, None]
    side = dot(off, off).argmin(axis=3)[..., None]
    begin, end, normals = (np.take_along_axis(each, side, axis=2) for each in (horizon, horizon[:, :, _NEXT], normals))
    touched = begin + np.take_along_axis(share, side, axis=3) * (end - begin)
    return Tangents.of(sight, solids, normals, TUBE.onto(touched.reshape(len(touched), -1, 3), solids.half_m))


def _furthest(sight: Sight, sides: Floats) -> tuple[Floats, Floats]:
    """The normals (S, 2, N, 2) of the sides that the outlines' points are furthest outside of, and where (S, 2 N, 3)
    on these sides the points lie nearest.

    sides: (S, 2, E, 12); of each, what gives with a ray its distance outside (3), and how far along the side it is
    (3), from 0 to 1; its beginning (3) and its way to the end (3) [m].
    """
    rays = sight.rays
    side = (rays @ sides[..., :3].transpose(0, 1, 3, 2)).argmax(axis=3)
    solid, views, count, columns = sides.shape
    side += (np.arange(solid * views) * count).reshape(solid, views, 1)
    chosen = sides.reshape(-1, columns).take(side.reshape(solid, -1), axis=0)
    share = np.minimum(np.maximum(dot(chosen[..., 3:6], rays.reshape(solid, -1, 3)), 0), 1)
    touched = chosen[..., 6:9] + share[..., None] * chosen[..., 9:]
    return chosen[..., :2].reshape(sight.points.shape), touched


def _along(begin: Floats, way: Floats) -> Floats:
    """What (..., 3) gives with a ray (x, y, 1) how far along a side (..., 2) its foot lies: 0 at the beginning, 1 at
    the end."""
    per_length = way / (dot(way, way) + _TINY)[..., None]
    return np.concatenate([per_length, -dot(per_length, begin)[..., None]], axis=-1)


def _outward(ahead: Floats) -> Floats:
    """Perpendicular to directions (..., 2), to their left seen from in front of the image."""
    return np.stack([ahead[..., 1], -ahead[..., 0]], axis=-1)


def _unit(vectors: Floats) -> Floats:
    return np.asarray(vectors / (np.sqrt(dot(vectors, vectors)) + _TINY)[..., None])
