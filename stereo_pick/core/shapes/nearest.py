"""Where a solid's silhouette comes nearest to the points of an outline.

Normals taken from the outline itself would not do in the end: half a side's length away from where it touches, a
tangent that is off by its noise lies inside the solid, in whichever direction it is off. The distance of a point from
a convex figure is the largest of its distances from the figure's tangents: the nearest tangent is sought here.
"""

from __future__ import annotations

import numpy as np

from stereo_pick.core.arrays import Floats, Ints
from stereo_pick.core.shapes.kinds import BOX, BOX_CORNERS, SPHERE, Round
from stereo_pick.core.shapes.residuals import Tangents
from stereo_pick.core.shapes.sight import Sight, Solids, tangent_planes

_SIDES = 24
_LEAST_SIDE = 1e-6  # [m at 1 m]
_TINY = 1e-15

_EDGES = np.array(
    [(i, j) for i in range(8) for j in range(i) if np.count_nonzero(BOX_CORNERS[i] != BOX_CORNERS[j]) == 1]
).T


def nearest_tangents(sight: Sight, solids: Solids) -> Tangents:
    """The tangents of the solids' silhouettes next to the points of their outlines."""
    if solids.kind is SPHERE:
        return _of_cones(sight, solids)
    if solids.kind is BOX:
        return _of_edges(sight, solids)
    return _of_curves(sight, solids)


def _of_cones(sight: Sight, solids: Solids) -> Tangents:
    """Of spheres: the tangent plane of the cone of rays around each, opposite the point's ray."""
    to_centre = (solids.centre_m[:, None] - sight.eyes_m)[:, :, None]
    distance = np.sqrt((to_centre * to_centre).sum(axis=3, keepdims=True))
    ahead = to_centre / distance
    rays = np.concatenate([sight.points, np.ones((*sight.points.shape[:3], 1))], axis=3)
    across = rays - (rays * ahead).sum(axis=3, keepdims=True) * ahead
    across /= np.sqrt((across * across).sum(axis=3, keepdims=True)) + _TINY
    sine = np.minimum(solids.half_m[:, None, None] / distance, 0.99)
    planes = across * np.sqrt(1 - sine * sine) - ahead * sine
    return Tangents(_unit(planes[..., :2]), solids.kind.touch(planes.reshape(len(planes), -1, 3), solids.half_m))


def _of_edges(sight: Sight, solids: Solids) -> Tangents:
    """Of boxes: among the tangents along their twelve edges, the one that the point is furthest outside of."""
    corners = solids.half_m[:, None] * BOX_CORNERS
    placed = corners @ solids.rotation.transpose(0, 2, 1) + solids.centre_m[:, None]
    seen = placed[:, None] - sight.eyes_m[:, None]
    image = seen[..., :2] / seen[..., 2:]
    along = image[:, :, _EDGES[0]] - image[:, :, _EDGES[1]]
    across = _unit(np.stack([along[..., 1], -along[..., 0]], axis=3))
    outward = np.concatenate([across, -across], axis=2)
    reach = (outward @ image.transpose(0, 1, 3, 2)).max(axis=3)
    side = (sight.points @ outward.transpose(0, 1, 3, 2) - reach[:, :, None]).argmax(axis=3)
    row, view = _rows(side)
    edge = side % _EDGES.shape[1]
    behind, ahead = _EDGES[1][edge], _EDGES[0][edge]
    side_px, place_px = along[row, view, edge], sight.points - image[row, view, behind]
    share = np.clip((place_px * side_px).sum(axis=3) / ((side_px * side_px).sum(axis=3) + _TINY), 0, 1)[..., None]
    touched = corners[row, behind] * (1 - share) + corners[row, ahead] * share
    return Tangents(outward[row, view, side], touched.reshape(len(side), -1, 3))


def _of_curves(sight: Sight, solids: Solids) -> Tangents:
    """Of solids with any silhouette: a side of its inscribed polygon, bent like the silhouette over that side."""
    kind = solids.kind
    assert isinstance(kind, Round)
    start = solids.seen_from(sight.eyes_m)
    touched = kind.horizon(-start[:, :, 0] @ solids.rotation, solids.half_m, _SIDES)
    seen = (touched.reshape(len(touched), -1, 3) @ solids.rotation.transpose(0, 2, 1)).reshape(touched.shape) + start
    corners = seen[..., :2] / seen[..., 2:]
    ahead = np.roll(corners, -1, axis=2) - corners
    length = np.sqrt((ahead * ahead).sum(axis=3))
    sides = length > _LEAST_SIDE
    tangent = ahead / np.where(sides, length, 1.0)[..., None]
    outward = np.stack([tangent[..., 1], -tangent[..., 0]], axis=3)
    outward *= np.sign((outward * (corners - corners.mean(axis=2, keepdims=True))).sum(axis=(2, 3)))[..., None, None]
    reach = np.where(sides, (outward * corners).sum(axis=3), np.inf)
    bulge = _bulge(solids, sight, corners + ahead / 2, outward)
    side = (sight.points @ outward.transpose(0, 1, 3, 2) - reach[:, :, None]).argmax(axis=3)
    row, view = _rows(side)
    beside, after = (row, view, side), (row, view, (side + 1) % corners.shape[2])
    tangent, outward, length = tangent[beside], outward[beside], length[beside]
    place = np.clip(2 * ((sight.points - corners[beside]) * tangent).sum(axis=3) / length - 1, -1, 1)
    share = (1 + place[..., None]) / 2
    between = touched[beside] * (1 - share) + touched[after] * share
    normals = _unit(outward + (4 * bulge[beside] * place / length)[..., None] * tangent)
    return Tangents(normals, between.reshape(len(side), -1, 3))


def _bulge(solids: Solids, sight: Sight, middle: Floats, outward: Floats) -> Floats:
    """By how much (S, 2, K) the silhouette lies outside the middles of its polygon's sides; 0 where it is straight."""
    seen = solids.touched(tangent_planes(middle, outward)) + solids.seen_from(sight.eyes_m)
    return np.asarray((outward * (seen[..., :2] / seen[..., 2:] - middle)).sum(axis=3))


def _rows(side: Ints) -> tuple[Ints, Ints]:
    """What indexes, beside sides (S, 2, N), the solid and the view."""
    return np.arange(len(side))[:, None, None], np.arange(2)[None, :, None]


def _unit(vectors: Floats) -> Floats:
    return np.asarray(vectors / (np.sqrt((vectors * vectors).sum(axis=-1, keepdims=True)) + _TINY))
