"""Tubes and other cylinders of which the side alone is seen: their ends are open, or look like the table.

An end that faces a camera looks like a bite there, and like the end of a cylinder to the other camera, so no convex
solid explains both outlines. Tubes are often taped, sawn or painted: they need not be as smooth as what is machined.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from stereo_pick.core.arrays import Floats
from stereo_pick.core.edges.hypotheses import Images
from stereo_pick.core.edges.supported import CHANCE, Supported
from stereo_pick.core.edges.touching_end import with_touching_ends
from stereo_pick.core.shapes.evidence import centre_covariance, determined
from stereo_pick.core.shapes.fitting import NOISE_PX, Pair, few_of_kind, nearest_of_kind
from stereo_pick.core.shapes.kinds import BOX, CYLINDER, TUBE, Kind
from stereo_pick.core.shapes.refinement import Fitted, fitted, refine
from stereo_pick.core.shapes.sight import Sight
from stereo_pick.core.shapes.solid_fit import SolidFit
from stereo_pick.core.shapes.solids import Solids
from stereo_pick.core.shapes.table import Table

_ROUGH = 1 / 50  # of its diameter by which a tube's outlines may lie off it ...
_MOST = 2 / 3  # ... of their points
_FEW = 4  # tubes that come near to rough outlines, of which several may by as much
_LEAST_AT_END = 3  # points, in both views: two agree where one is wrong
_TIMES = 3  # that an end which touches something is looked for, from where the tube was the time before
_MORE_ROUNDS = 12  # after the search, which ends some micrometres short, and not always at the same ones


def tube_of(images: Images, outlines: Pair, table: Table | None = None) -> Supported | None:
    """The tube, as a cylinder, that explains most of an object's outlines in both views; None where it does not, where
    an end does not show, or where another solid explains more. Its centre is as unsure as it is that it is no other.

    table: what all of these stand on, if that is known; else an end that touches something is not looked for.
    """
    found = _found(images, outlines, table)
    if found is None and table is not None:
        tube, sight, _ = _nearest(images, outlines, table)
        mended = with_touching_ends(outlines, _settled(sight, tube).solids, images.maps, images.eyes_m)
        found = _found(images, mended, table)
    if found is None:
        return None
    tube, share, rivals = found
    for _ in range(1 if table is None else _TIMES):  # by its own edges alone: the table is known by those of others
        own = with_touching_ends(outlines, tube.solids, images.maps, images.eyes_m) if table else outlines
        sight = Sight.of([own], images.rig).without_corners()
        tube = _settled(sight, _seen_as(sight, tube.solids))
    return _as_cylinder(tube, share, centre_covariance(_own_edges(sight, tube), NOISE_PX)[0], rivals)


def _found(images: Images, outlines: Pair, table: Table | None) -> tuple[Fitted, float, list[Floats]] | None:
    """The tube, the share of the outlines that lie on it, and the centres of what explains as much."""
    tube, sight, rough_px = _nearest(images, outlines, table)
    share, own = _share(tube, rough_px), _own_edges(sight, tube)
    if share < _MOST or not _shows_both_ends(own) or not determined(own, centre_covariance(own, NOISE_PX, table))[0]:
        return None
    others = [_seen_as(sight, _of_kind(images, outlines, kind, table)) for kind in (CYLINDER, BOX)]
    shares = [_share(each, rough_px) for each in others]
    if max(shares) > share + CHANCE:
        return None
    return tube, share, [each.solids.centre_m[0] for each, much in zip(others, shares) if much > share - CHANCE]


def _nearest(images: Images, outlines: Pair, table: Table | None) -> tuple[Fitted, Sight, float]:
    """The tube on which most of the outlines lie, these, and how far off it they may be [px]."""
    sight = Sight.of([outlines], images.rig, table).without_corners()
    found = few_of_kind(outlines, images.rig, TUBE, _FEW, table)
    tubes = [_seen_as(sight, found.solids.only(np.array([i]))) for i in range(len(found.weight))]
    rough_px = max(_ROUGH * _width_px(tubes[0].solids, sight.focal_px), NOISE_PX)
    return max(tubes, key=lambda each: _share(each, rough_px)), sight, rough_px


def _settled(sight: Sight, tube: Fitted) -> Fitted:
    for _ in range(_MORE_ROUNDS):
        tube = refine(sight, tube, rounds=1)
    return tube


def _own_edges(sight: Sight, tube: Fitted) -> Fitted:
    """A tube as its own edges alone tell of it. Where something else begins, it need only reach so far."""
    return replace(tube, weight=sight.weight.reshape(tube.weight.shape))


def _shows_both_ends(own: Fitted) -> bool:
    """Whether several points tell of each end: they move as the tube gets longer, and both ways."""
    by_place, by_length = own.jacobian[0, :, :3] @ own.solids.rotation[0, :, 2], own.jacobian[0, :, -1]
    at_ends = (own.weight[0] > 0) & (np.abs(by_length) > np.abs(by_length).max() / 2)
    forward = at_ends & (by_place * by_length > 0)
    return bool(min(forward.sum(), (at_ends & ~forward).sum()) >= _LEAST_AT_END)


def _of_kind(images: Images, outlines: Pair, kind: Kind, table: Table | None) -> Solids:
    if table is None:
        return images.of_kind(outlines, kind)[0]
    return nearest_of_kind([outlines], images.rig, kind, table)[outlines, kind][0]


def _seen_as(sight: Sight, solid: Solids) -> Fitted:
    return fitted(sight, solid.turning_about(sight.table.normal) if sight.table else solid.turning_freely())


def _width_px(tube: Solids, focal_px: float) -> float:
    return float(tube.size_m()[0, 0] * focal_px / tube.centre_m[0, 2])


def _share(found: Fitted, rough_px: float) -> float:
    """The part of the outline that lies on a solid, the lesser of both views."""
    on_it = (np.abs(found.residual_px[0]) < rough_px).reshape(2, -1)
    known = (found.weight[0] > 0).reshape(2, -1)
    return float(((on_it & known).sum(axis=1) / np.maximum(known.sum(axis=1), 1)).min())


def _as_cylinder(tube: Fitted, share: float, covariance: Floats, rivals: list[Floats]) -> Supported:
    solids, residual_px = tube.solids, float(tube.scale_px()[0])
    size_m = solids.size_m()[0]
    fit = SolidFit(CYLINDER.name, solids.centre_m[0], solids.rotation[0], size_m, residual_px, covariance)
    off_m = max((each - fit.centre_m for each in rivals), key=lambda off: float(off @ off), default=np.zeros(3))
    return Supported(fit, share, residual_px, True, np.outer(off_m, off_m))
