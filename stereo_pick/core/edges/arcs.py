"""How far light moves arcs of silhouettes: what they lie off their solids says it, of each solid and of its scene."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from stereo_pick.core.arrays import Floats
from stereo_pick.core.shapes.evidence import ARC_PX, USUAL_PX

USUAL_SIGMA_PX = 0.11  # by which light moves an arc, as a rule
EXACT = 0.58  # of how far light moves arcs, where their edges are placed as exactly as can be
_KNOWN = 0.3  # of the points of an arc, in which it is trusted
_USUAL_OFF_PX = 0.04  # that an arc lies off its solid
_COUNTS_FOR = 10.0  # arcs, so much what is usual says of a scene, and a scene of each of its solids
_ABSORBED = 0.37  # by each unknown of a solid: so many times as far as it lies off is an arc moved
_LEAST_SHOWN = 0.25


class Arcs(NamedTuple):
    """Of each solid (S,) the sum of the squares of how far [px] its arcs lie off it, and their number; unknowns: how
    many a solid of this kind has."""

    squares_px2: Floats
    number: Floats
    unknowns: int


def arcs_of(residual_px: Floats, trust: Floats, length_px: Floats, unknowns: int) -> Arcs:
    """The arcs of silhouettes in both views of solids: of residuals (S, 2, N), trusted so far (S, 2, N), along such
    lengths (S, 2)."""
    points = residual_px.shape[-1]
    several = np.clip(np.round(length_px / ARC_PX), 1, points)
    arc = (np.arange(points) * several[..., None] // points).astype(int)
    place = (np.arange(length_px.size)[:, None] * points + arc.reshape(-1, points)).ravel()
    sums = [
        np.bincount(place, each.ravel(), residual_px.size) for each in (np.ones_like(trust), trust, trust * residual_px)
    ]
    expected, known, off = (each.reshape(len(residual_px), -1) for each in sums)
    counts = known > _KNOWN * expected
    mean_px = np.where(counts, off / np.where(counts, known, 1.0), 0.0)
    return Arcs((mean_px**2).sum(axis=1), counts.sum(axis=1).astype(np.float64), unknowns)


def usual_sigma_px(scale_px: Floats, shown: Floats) -> Floats:
    """One sigma (S,) [px] by which light moves an arc of solids of which points lie off by this much (S,), as a rule.

    shown: (S,), the part of each silhouette that lies on edges: the less, the less the rest is trusted.
    """
    return USUAL_SIGMA_PX * np.maximum(1.0, scale_px / USUAL_PX) * _distrust(shown)


def arc_sigmas_px(groups: Sequence[Arcs], shown: Sequence[Floats], light: float = 1.0) -> list[Floats]:
    """One sigma (S,) [px] by which light moves an arc of each solid of the groups of a scene.

    A solid goes with its edges as far as its unknowns let it, so arcs lie off it by less than they are moved. Few of
    them say little, and the light is the same for all of a scene (empirical Bayes). shown: (S,), as above; light: as of
    `EdgeMap`.
    """
    squares = sum(float(each.squares_px2.sum()) for each in groups)
    number = sum(float(each.number.sum()) for each in groups)
    of_scene = (squares + _COUNTS_FOR * _USUAL_OFF_PX**2) / (number + _COUNTS_FOR)
    return [light * _moved_px(arcs, of_scene) * _distrust(part) for arcs, part in zip(groups, shown)]


def _moved_px(arcs: Arcs, of_scene_px2: float) -> Floats:
    off_px2 = (arcs.squares_px2 + _COUNTS_FOR * of_scene_px2) / (arcs.number + _COUNTS_FOR)
    return np.asarray(_ABSORBED * arcs.unknowns * np.sqrt(off_px2))


def _distrust(shown: Floats) -> Floats:
    return 1 / np.maximum(shown, _LEAST_SHOWN) ** 2
