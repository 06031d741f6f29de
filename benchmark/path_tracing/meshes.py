"""Parts as triangles, their edges rounded as those of real parts are."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from rendering import Box, Cylinder, HexPrism, Solid, Sphere, Tube

from stereo_pick.core.arrays import Floats, Ints

_ROUND = 128  # points around a round outline
_FILLET = 6  # rings on a rounded edge


class Mesh(NamedTuple):
    """Vertices (N, 3) and normals (N, 3) in the table's frame, triangles (M, 3) of them."""

    points: Floats
    normals: Floats
    triangles: Ints


class _Ring(NamedTuple):
    """How far outwards (beyond the inset outline) and how high a ring of vertices is, and its normal, likewise."""

    out_m: float
    up_m: float
    normal_out: float
    normal_up: float


def mesh(solid: Solid, edge_radius_m: float) -> Mesh:
    """A part's surface. A sphere has no edges."""
    rounded = min(edge_radius_m, min(solid.size_m) / 8)
    if isinstance(solid, Sphere):
        outline, outwards = np.zeros((_ROUND, 2)), _directions(_ROUND)
        rings = _quarter_rings(solid.size_m[0] / 2, 0.0, 32)
    else:
        outline, outwards = _inset_outline(solid, rounded)
        rings = _quarter_rings(rounded, solid.size_m[2] / 2 - rounded, _FILLET)
    if isinstance(solid, Tube):
        rings = _with_bore(rings, solid, rounded)
    points, normals, triangles = _lofted(outline, outwards, rings, closed=isinstance(solid, Tube))
    return Mesh(points @ solid.axes.T + solid.centre_m, normals @ solid.axes.T, triangles)


def _directions(count: int) -> Floats:
    angle = np.arange(count) * 2 * np.pi / count
    return np.stack([np.cos(angle), np.sin(angle)], axis=1)


def _inset_outline(solid: Solid, inset_m: float) -> tuple[Floats, Floats]:
    """A part's cross-section, that much smaller all around, and the ways out of it, both (N, 2): corners are fans."""
    if isinstance(solid, Cylinder):
        outwards = _directions(_ROUND)
        return outwards * (solid.size_m[0] / 2 - inset_m), outwards
    if isinstance(solid, HexPrism):
        faces_rad, half_m = np.arange(6) * np.pi / 3, np.full(6, solid.size_m[0] / 2)
    elif isinstance(solid, Box):
        faces_rad, half_m = np.arange(4) * np.pi / 2, np.array([*solid.size_m[:2]] * 2) / 2
    else:
        raise TypeError(f"{type(solid).__name__}: no outline is known of this kind of part")
    ways = np.stack([np.cos(faces_rad), np.sin(faces_rad)], axis=1)
    half_m = half_m - inset_m
    outline, outwards = [], []
    for number, face_rad in enumerate(faces_rad):
        following = (number + 1) % len(ways)
        corner = np.linalg.solve(ways[[number, following]], half_m[[number, following]])
        fan_rad = face_rad + np.linspace(0, 2 * np.pi / len(ways), _FILLET)
        outline.append(np.tile(corner, (_FILLET, 1)))
        outwards.append(np.stack([np.cos(fan_rad), np.sin(fan_rad)], axis=1))
    return np.concatenate(outline), np.concatenate(outwards)


def _quarter_rings(radius_m: float, half_m: float, count: int) -> list[_Ring]:
    """Around the edges at -half_m and +half_m, from the lowest ring to the highest."""
    climb = np.linspace(0, np.pi / 2, count)
    lower = [_Ring(radius_m * np.cos(a), -half_m - radius_m * np.sin(a), np.cos(a), -np.sin(a)) for a in climb[::-1]]
    upper = [_Ring(radius_m * np.cos(a), half_m + radius_m * np.sin(a), np.cos(a), np.sin(a)) for a in climb]
    return lower + upper


def _with_bore(rings: list[_Ring], tube: Tube, inset_m: float) -> list[_Ring]:
    """The rings of the outside, then those of the bore, downwards. Its edges are sharp: two rings with two normals."""
    out_m, half_m = tube.bore * tube.size_m[0] / 2 - (tube.size_m[0] / 2 - inset_m), tube.size_m[2] / 2
    bore = [
        _Ring(out_m, half_m, 0.0, 1.0),
        _Ring(out_m, half_m, -1.0, 0.0),
        _Ring(out_m, -half_m, -1.0, 0.0),
        _Ring(out_m, -half_m, 0.0, -1.0),
    ]
    return [*rings, *bore]


def _lofted(outline: Floats, outwards: Floats, rings: list[_Ring], closed: bool) -> tuple[Floats, Floats, Ints]:
    """The surface between all rings and, if closed, between the last and the first, else caps over both."""
    points = np.concatenate([np.c_[outline + r.out_m * outwards, np.full(len(outline), r.up_m)] for r in rings])
    normals = np.concatenate([np.c_[r.normal_out * outwards, np.full(len(outline), r.normal_up)] for r in rings])
    around, following = np.arange(len(outline)), (np.arange(len(outline)) + 1) % len(outline)
    triangles = []
    for low in range(len(rings) if closed else len(rings) - 1):
        high = (low + 1) % len(rings)
        a, b = low * len(outline) + around, low * len(outline) + following
        c, d = high * len(outline) + around, high * len(outline) + following
        triangles += [np.stack([a, b, d], axis=1), np.stack([a, d, c], axis=1)]
    if closed:
        return points, normals, np.concatenate(triangles)
    middles = np.array([[0, 0, rings[0].up_m], [0, 0, rings[-1].up_m]])
    bottom, top = len(points), len(points) + 1
    last = (len(rings) - 1) * len(outline)
    triangles += [
        np.stack([np.full_like(around, bottom), following, around], axis=1),
        np.stack([np.full_like(around, top), last + around, last + following], axis=1),
    ]
    return (
        np.concatenate([points, middles]),
        np.concatenate([normals, [[0, 0, -1], [0, 0, 1]]]),
        np.concatenate(triangles),
    )
