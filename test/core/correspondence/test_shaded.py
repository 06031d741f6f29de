"""The outline of what is dark may be that of an object and its shadow, where no table tells how far down it reaches."""

from __future__ import annotations

import pytest
from rendered_solids import PLACED, RIG, rectified
from rendering import Cylinder, Scene, lamp_at

from stereo_pick.core.correspondence.feature import Feature
from stereo_pick.core.pipeline import Steps

STEP = (0.05, 0.02), (0.035, 0.02)  # diameters and heights


@pytest.mark.parametrize(
    ("albedo", "of_table", "table", "reasons"),
    [
        (0.7, 0.2, "found", []),
        (0.1, 0.7, "found", ["shaded"]),
        (0.1, 0.7, "none", []),
    ],
    ids=["bright", "dark", "dark and hanging"],
)
def test_what_no_solid_explains_has_a_place_unless_it_may_be_one_with_its_shadow(
    albedo: float, of_table: float, table: str, reasons: list[str]
) -> None:
    (thick, low), (thin, high) = STEP
    parts = (
        Cylinder(0.0, 0.0, (thick, thick, low), albedo=albedo),
        Cylinder(0.0, 0.0, (thin, thin, high), base_m=low, albedo=albedo),
    )
    lamp = lamp_at(60.0, 110.0, 1.0, 2.0, 0.1)
    scene = Scene(parts, PLACED, table_albedo=of_table, lamps=(lamp,), ambient=0.5, shadows=True)
    steps = Steps(method=Feature(table=table))
    _, matches = steps.correspond(rectified(RIG, scene))
    poses = steps.locate(matches, RIG, 0)
    assert [each.reason for each in poses.refused] == reasons
    assert list(poses.kinds) == [""] * (1 - len(reasons))
