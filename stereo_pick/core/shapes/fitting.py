"""Which solid an object is: the simplest that explains both its outlines, or none."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from stereo_pick.core.arrays import Floats, Ints
from stereo_pick.core.rig import StereoRig
from stereo_pick.core.shapes.evidence import centre_covariance, complaint, determined, explained, followed, misfit_px
from stereo_pick.core.shapes.kinds import BOX, CYLINDER, HEX_PRISM, SPHERE, TUBE, Kind
from stereo_pick.core.shapes.nearest import nearest_tangents
from stereo_pick.core.shapes.outline import Outline
from stereo_pick.core.shapes.refinement import Fitted, fitted, refine
from stereo_pick.core.shapes.residuals import own_tangents
from stereo_pick.core.shapes.sight import Sight
from stereo_pick.core.shapes.six_sides import may_have_six_sides
from stereo_pick.core.shapes.solid_fit import SolidFit
from stereo_pick.core.shapes.solids import Solids
from stereo_pick.core.shapes.starts import starts
from stereo_pick.core.shapes.table import Table

NOISE_PX = 0.1  # by which arcs of a sub-pixel outline are off
_LEAST_TRUSTED, _LEAST_AT_FIRST = 9, 3  # points in each view
_HIDDEN = 0.1  # share of an outline without which kinds are mistaken for each other
_NEAR = 2.0  # noise within which a quick look must have come for a thorough one, where another kind explains all
_A_SIDE = 1 / 6  # share without which anything may be mistaken for six sides


class _Stage(NamedTuple):
    """How many solids of each object are pursued, for how many rounds, by the outlines' normals or the solids'."""

    kept: int
    rounds: int
    rough: bool


_QUICK = (_Stage(5, 3, True), _Stage(2, 2, False), _Stage(1, 4, False))
_THOROUGH = (_Stage(64, 2, True), _Stage(24, 4, True), _Stage(8, 3, False), _Stage(1, 4, False))
_NEVER_ROUGH = (_Stage(24, 6, False), _Stage(4, 4, False), _Stage(1, 4, False))  # where the normals of a bite mislead
_ALL_OF: dict[Kind, tuple[_Stage, ...]] = {  # what leaves no solid of a kind out
    SPHERE: _QUICK[-1:],
    CYLINDER: _THOROUGH,
    BOX: _THOROUGH,
    HEX_PRISM: _THOROUGH,
    TUBE: _NEVER_ROUGH,
}
_SEARCHES = (  # and how much, in units of the noise, the kinds before must have left unexplained to make it worthwhile
    (SPHERE, _ALL_OF[SPHERE], 0.0),
    (CYLINDER, _QUICK, 0.5),
    (BOX, _QUICK, 1.0),
    (CYLINDER, _THOROUGH, 1.0),
    (BOX, _THOROUGH, 1.0),
    (HEX_PRISM, _QUICK, 0.5),
    (HEX_PRISM, _THOROUGH, 1.0),
)

Pair = tuple[Outline, Outline]
Nearest = dict[tuple[Pair, Kind], tuple[Solids, float]]
"""The solids (S = 1) of several kinds that come nearest to objects' outlines, and their misfits [px], however large."""


def fit_solid(
    left: Outline, right: Outline, rig: StereoRig, table: Table | None = None, noise_px: float = NOISE_PX
) -> SolidFit | None:
    """The solid that explains an object's outlines in both views; None where no kind does. See `fit_solids`."""
    return fit_solids([(left, right)], rig, table, noise_px)[0]


def fit_solids(
    pairs: Sequence[Pair],
    rig: StereoRig,
    table: Table | None = None,
    noise_px: float = NOISE_PX,
    nearest: Nearest | None = None,
) -> list[SolidFit | None]:
    """For each object's outlines (left, right) of as many points each, the solid that explains them.

    table: where given, cylinders and hexagonal prisms stand or lie on it and boxes stand on one of their faces.
    noise_px: by how much outlines are off; a richer kind must explain more than that to be preferred, and the chosen
    one must leave no more than half as much again. None where no kind does, or where the one that does could as well
    be of another size. nearest: gets what was searched for thoroughly.
    """
    seen = np.array([i for i, pair in enumerate(pairs) if can_be_fitted(pair)], np.int64)
    chosen: list[SolidFit | None] = [None] * len(pairs)
    if not len(seen):
        return chosen
    sight = Sight.of([pairs[i] for i in seen], rig, table)
    unseen = sight.inner.mean(axis=(1, 2))
    least, left = np.full(len(seen), np.inf), np.full(len(seen), np.inf)
    six_sided, like_a_box = unseen < _A_SIDE, np.full(len(seen), True)
    for kind, stages, worthwhile in _SEARCHES:
        doubtful = (left > worthwhile * noise_px) | (unseen > _HIDDEN)
        if kind is BOX:
            doubtful &= np.isinf(left) | like_a_box
        remaining = np.flatnonzero(doubtful & six_sided if kind is HEX_PRISM else doubtful)
        if not len(remaining):
            continue
        found = _searched(sight.only(remaining), kind, stages)
        misfit, cost = misfit_px(found, noise_px), complaint(found, noise_px)
        if nearest is not None and stages is _ALL_OF[kind]:
            nearest.update(_one_by_one([pairs[i] for i in seen[remaining]], found))
        if kind is BOX:
            like_a_box[remaining] = misfit <= _NEAR * noise_px
        if kind is CYLINDER:
            round_ = np.flatnonzero(explained(misfit, noise_px))
            possible = may_have_six_sides(sight.only(remaining[round_]), found.only(round_), noise_px)
            six_sided[remaining[round_]] &= possible
        covariance = centre_covariance(found, noise_px, table)
        fixed = determined(found, covariance)
        for at in np.flatnonzero(explained(misfit, noise_px) & followed(found, noise_px) & (cost < least[remaining])):
            i = remaining[at]
            least[i], left[i] = cost[at], misfit[at]
            chosen[seen[i]] = _result(found, int(at), float(misfit[at]), covariance[at]) if fixed[at] else None
    return chosen


def nearest_of_kind(pairs: Sequence[Pair], rig: StereoRig, kind: Kind, table: Table | None = None) -> Nearest:
    """The solids of one kind that come nearest to the outlines of at least one object, each by itself."""
    return _one_by_one(pairs, _searched(Sight.of(pairs, rig, table), kind, _ALL_OF[kind]))


def few_of_kind(pair: Pair, rig: StereoRig, kind: Kind, few: int, table: Table | None = None) -> Fitted:
    """The few solids of one kind that come nearest to an object's outlines, each by itself."""
    *stages, last = _ALL_OF[kind]
    return _searched(Sight.of([pair], rig, table), kind, (*stages, last._replace(kept=few)))


def can_be_fitted(pair: Pair) -> bool:
    """Whether both outlines have enough points that show the object's own edge, also for a first look."""
    smooth = [side.weight * (1 - side.corner) for side in pair]
    return all(each.sum() >= _LEAST_TRUSTED and each[::2].sum() >= _LEAST_AT_FIRST for each in smooth)


def _searched(sight: Sight, kind: Kind, stages: tuple[_Stage, ...]) -> Fitted:
    """One solid of this kind for every object: many at first, of which ever fewer are pursued."""
    sparse, fine = (sight.coarse(), own_tangents), (sight.without_corners(), nearest_tangents)
    objects, solids = starts(sparse[0], kind, stages[0].kept)
    rough = stages[0].rough
    seen, touch = sparse if rough else fine
    now = fitted(seen.only(objects), solids, touch)
    for stage in stages:
        few = _fewest(now, objects, stage.kept)
        objects, now = objects[few], now.only(few)
        if stage.rough != rough:
            rough, (seen, touch) = stage.rough, fine
            now = fitted(seen.only(objects), now.solids, touch)
        now = refine(seen.only(objects), now, stage.rounds, touch)
    return now


def _fewest(found: Fitted, objects: Ints, keep: int) -> Ints:
    """The rows of the `keep` best solids of each object; every object has as many rows, one after the other."""
    misfit = np.abs(found.residual_px * found.weight).sum(axis=1)
    count = int(objects[-1]) + 1
    rows = len(objects) // count
    best = np.argsort(misfit.reshape(count, rows), axis=1)[:, :keep]
    return np.asarray((best + rows * np.arange(count)[:, None]).ravel())


def _one_by_one(pairs: Sequence[Pair], found: Fitted) -> Nearest:
    misfit, solids = misfit_px(found, NOISE_PX), found.solids
    return {(pair, solids.kind): (solids.only(np.array([i])), float(misfit[i])) for i, pair in enumerate(pairs)}


def _result(found: Fitted, at: int, misfit: float, covariance: Floats) -> SolidFit:
    solids = found.solids
    return SolidFit(solids.kind.name, solids.centre_m[at], solids.rotation[at], solids.size_m()[at], misfit, covariance)
