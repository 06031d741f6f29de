"""Which solid an object is: the simplest that explains both its outlines, or none."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from stereo_pick.core.arrays import Bools, Floats, Ints
from stereo_pick.core.rig import StereoRig
from stereo_pick.core.shapes.evidence import centre_covariance, complaint, determined, explained, misfit_px
from stereo_pick.core.shapes.kinds import BOX, CYLINDER, SPHERE, Kind
from stereo_pick.core.shapes.outline import Outline
from stereo_pick.core.shapes.refinement import Fitted, fitted, refine
from stereo_pick.core.shapes.residuals import own_tangents
from stereo_pick.core.shapes.sight import Sight
from stereo_pick.core.shapes.solid_fit import SolidFit
from stereo_pick.core.shapes.starts import starts

NOISE_PX = 0.1  # by which arcs of a sub-pixel outline are off
_LEAST_TRUSTED = 12  # points in each view
_BEGUN = {SPHERE: 1, CYLINDER: 20, BOX: 20}  # starts that a first look keeps
_KEPT = 3
_FIRST_ROUNDS, _LAST_ROUNDS = 4, 5

Pair = tuple[Outline, Outline]


def fit_solid(
    left: Outline, right: Outline, rig: StereoRig, table_normal: Floats | None = None, noise_px: float = NOISE_PX
) -> SolidFit | None:
    """The solid that explains an object's outlines in both views; None where no kind does. See `fit_solids`."""
    return fit_solids([(left, right)], rig, table_normal, noise_px)[0]


def fit_solids(
    pairs: Sequence[Pair], rig: StereoRig, table_normal: Floats | None = None, noise_px: float = NOISE_PX
) -> list[SolidFit | None]:
    """For each object's outlines (left, right) of as many points each, the solid that explains them.

    table_normal: (3,), unit, in the rectified left frame: where given, a cylinder stands or lies on the table and a
    box stands on one of its faces. noise_px: by how much outlines are off; a richer kind must explain more than that
    to be preferred, and the chosen one must leave no more than half as much again.
    """
    seen = np.array([i for i, pair in enumerate(pairs) if _can_be_fitted(pair)], np.int64)
    chosen: list[SolidFit | None] = [None] * len(pairs)
    if not len(seen):
        return chosen
    sight = Sight.of([pairs[i] for i in seen], rig)
    least = np.full(len(seen), np.inf)
    remaining = np.arange(len(seen))
    for kind in (SPHERE, CYLINDER, BOX):
        found = _best(sight.only(remaining), kind, table_normal, noise_px)
        misfit, cost = misfit_px(found, noise_px), complaint(found, noise_px)
        covariance = centre_covariance(found, noise_px)
        better = explained(misfit, noise_px) & determined(found, covariance) & (cost < least[remaining])
        for at in np.flatnonzero(better):
            chosen[seen[remaining[at]]] = _result(found, int(at), float(misfit[at]), covariance[at])
        least[remaining] = np.minimum(least[remaining], np.where(better, cost, np.inf))
        remaining = remaining[~_settled(found, misfit, noise_px)]
        if not len(remaining):
            break
    return chosen


def _can_be_fitted(pair: Pair) -> bool:
    return all((side.weight * (1 - side.corner)).sum() >= _LEAST_TRUSTED for side in pair)


def _settled(found: Fitted, misfit: Floats, noise_px: float) -> Bools:
    """Whether (S,) the outlines leave nothing that a richer kind could explain."""
    return np.asarray(misfit < (0.5 if found.solids.kind is SPHERE else 1.0) * noise_px)


def _best(sight: Sight, kind: Kind, table_normal: Floats | None, noise_px: float) -> Fitted:
    """The best solid of one kind for every object."""
    coarse, fine = sight.coarse(), sight.without_corners()
    objects, solids = starts(coarse, kind, table_normal, _BEGUN[kind])
    begun = coarse.only(objects)
    first = refine(begun, fitted(begun, solids, own_tangents), _FIRST_ROUNDS, own_tangents)
    few = _fewest(np.abs(first.residual_px * first.weight).sum(axis=1), objects, _KEPT)
    kept = fine.only(objects[few])
    last = refine(kept, fitted(kept, first.solids.only(few)), _LAST_ROUNDS)
    return last.only(_fewest(misfit_px(last, noise_px), objects[few], 1))


def _fewest(cost: Floats, objects: Ints, keep: int) -> Ints:
    """The rows of the `keep` lowest costs of each object; every object has as many rows, one after the other."""
    count = int(objects[-1]) + 1
    rows = len(objects) // count
    best = np.argsort(cost.reshape(count, rows), axis=1)[:, :keep]
    return np.asarray((best + rows * np.arange(count)[:, None]).ravel())


def _result(found: Fitted, at: int, misfit: float, covariance: Floats) -> SolidFit:
    solids = found.solids
    return SolidFit(solids.kind.name, solids.centre_m[at], solids.rotation[at], solids.size_m()[at], misfit, covariance)
