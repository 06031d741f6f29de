"""What stands on another object: it is looked for on that one's top, where more is seen than that one."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from stereo_pick.core.arrays import Floats
from stereo_pick.core.doubts.coaxial import are_coaxial
from stereo_pick.core.doubts.flush_boxes import are_flush
from stereo_pick.core.doubts.rising_outline import rises_beside
from stereo_pick.core.doubts.standing_out import stands_out
from stereo_pick.core.edges.hypotheses import Images
from stereo_pick.core.found_late.carried import own_outlines, without_edges
from stereo_pick.core.found_late.last_look import LastLook, Seen
from stereo_pick.core.found_late.risen import all_risen
from stereo_pick.core.found_late.told_from_marks import unless_marks
from stereo_pick.core.matches.left_over import Unread
from stereo_pick.core.places.position import BlobPair
from stereo_pick.core.rig import StereoRig
from stereo_pick.core.shapes.common_normal import ANGLE
from stereo_pick.core.shapes.common_table import stands_on
from stereo_pick.core.shapes.kinds import CYLINDER, SPHERE
from stereo_pick.core.shapes.solid_fit import SolidFit
from stereo_pick.core.shapes.table import Table
from stereo_pick.core.tables.lying_flat import WarpedViews

_BELOW_M = 0.001  # the top, where that is surely within a solid
_MOST = 3  # places on a top
_MIDDLE = 0.03  # of the largest size, within which one stands in the middle of the other


def with_those_on_top(images: Images, look: LastLook, seen: Sequence[Seen]) -> list[Seen]:
    """The same, and what stands on them; each of two such by its own silhouette, as its outlines are those of both."""
    found = list(seen)
    for i, lower in enumerate(seen):
        upper = _on_top(images, look, lower, [each.fit for _, each in found if each is not lower[1]])
        if upper is not None:
            found[i] = by_itself(lower, images.rig)
            found.append(by_itself(upper, images.rig))
    return found


def _on_top(images: Images, look: LastLook, lower: Seen, others: Sequence[SolidFit]) -> Seen | None:
    """What stands on an object, unless that may be more of it."""
    (blobs, _), below = lower
    fit, up = below.fit, look.table.normal
    if not _has_a_top(fit, up) or not below.is_clear or not stands_on(look.table, fit):
        return None
    if not stands_out(images.pair, fit, others) and not rises_beside(blobs, [fit, *others], images.rig, look.table):
        return None
    behind, top = images.as_rough_as(others).behind(others), _top_of(fit, up)
    upper = _on(
        WarpedViews(images.pair, top), replace(look, images=behind, table=top, before=others, besides=[]), blobs
    )
    if upper is None or not _bears(fit, upper[1].fit, up):
        return None
    return None if _is_more_of(fit, upper[1].fit, up) or not upper[1].is_clear else upper


def _is_more_of(lower: SolidFit, upper: SolidFit, up: Floats) -> bool:
    """Whether it may be one with what it stands on: in the middle of that, on its axis, or flush with its sides."""
    beside_m = float(np.linalg.norm(np.cross(up, upper.centre_m - lower.centre_m)))
    if beside_m < _MIDDLE * float(lower.size_m.max()):
        return True
    return are_coaxial(upper, lower, up) or are_flush(upper, lower, touch=True)


def _on(top: WarpedViews, look: LastLook, blobs: BlobPair) -> Seen | None:
    """What stands on a top, and is told from marks on it."""
    several = (unless_marks(look.images, top, each) for each in _looked_for(top, look, blobs))
    return next((each for each in several if each is not None), None)


def _looked_for(top: WarpedViews, look: LastLook, blobs: BlobPair) -> Iterator[Seen | None]:
    """What stands there by the outlines of both; and by what rises from the top alone."""
    left, others = blobs[0], look.before
    yield look.at(blobs, others)
    for risen in all_risen(top.seen, top.table, others, [left.contour_px])[:_MOST]:
        yield look.at_risen(risen, others)
    for hull in top.rising(left, others)[:_MOST]:
        yield look.at_refused(Unread("merged", without_edges(left, hull), None), others)


def by_itself(seen: Seen, rig: StereoRig) -> Seen:
    """The same with the outlines that the solid has: those that it was found in were none of its own."""
    (blobs, where), there = seen
    return (own_outlines(blobs, there.fit, rig), where), there


def _has_a_top(fit: SolidFit, up: Floats) -> bool:
    """Whether what looks up of a solid is flat."""
    if fit.kind == CYLINDER.name:
        return bool(abs(fit.rotation[:, 2] @ up) > np.sqrt(1 - ANGLE**2))
    return fit.kind != SPHERE.name


def _top_of(fit: SolidFit, up: Floats) -> Table:
    """The plane of a solid's top as a table."""
    sigma_m = float(np.sqrt(up @ fit.covariance @ up))
    return Table(up, -float(up @ fit.centre_m) - fit.reach_m(up), sigma_m)


def _bears(lower: SolidFit, upper: SolidFit, up: Floats) -> bool:
    """Whether the middle of what stands on a solid's top is above that."""
    foot_m = upper.centre_m - (upper.reach_m(-up) + _BELOW_M) * up
    return bool((np.abs((foot_m - lower.centre_m) @ lower.rotation) < lower.size_m / 2).all())
