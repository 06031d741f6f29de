"""What outlines show beside a solid is more of the object where it rises from the table, and else its shadow."""

from __future__ import annotations

from dataclasses import replace

import evaluate_unknown
import pytest
from mahalanobis import CHI2_3
from marks import first_of
from rendered_solids import PLACED, RIG, rectified, table_of, true_fit
from rendering import Box, Cylinder, HexPrism, Lamp, Scene, Solid, Sphere, lamp_at

from stereo_pick.core.doubts.rising_outline import rises_beside
from stereo_pick.core.objects.detector import Detector
from stereo_pick.core.places.position import BlobPair

LOW: Lamp = lamp_at(35.0, 110.0, 1.5, 2.0, 0.02)
BODY = Cylinder(0.0, 0.0, (0.042, 0.042, 0.03), albedo=0.1)
NECK = Cylinder(0.0, 0.0, (0.018, 0.018, 0.03), base_m=0.03, albedo=0.1)


def on_paper(*parts: Solid) -> Scene:
    """Dark parts that throw shadows."""
    return Scene(parts, PLACED, table_albedo=0.7, lamps=(LOW,), ambient=0.5, shadows=True)


def outlines(scene: Scene) -> BlobPair:
    """Those of the one object there is."""
    blobs = Detector().detect(rectified(RIG, scene))
    (left,), (right,) = blobs.left, blobs.right
    return left, right


def test_the_neck_of_a_bottle_rises_beside_its_body_unless_it_is_known() -> None:
    scene, table = on_paper(BODY, NECK), table_of(RIG, PLACED)
    body, neck = true_fit(RIG, scene, BODY), true_fit(RIG, scene, NECK)
    seen = outlines(scene)
    assert rises_beside(seen, [body], RIG, table)
    assert not rises_beside(seen, [body, neck], RIG, table)


@pytest.mark.parametrize(
    "part",
    [
        BODY,
        Box(0.0, 0.0, (0.05, 0.04, 0.04), yaw_rad=0.4, albedo=0.1),
        HexPrism(0.0, 0.0, (0.04, 0.04 * 2 / 3**0.5, 0.05), yaw_rad=0.2, albedo=0.1),
        Sphere(0.0, 0.0, (0.045,) * 3, albedo=0.1),
        Cylinder(0.0, 0.0, (0.035, 0.035, 0.07), yaw_rad=0.5, albedo=0.1, lying=True),
    ],
    ids=["cylinder", "box", "hexprism", "sphere", "lying"],
)
def test_a_shadow_lies_on_the_table(part: Solid) -> None:
    scene, table = on_paper(part), table_of(RIG, PLACED)
    seen, fit = outlines(scene), true_fit(RIG, scene, part)
    assert not rises_beside(seen, [fit], RIG, table)
    assert rises_beside(seen, [fit], RIG, replace(table, offset_m=table.offset_m + 0.02))  # so it is looked at


@pytest.mark.parametrize(
    ("shape", "seed"),
    [*first_of(("bottle", 8), ("bottle", 7), ("bottle", 9)), *first_of(("step", 10), ("step", 3), ("step", 4))],
)
def test_a_dark_part_of_unknown_shape_is_not_surely_the_piece_of_it_that_is_known(shape: str, seed: int) -> None:
    """Their bodies were taken for all of them, 2 to 7 mm off, with a sigma of tenths."""
    scored = evaluate_unknown.scored(("dark", shape, seed))
    assert all(surprise < CHI2_3[99] for surprise in scored.mahalanobis2)
    assert scored.found == scored.known
