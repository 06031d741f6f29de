"""The table below the lit tops of bodies, from the edges of their feet and from other bodies."""

from __future__ import annotations

import numpy as np
import pytest
from rendered_solids import half_lit_scene, rectified, solid_of
from rendering import Box, Cylinder, Scene, Solid
from rendering.rigs import table_before
from rigs import RIGS

from stereo_pick.core.arrays import Floats
from stereo_pick.core.edges.below_faces import tables_below
from stereo_pick.core.edges.hypotheses import Images
from stereo_pick.core.shapes.solid_fit import SolidFit
from stereo_pick.core.shapes.table import Table

RIG = RIGS["thesis"]
PLACED = table_before(RIG, 0.9, elevation_deg=50)
PARTS: tuple[Solid, ...] = (Cylinder(-0.06, 0.0, (0.04, 0.04, 0.05)), Box(0.05, 0.0, (0.05, 0.036, 0.045), yaw_rad=0.4))
THIN_M = 0.001


def as_fit(scene: Scene, part: Solid, height_m: float | None = None, turned: Floats | None = None) -> SolidFit:
    solid = solid_of(RIG, scene, part, height_m, turned)
    return SolidFit(solid.kind.name, solid.centre_m[0], solid.rotation[0], solid.size_m()[0], 0.1, 1e-8 * np.eye(3))


def height_m(table: Table) -> float:
    """Of the true table's origin above one."""
    return float(table.height_m(RIG.left.R @ PLACED.translation))


@pytest.mark.parametrize("which", [(0,), (1,), (0, 1)], ids=["cylinder", "box", "both"])
def test_feet_show_how_far_down_the_table_is(which: tuple[int, ...]) -> None:
    scene = half_lit_scene(PARTS, PLACED, sides=0.05)
    tops = [as_fit(scene, PARTS[i], THIN_M) for i in which]
    found = tables_below(tops, [], Images(rectified(RIG, scene)).maps, RIG.eyes_m)
    assert found and min(abs(height_m(table)) for table in found) < 3e-3
    normal = RIG.left.R @ PLACED.rotation[:, 2]
    assert all(table.normal @ normal > np.cos(np.deg2rad(0.1)) for table in found)


def test_where_no_foot_shows_another_body_tells() -> None:
    """The box has no edges but its top's; the cylinder is known to the ground."""
    scene = half_lit_scene(PARTS, PLACED, sides=0.0)
    views = Images(rectified(RIG, scene)).maps
    top, body = as_fit(scene, PARTS[1], THIN_M), as_fit(scene, PARTS[0])
    assert tables_below([top], [], views, RIG.eyes_m) == []
    (found,) = tables_below([top], [body], views, RIG.eyes_m)
    assert abs(height_m(found)) < 1e-6


def test_neither_rods_nor_what_is_seen_edge_on_are_tops() -> None:
    scene = half_lit_scene(PARTS, PLACED, sides=0.05)
    views = Images(rectified(RIG, scene)).maps
    rod = as_fit(scene, Cylinder(0.0, 0.0, (0.004, 0.004, 0.05)))
    ray = np.asarray(rod.centre_m / np.linalg.norm(rod.centre_m))
    beside = np.cross(ray, (0.0, 1.0, 0.0))
    beside /= np.linalg.norm(beside)
    edge_on = SolidFit(
        "box",
        rod.centre_m,
        np.stack([beside, np.cross(ray, beside), ray], axis=1),
        np.array([THIN_M, 0.05, 0.05]),
        0.1,
        1e-8 * np.eye(3),
    )
    assert tables_below([rod, edge_on], [], views, RIG.eyes_m) == []
