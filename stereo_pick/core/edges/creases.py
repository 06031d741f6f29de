"""The edges inside a solid's silhouette: where two of its faces meet that are both seen.

A silhouette says how wide a solid is; where its top ends and a side begins says how high up that is, and how the solid
is turned.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from stereo_pick.core.arrays import Bools, Floats
from stereo_pick.core.shapes.kinds import CYLINDER, Prism, dot
from stereo_pick.core.shapes.solids import Solids

POINTS = 16  # on each crease
_ROOT2 = np.sqrt(2.0)
_ALONG = np.linspace(0.12, 0.88, POINTS)  # of a straight one: at its ends blur mixes it with others
_ARC = np.linspace(-0.9, 0.9, POINTS)  # of what is seen of a rim, both ways from what faces the eye


class Creases(NamedTuple):
    """K points on creases, one crease of `POINTS` after the other, as E eyes see S solids.

    unit: (S, E, K, 3), as parts of the half sizes that belong to the solids' axes; ahead: (S, E, K, 3) [m], along the
    crease, and slide: (S, E, K, 3), unit, from the one face to the other, both in these axes; seen: (S, E, K), whether
    both faces are.
    """

    unit: Floats
    ahead: Floats
    slide: Floats
    seen: Bools


def creases(solids: Solids, eyes_m: Floats) -> Creases:
    """Those of solids as seen from eyes (E, 3), rectified left frame; a sphere has none."""
    eyes = (eyes_m - solids.centre_m[:, None]) @ solids.rotation
    if isinstance(solids.kind, Prism):
        return _of_prisms(solids.kind, solids.half_m, eyes)
    if solids.kind is CYLINDER:
        return _of_cylinders(solids.half_m, eyes)
    none = np.zeros((*eyes.shape[:2], 0, 3))
    return Creases(none, none, none, none[..., 0] > 0)


def crease_points_m(solids: Solids, eye_m: Floats) -> Floats:
    """The points (C, POINTS, 3) [m] on those creases of one solid that an eye (3,) sees, rectified left frame."""
    found = creases(solids, eye_m[None])
    own_m = found.unit[0, 0] * solids.half_m[0, solids.kind.axes]
    points_m = solids.centre_m[0] + own_m @ solids.rotation[0].T
    seen = found.seen[0, 0].reshape(-1, POINTS).all(axis=1)
    return np.asarray(points_m.reshape(-1, POINTS, 3)[seen])


def _of_prisms(kind: Prism, half_m: Floats, eyes: Floats) -> Creases:
    """Along each edge; eyes: (S, E, 3), in the solids' own axes."""
    start, end = kind.corners[kind.edges]
    unit = start[:, None] + _ALONG[:, None] * (end - start)[:, None]
    sizes_m = half_m[:, kind.axes]
    above = eyes[:, :, None] - (start * sizes_m[:, None])[:, None]  # (S, E, edges, 3)
    seen = (dot(above, kind.beside[0]) > 0) & (dot(above, kind.beside[1]) > 0)
    shape = (*eyes.shape[:2], len(start) * POINTS, 3)
    ahead = np.repeat((end - start) * sizes_m[:, None], POINTS, axis=1)
    between = kind.beside[0] - kind.beside[1]
    slide = np.repeat(between / np.sqrt(dot(between, between))[:, None], POINTS, axis=0)
    points, along, across = (np.broadcast_to(each, shape) for each in (unit.reshape(-1, 3), ahead[:, None], slide))
    return Creases(points, along, across, np.repeat(seen, POINTS, axis=2))


def _of_cylinders(half_m: Floats, eyes: Floats) -> Creases:
    """Along the near side of the rim of an end of which the face is seen."""
    x, y, z = eyes[..., 0], eyes[..., 1], eyes[..., 2]
    radius, length = half_m[:, :1], half_m[:, 1:]
    off_axis = np.sqrt(x * x + y * y)
    width = np.arccos(np.minimum(radius / np.maximum(off_axis, radius), 1.0))
    angle = np.arctan2(y, x)[..., None] + width[..., None] * _ARC
    cosine, sine, zero = np.cos(angle), np.sin(angle), np.zeros(angle.shape)
    ends = [np.stack([cosine, sine, zero + end], axis=-1) for end in (-1.0, 1.0)]
    ahead = np.stack([-sine, cosine, zero], axis=-1) * radius[..., None, None]
    seen = np.stack([(end * z > length) & (off_axis > radius) for end in (-1.0, 1.0)], axis=2)
    slides = [np.stack([cosine, sine, zero - end], axis=-1) / _ROOT2 for end in (-1.0, 1.0)]
    points, along, across = (np.concatenate(each, axis=2) for each in (ends, [ahead, ahead], slides))
    return Creases(points, along, across, np.repeat(seen, POINTS, axis=2))
