"""Whether the objects stand on the table that is given: a camera, or the table, may have been moved since."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from stereo_pick.core.shapes import SolidFit
from stereo_pick.core.shapes.common_table import common_table, stands_on
from stereo_pick.core.shapes.table import Table


def misplaced_m(table: Table, fits: Sequence[SolidFit]) -> float | None:
    """How high above a table solids stand that agree on another one, where most of them do not stand on this one; None
    where that is not so."""
    other = common_table(fits)
    if other is None:
        return None
    standing = [fit for fit in fits if stands_on(other, fit)]
    if 2 * sum(stands_on(table, fit) for fit in standing) >= len(standing):
        return None
    return float(np.median([table.under(fit.solid)[0][0] for fit in standing]))
