"""No two objects are at the same place."""

from __future__ import annotations

import numpy as np

from stereo_pick.core.arrays import Floats
from stereo_pick.core.correspondence.overlap import is_apart, one_in_each_place
from stereo_pick.core.correspondence.position import Located, Row
from stereo_pick.core.objects import Blob
from stereo_pick.core.shapes import SolidFit

BLOB = Blob(np.array([(0.0, 0.0), (9.0, 0.0), (9.0, 9.0)]), 50.0)
NOWHERE = np.zeros(2)


def box(x_m: float, size_m: Floats) -> SolidFit:
    return SolidFit("box", np.array([x_m, 0.0, 0.9]), np.eye(3), size_m, 0.1, np.eye(3) * 1e-8)


def row(x_m: float, sigma_px: float, size_m: float = 0.04) -> Row:
    return (BLOB, BLOB), Located(NOWHERE, NOWHERE, sigma_px, box(x_m, np.full(3, size_m)))


def test_parts_that_touch_are_apart_and_parts_inside_each_other_are_not() -> None:
    small, large = box(0.0, np.full(3, 0.01)), box(0.018, np.full(3, 0.04))
    assert is_apart(box(0.041, np.full(3, 0.04)), [row(0.0, 0.1)])
    assert not is_apart(small, [row(0.018, 0.1)]) and not is_apart(large, [row(0.0, 0.1, 0.01)])


def test_the_surest_stays_and_the_others_are_refused() -> None:
    unknown: Row = ((BLOB, BLOB), Located(NOWHERE, NOWHERE, 2.0, None))
    stays, goes = one_in_each_place([row(0.0, 0.3), row(0.001, 0.1), row(0.1, 0.5), unknown])
    assert sorted(where.sigma_px for _, where in stays) == [0.1, 0.5, 2.0]
    assert [(where.sigma_px, where.reason) for _, where in goes] == [(0.3, "merged")]
