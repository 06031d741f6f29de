"""Solids on a known table, of which only the lit tops show clearly."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from rendered_solids import centre_m, half_lit_scene, rectified
from rendering import Box, Cylinder, HexPrism, Scene, Solid, hex_prism_size
from rendering.rigs import table_before
from rigs import RIGS, rotation
from solid_outlines import contour_px
from solids_on_table import MIXED, part_on_table, table_of

from stereo_pick.core.arrays import Floats
from stereo_pick.core.edges.flush import resting
from stereo_pick.core.edges.hypotheses import Images
from stereo_pick.core.edges.shared_face import shared_face
from stereo_pick.core.edges.standing import set_down, standing
from stereo_pick.core.shapes import Outline
from stereo_pick.core.shapes.kinds import KINDS
from stereo_pick.core.shapes.solids import Solids
from stereo_pick.core.shapes.table import Table

RIG = RIGS["thesis"]
PLACED = table_before(RIG, 0.9, elevation_deg=45)
NORMAL = RIG.left.R @ PLACED.rotation[:, 2]
SIDES = 0.06  # brighter than the table, of white
PARTS: list[Solid] = [
    Cylinder(0.0, 0.0, (0.04, 0.04, 0.05)),
    Box(0.01, 0.0, (0.05, 0.036, 0.04), yaw_rad=0.4),
    HexPrism(0.0, 0.01, hex_prism_size(0.045, 0.04), yaw_rad=0.3),
]


def table_m(lifted_m: float = 0.0) -> Table:
    return Table(NORMAL, -float(NORMAL @ RIG.left.R @ PLACED.translation) - lifted_m, 5e-4)


def top_outlines(part: Solid) -> tuple[Outline, Outline]:
    """The exact outlines of the part's top alone."""
    corners = part.hull_m()
    return outlines(corners[corners[:, 2] > part.height_m - 1e-9])


def outlines(corners_m: Floats) -> tuple[Outline, Outline]:
    """Those of a convex body, given in the frame of the table."""
    seen: Floats = PLACED.apply(corners_m) @ RIG.left.R.T
    eyes = ((0.0, 0.0, 0.0), (RIG.baseline_m, 0.0, 0.0))
    left, right = (contour_px(seen - eye, lens) for eye, lens in zip(eyes, (RIG.left, RIG.right)))
    return Outline.from_contour(left), Outline.from_contour(right)


@pytest.mark.parametrize("part", PARTS, ids=lambda part: type(part).__name__)
def test_from_its_top_a_part_is_found_down_to_the_table(part: Solid) -> None:
    scene = half_lit_scene((part,), PLACED, SIDES)
    (found,) = standing(Images(rectified(RIG, scene)), [top_outlines(part)], table_m())
    assert found is not None and found.believable
    assert found.fit.kind == type(part).__name__.lower()
    np.testing.assert_allclose(found.fit.centre_m, centre_m(RIG, scene, part), atol=6e-4)
    np.testing.assert_allclose(sorted(found.fit.size_m), sorted(part.size_m), atol=2e-3)


@pytest.mark.parametrize("shows_top", [0, 1], ids=["left", "right"])
@pytest.mark.parametrize("part", PARTS, ids=lambda part: type(part).__name__)
def test_one_view_may_show_the_top_alone_and_the_other_the_whole(part: Solid, shows_top: int) -> None:
    scene = half_lit_scene((part,), PLACED, SIDES)
    seen = list(outlines(part.hull_m()))
    seen[shows_top] = top_outlines(part)[shows_top]
    (found,) = standing(Images(rectified(RIG, scene)), [(seen[0], seen[1])], table_m())
    assert found is not None and found.fit.kind == type(part).__name__.lower()
    np.testing.assert_allclose(found.fit.centre_m, centre_m(RIG, scene, part), atol=1e-3)
    np.testing.assert_allclose(sorted(found.fit.size_m), sorted(part.size_m), atol=2e-3)


@pytest.mark.parametrize("part", PARTS, ids=lambda part: type(part).__name__)
def test_the_top_of_one_view_is_moved_to_the_others(part: Solid) -> None:
    images = Images(rectified(RIG, half_lit_scene((part,), PLACED, SIDES)))
    top, whole = top_outlines(part), outlines(part.hull_m())
    for pair in ((top[0], whole[1]), (whole[0], top[1])):
        face = shared_face(pair, RIG, images.maps, table_m())
        assert face is not None
        for side, exact in zip(face, top):
            apart_px = np.linalg.norm(side.points_px[:, None] - exact.points_px, axis=2).min(axis=1)
            assert apart_px.max() < 3.0  # half of two points' distance, and a pixel of disparity
    assert shared_face(whole, RIG, images.maps, table_m()) is None


@pytest.mark.parametrize("part", PARTS, ids=lambda part: type(part).__name__)
def test_without_the_edges_of_its_sides_nothing_is_found(part: Solid) -> None:
    scene = half_lit_scene((part,), PLACED, 0.0)
    assert standing(Images(rectified(RIG, scene)), [top_outlines(part)], table_m()) == [None]


@pytest.mark.parametrize("part", PARTS, ids=lambda part: type(part).__name__)
def test_on_a_wrong_table_nothing_is_found(part: Solid) -> None:
    images = Images(rectified(RIG, half_lit_scene((part,), PLACED, SIDES)))
    assert standing(images, [top_outlines(part)], table_m(lifted_m=-0.02)) == [None]


@pytest.mark.parametrize("normal", [(0.0, -0.99, -0.141), (0.0, -0.999, 0.045), (0.0, 0.0, 1.0)])
def test_a_table_that_no_camera_sees_bears_nothing(normal: tuple[float, float, float]) -> None:
    """Edge-on, from below, or behind the cameras."""
    images = Images(rectified(RIG, half_lit_scene(PARTS[:1], PLACED, SIDES)))
    top, whole = top_outlines(PARTS[0]), outlines(PARTS[0].hull_m())
    table = Table(np.array(normal), 0.5, 5e-4)
    assert shared_face((top[0], whole[1]), RIG, images.maps, table) is None
    assert standing(images, [(top[0], whole[1])], table) == [None]


def test_an_empty_view_supports_nothing() -> None:
    images = Images(rectified(RIG, Scene((), PLACED)))
    assert standing(images, [top_outlines(PARTS[0])], table_m()) == [None]


@pytest.mark.parametrize("which", range(len(MIXED)))
@given(st.tuples(*[st.floats(-0.08, 0.08)] * 3), st.floats(-0.003, 0.003))
def test_what_nearly_stands_is_set_down(which: int, turned_rad: tuple[float, float, float], lifted_m: float) -> None:
    table, part = table_of(40), part_on_table(40, MIXED[which])
    there = Solids(KINDS[part.kind], part.centre_m[None], part.rotation[None], part.half_m[None], np.zeros((1, 3, 0)))
    off = replace(
        there,
        centre_m=there.centre_m + lifted_m * table.normal,
        rotation=rotation(turned_rad) @ there.rotation,
    )
    found = set_down(off, table)
    own, flat = resting(found.kind, table.normal @ found.rotation)
    upright = float(table.normal @ found.rotation[0] @ own[0])
    assert float(table.under(found)[0][0]) == pytest.approx(0, abs=1e-9)
    assert upright == pytest.approx(1.0 if flat[0] else 0.0, abs=1e-9)
    assert np.linalg.norm(found.centre_m - there.centre_m) < 0.004
    turned = found.rotation[0] @ off.rotation[0].T  # no further than it was off
    assert np.trace(turned) > np.trace(rotation(turned_rad)) - 1e-9
