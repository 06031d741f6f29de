"""Where one part stands on a plate, another one of which the foot does not show may stand there, too."""

from __future__ import annotations

from dataclasses import replace

import pytest
from rendered_solids import PLACED, RIG, half_lit_scene, rectified, solid_of, table_of, true_fit
from rendering import Box, Cylinder, Solid

from stereo_pick.core.arrays import Floats
from stereo_pick.core.edges.adjustment import adjusted
from stereo_pick.core.edges.hypotheses import Images
from stereo_pick.core.tables.raised import raised_m

TABLE = table_of(RIG, PLACED)
PLATE_M = 0.012
ON_PLATE = Box(-0.1, 0.0, (0.05, 0.04, 0.045), yaw_rad=0.4, albedo=0.4, base_m=PLATE_M)
PLATE = Box(-0.05, 0.0, (0.2, 0.12, PLATE_M))
PARTS = {
    "cylinder": Cylinder(0.0, 0.0, (0.045, 0.045, 0.05), base_m=PLATE_M),
    "box": Box(0.0, 0.0, (0.05, 0.04, 0.05), yaw_rad=0.7, base_m=PLATE_M),
}

each_part = pytest.mark.parametrize("part", PARTS.values(), ids=PARTS.keys())


def raised(part: Solid, sides: float, *others: Solid, plate: Solid | None = None) -> Floats:
    """How much higher each may end, the part first, which was taken to reach down to the table.

    sides: by how much light its sides differ from the table; plate: what was found besides.
    """
    scene = half_lit_scene([part, *others], PLACED, sides)
    images = Images(rectified(RIG, scene))
    tall = solid_of(RIG, scene, part, height_m=part.height_m + part.base_m)
    down = replace(true_fit(RIG, scene, part), centre_m=tall.centre_m[0], size_m=tall.size_m()[0])
    found = adjusted([down], images.maps, RIG, TABLE, known=True)[0]
    found += [adjusted([true_fit(RIG, scene, each)], images.maps, RIG, None)[0][0] for each in others]
    if plate is not None:
        found.append(replace(found[0], fit=true_fit(RIG, scene, plate)))
    return raised_m(images, found, TABLE)


@each_part
@pytest.mark.parametrize("base_m", [PLATE_M, 0.0])
def test_a_lit_top_may_be_that_of_a_part_on_the_plate(part: Solid, base_m: float) -> None:
    """Wherever it stands: nothing tells."""
    assert raised(replace(part, base_m=base_m), 0.0, ON_PLATE) == pytest.approx([PLATE_M, 0.0], abs=1e-3)


@each_part
def test_what_shows_its_foot_stands_where_it_does(part: Solid) -> None:
    on_table = replace(part, base_m=0.0)
    assert raised(on_table, 0.15, ON_PLATE) == pytest.approx([0.0, 0.0])
    assert raised(part, 0.15, ON_PLATE) == pytest.approx([PLATE_M, 0.0], abs=1e-3)


@each_part
def test_without_a_part_on_a_plate_there_is_none(part: Solid) -> None:
    assert raised(part, 0.0) == pytest.approx([0.0])
    assert raised(part, 0.0, replace(ON_PLATE, base_m=0.0)) == pytest.approx([0.0, 0.0])


@each_part
def test_what_stands_on_another_part_tells_of_no_plate(part: Solid) -> None:
    assert raised(part, 0.0, ON_PLATE, plate=PLATE) == pytest.approx([0.0, 0.0, 0.0])
