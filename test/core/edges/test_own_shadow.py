"""What a part's own shadow hides of it, on drawn images and in rendered scenes with exact truth."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from rendered_solids import PARTS, PLACED, RIG, rectified, solid_of, table_of
from rendering import Cylinder, Scene, Solid, lamp_at

from stereo_pick.core.arrays import Floats, Image
from stereo_pick.core.edges.adjustment import adjusted
from stereo_pick.core.edges.hypotheses import Images
from stereo_pick.core.edges.own_shadow import ends_in_light, heights, in_own_shadow, is_dark
from stereo_pick.core.shapes import SolidFit

TABLE = table_of(RIG, PLACED)
ROD = Cylinder(0.0, 0.0, (0.03, 0.03, 0.07), yaw_rad=0.4, lying=True, albedo=0.04)
PART, SHADOW, LIT = 20, 60, 200  # grey levels
_SIDE_PX, _EDGE_PX = 200, 100


@pytest.mark.parametrize("name", PARTS)
def test_silhouettes_reach_from_the_table_or_above_it_to_the_top(name: str) -> None:
    solid = solid_of(RIG, Scene((PARTS[name],), PLACED), PARTS[name])
    high = heights(solid, RIG.eyes_m, TABLE)[0]
    assert high.max() == 1.0
    foot = {"standing": 0.0, "box": 0.0, "sphere": (1 - np.sin(np.deg2rad(50))) / 2, "lying": 0.1}[name]
    np.testing.assert_allclose(high.min(axis=1), foot, atol=0.1)


def half(level: int, shadow: int) -> tuple[Image, Floats, Floats, Floats]:
    """A part left of an edge, with its shadow to the right of the lower half of that, and the edge's points, normals
    and heights."""
    image = np.full((_SIDE_PX, _SIDE_PX), LIT, np.uint8)
    image[:, : _EDGE_PX + 1] = level
    image[_SIDE_PX // 2 :, _EDGE_PX + 1 : _EDGE_PX + 20] = shadow
    rows = np.arange(20.0, 180.0)
    points = np.stack([np.full(len(rows), _EDGE_PX + 0.5), rows], axis=1)
    high = np.interp(rows, [20.0, 180.0], [1.0, 0.0])
    return image, points[None], np.tile([1.0, 0.0], (1, len(rows), 1)), high[None]


def test_what_is_low_and_darker_outside_than_above_is_hidden_and_nothing_else() -> None:
    image, points_px, outwards, high = half(PART, SHADOW)
    hidden = in_own_shadow(image, points_px, outwards, high)[0]
    np.testing.assert_array_equal(hidden, points_px[0, :, 1] >= _SIDE_PX // 2)
    assert not in_own_shadow(image, points_px, outwards, 1 - high).any()


@pytest.mark.parametrize(("level", "shadow"), [(PART, LIT), (PART, LIT - 20), (250, SHADOW)])
def test_what_is_lit_all_around_or_brighter_than_the_table_is_not_hidden(level: int, shadow: int) -> None:
    image, *edge = half(level, shadow)
    assert not in_own_shadow(image, *edge).any()


def test_of_what_is_all_low_nothing_is_known() -> None:
    image, points_px, outwards, high = half(PART, SHADOW)
    assert not in_own_shadow(image, points_px, outwards, 0 * high).any()


@pytest.mark.parametrize(("inside", "dark"), [(PART, True), (LIT, False)])
def test_an_outline_is_dark_if_it_is_darker_inside(inside: int, dark: bool) -> None:
    image = np.full((_SIDE_PX, _SIDE_PX), LIT + PART - inside, np.uint8)
    image[60:140, 60:140] = inside
    corners = np.array([[60, 60], [100, 60], [140, 60], [140, 100], [140, 140], [100, 140], [60, 140], [60, 100]])
    assert is_dark(image, corners - 0.5) == dark


@pytest.mark.parametrize("part", [ROD, replace(PARTS["box"], albedo=0.04)], ids=["rod", "box"])
def test_a_dark_part_ends_in_light_and_a_piece_of_it_does_not(part: Solid) -> None:
    lamp = lamp_at(75.0, 290.0, 1.0, 1.5, 0.25)
    scene = Scene((part,), PLACED, table_albedo=0.8, lamps=(lamp,), ambient=0.4, shadows=True)
    views, true = Images(rectified(RIG, scene)).maps, solid_of(RIG, scene, part)
    assert ends_in_light(true, views, RIG, TABLE)
    for along in (-1, 1):  # a half of it, cut across its longest axis
        axis = int(np.argmax(true.size_m()[0]))
        half_m = true.half_m.copy()
        half_m[0, true.kind.axes[axis]] /= 2
        middle = true.centre_m + along * true.rotation[0, :, axis] * half_m[0, true.kind.axes[axis]]
        assert not ends_in_light(replace(true, centre_m=middle, half_m=half_m), views, RIG, TABLE)


@pytest.mark.parametrize(
    ("albedo", "table", "is_hidden"), [(0.04, 0.8, True), (0.9, 0.2, False)], ids=["dark", "bright"]
)
def test_what_its_shadow_hides_of_a_dark_part_speaks_neither_for_nor_against_it(
    albedo: float, table: float, is_hidden: bool
) -> None:
    """At its place: without that, a third of its edges was missing or another's."""
    part = replace(ROD, albedo=albedo)
    lamp = lamp_at(75.0, 290.0, 1.0, 1.5, 0.25)
    scene = Scene((part,), PLACED, table_albedo=table, lamps=(lamp,), ambient=0.4, shadows=True)
    images, true = Images(rectified(RIG, scene)), solid_of(RIG, scene, part).turning_about(TABLE.normal)
    fit = SolidFit(true.kind.name, true.centre_m[0], true.rotation[0], true.size_m()[0], 0.1, 1e-8 * np.eye(3))
    supports = [each.locked(true, TABLE).support for each in (images, images.in_own_shadow())]
    shown = [adjusted([fit], images.maps, RIG, TABLE, True, in_shadow=each)[0][0].shown for each in (False, True)]
    for without, within in (supports, shown):
        assert within > 0.92
        assert (without < within - 0.1) == is_hidden
