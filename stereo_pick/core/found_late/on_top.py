"""What stands on another object: it is looked for on that one's top, where more is seen than that one."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from stereo_pick.core.arrays import Floats
from stereo_pick.core.doubts.coaxial import are_coaxial
from stereo_pick.core.doubts.flush_boxes import are_flush
from stereo_pick.core.doubts.rising_outline import rises_beside
from stereo_pick.core.doubts.standing_out import stands_out
from stereo_pick.core.edges.hypotheses import Images
from stereo_pick.core.found_late.carried import own_outlines
from stereo_pick.core.found_late.last_look import LastLook, Seen
from stereo_pick.core.shapes.common_table import stands_on
from stereo_pick.core.shapes.kinds import SPHERE
from stereo_pick.core.shapes.solid_fit import SolidFit
from stereo_pick.core.shapes.table import Table

_BELOW_M = 0.001  # the top, where that is surely within a solid


def with_those_on_top(images: Images, look: LastLook, seen: Sequence[Seen]) -> list[Seen]:
    """The same, and what stands on them; each of two such by its own silhouette, as its outlines are those of both."""
    found = list(seen)
    for i, lower in enumerate(seen):
        upper = _on_top(images, look, lower, [each.fit for _, each in found if each is not lower[1]])
        if upper is not None:
            found[i] = _by_itself(lower, images)
            found.append(_by_itself(upper, images))
    return found


def _on_top(images: Images, look: LastLook, lower: Seen, others: Sequence[SolidFit]) -> Seen | None:
    """What stands on an object, unless that is more of it: on its axis, or flush with its sides."""
    (blobs, _), below = lower
    fit, up = below.fit, look.table.normal
    if fit.kind == SPHERE.name or not below.is_clear or not stands_on(look.table, fit):
        return None
    if not stands_out(images.pair, fit, others) and not rises_beside(blobs, [fit, *others], images.rig, look.table):
        return None
    behind = images.as_rough_as(others).behind(others)
    upper = replace(look, images=behind, table=_top_of(fit, up), before=others, besides=[]).at(blobs, others)
    if upper is None or not _bears(fit, upper[1].fit, up):
        return None
    there = upper[1].fit
    is_more = are_coaxial(there, fit, up) or are_flush(there, fit, touch=True)
    return None if is_more or not upper[1].is_clear else upper


def _by_itself(seen: Seen, images: Images) -> Seen:
    (blobs, where), there = seen
    return (own_outlines(blobs, there.fit, images.rig), where), there


def _top_of(fit: SolidFit, up: Floats) -> Table:
    """The plane of a solid's top as a table."""
    sigma_m = float(np.sqrt(up @ fit.covariance @ up))
    return Table(up, -float(up @ fit.centre_m) - fit.reach_m(up), sigma_m)


def _bears(lower: SolidFit, upper: SolidFit, up: Floats) -> bool:
    """Whether the middle of what stands on a solid's top is above that."""
    foot_m = upper.centre_m - (upper.reach_m(-up) + _BELOW_M) * up
    return bool((np.abs((foot_m - lower.centre_m) @ lower.rotation) < lower.size_m / 2).all())
