"""Edges around a place in an image, whatever they are of: where grey levels change most along rays from it."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from stereo_pick.core.arrays import Bools, Floats
from stereo_pick.core.edges.edge_map import EdgeMap

RAYS = 48
PER_RAY = 3  # edges at most
_NEAREST_PX, _STEP_PX = 2.0, 0.5
_MARGIN_PX = 4  # of the image: there is half of an edge's neighbourhood
_MIN_STEP = 4.0  # noise sigmas
_FACING = 0.35  # cosine between a ray and an edge's normal
_TINY = 1e-12


class Edgels(NamedTuple):
    """points, normals: (RAYS, PER_RAY, 2) [px], these away from the place; found: (RAYS, PER_RAY), which there are."""

    points: Floats
    normals: Floats
    found: Bools


def edgels_around(view: EdgeMap, place_px: Floats, reach_px: float) -> Edgels:
    """The clearest edges that rays from a place (2,) [px] cross within a distance [px]."""
    angles = np.arange(RAYS) * (2 * np.pi / RAYS)
    rays = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    size = np.array(view.image.shape[::-1])
    along_px = np.arange(_NEAREST_PX, np.clip(reach_px, 2 * _NEAREST_PX, np.hypot(*size)), _STEP_PX)
    places = place_px + along_px[:, None] * rays[:, None]
    slope = view.slopes(places)
    strength = np.sqrt(slope[..., 0] ** 2 + slope[..., 1] ** 2)
    across = np.abs(np.einsum("rnk,rk->rn", slope, rays))
    is_edge = np.zeros(strength.shape, bool)
    here = strength[:, 1:-1]
    is_edge[:, 1:-1] = (here >= strength[:, :-2]) & (here > strength[:, 2:]) & (here > _MIN_STEP * view.noise)
    is_edge &= across > _FACING * strength
    is_edge &= ((places >= _MARGIN_PX) & (places <= size - 1 - _MARGIN_PX)).all(axis=2)
    clearest = np.argsort(np.where(is_edge, -strength, 0.0), axis=1, kind="stable")[:, :PER_RAY]
    row = np.arange(RAYS)[:, None]
    normals = slope[row, clearest] / (strength[row, clearest, None] + _TINY)
    outward = np.where(np.einsum("rnk,rk->rn", normals, rays) < 0, -1.0, 1.0)
    points = place_px + along_px[clearest][..., None] * rays[:, None]
    return Edgels(points, normals * outward[..., None], is_edge[row, clearest])
