"""Solids that may stand on a plate, as others do: what bears these is no solid that was found, and a solid of which the
foot does not show was taken to reach down to the table."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from stereo_pick.core.arrays import Floats
from stereo_pick.core.edges.adjusted import Adjusted
from stereo_pick.core.edges.adjustment import adjusted
from stereo_pick.core.edges.growing import stretched_by, ways_along
from stereo_pick.core.edges.hypotheses import Images
from stereo_pick.core.edges.supported import CHANCE
from stereo_pick.core.shapes.common_normal import ANGLE, BASE
from stereo_pick.core.shapes.common_table import base_m, hangs_clear, stands_on
from stereo_pick.core.shapes.kinds import SPHERE
from stereo_pick.core.shapes.solid_fit import SolidFit
from stereo_pick.core.shapes.solids import Solids
from stereo_pick.core.shapes.table import Table


def raised_m(images: Images, found: Sequence[Adjusted], table: Table) -> Floats:
    """How high (N,) [m] above the table solids end if they stand where others do that nothing found bears: those that
    show as much of themselves then; 0 of all others."""
    levels_m = _levels_m(found, table)
    return np.array([_raised_m(images, each, table, levels_m) for each in found])


def _levels_m(found: Sequence[Adjusted], table: Table) -> list[float]:
    """How high above the table something stands that is clearly what it seems, on what was not found."""
    fits = [each.fit for each in found]
    hanging = [each.fit for each in found if each.is_clear and hangs_clear(table, each.fit)]
    return [base_m(table, fit) for fit in hanging if not any(_bears(table, each, fit) for each in fits)]


def _bears(table: Table, bearer: SolidFit, fit: SolidFit) -> bool:
    """Whether one solid ends where the other begins."""
    top_m = float(table.height_m(bearer.centre_m)) + bearer.reach_m(table.normal)
    return abs(top_m - base_m(table, fit)) < BASE * float(fit.size_m.mean())


def _raised_m(images: Images, found: Adjusted, table: Table, levels_m: Sequence[float]) -> float:
    if not stands_on(table, found.fit):
        return 0.0
    return max((each for each in levels_m if _may_stand_at(each, images, found, table)), default=0.0)


def _may_stand_at(level_m: float, images: Images, found: Adjusted, table: Table) -> bool:
    """Whether a solid shows as much of itself if it has the same top, and ends so high above the table."""
    raised = _ending_at(level_m, found.fit, table)
    if raised is None:
        return False
    plate = replace(table, offset_m=table.offset_m - level_m)
    fit = images.locked(raised, plate).fit
    return adjusted([fit], images.maps, images.rig, plate, known=True)[0][0].shown >= found.shown - CHANCE


def _ending_at(level_m: float, fit: SolidFit, table: Table) -> Solids | None:
    """The same solid without what is below that; None of what has no upright axis, or ends there."""
    up = table.normal @ fit.rotation
    if fit.kind == SPHERE.name:
        return None
    down = [(axis, sign) for axis, sign in ways_along(fit.solid, None) if sign * up[axis] < -np.sqrt(1 - ANGLE**2)]
    if not down or fit.size_m[down[0][0]] <= level_m:
        return None
    return stretched_by(fit.solid, down, np.array([-level_m])).turning_about(table.normal)
