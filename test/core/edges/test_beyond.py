"""Edges beyond an outline: those of a body that is seen in part, and none where there is no body."""

from __future__ import annotations

import numpy as np
import pytest
from rendered_solids import half_lit_scene, rectified, solid_of
from rendering import Box, Cylinder, Scene, Solid
from rendering.rigs import table_before
from rigs import RIGS

from stereo_pick.core.arrays import Floats
from stereo_pick.core.edges.beyond import Contour, shown_beyond
from stereo_pick.core.edges.edge_map import EdgeMap
from stereo_pick.core.shapes.predicted import silhouettes
from stereo_pick.core.shapes.solids import Solids

RIG = RIGS["thesis"]
TABLE = table_before(RIG, 0.9, elevation_deg=50)
EYES = np.array([[0.0, 0.0, 0.0], [RIG.baseline_m, 0.0, 0.0]])
PARTS: dict[str, Solid] = {
    "cylinder": Cylinder(0.0, 0.0, (0.04, 0.04, 0.05)),
    "box": Box(0.0, 0.0, (0.04, 0.05, 0.04), yaw_rad=0.6),
}


def views(scene: Scene) -> list[EdgeMap]:
    pair = rectified(RIG, scene)
    return [EdgeMap.of(image, camera) for image, camera in ((pair.left, RIG.left), (pair.right, RIG.right))]


def contours(solid: Solids, own: bool = True) -> list[Contour]:
    """The silhouettes of a solid, of which all points are its own or none."""
    lines: list[Floats] = [
        silhouettes(solid, EYES)[0, i] * RIG.focal_px + camera.P[:2, 2]
        for i, camera in enumerate((RIG.left, RIG.right))
    ]
    return [(line, np.full(len(line), own)) for line in lines]


@pytest.mark.parametrize("name", PARTS)
def test_a_body_shows_its_sides_beyond_its_lit_top(name: str) -> None:
    scene = half_lit_scene([PARTS[name]], TABLE, 0.08)
    top = solid_of(RIG, scene, PARTS[name], height_m=0.001)
    assert shown_beyond(solid_of(RIG, scene, PARTS[name]), EYES, views(scene), contours(top)) > 0.9


@pytest.mark.parametrize("name", PARTS)
def test_the_table_shows_nothing_beyond_a_plate(name: str) -> None:
    """Only where the sides begin, near the plate itself, there is an edge."""
    scene = half_lit_scene([PARTS[name]], TABLE, 0.0)
    top = solid_of(RIG, scene, PARTS[name], height_m=0.001)
    assert shown_beyond(solid_of(RIG, scene, PARTS[name]), EYES, views(scene), contours(top)) < 0.5


@pytest.mark.parametrize("name", PARTS)
def test_what_something_else_may_hide_does_not_count(name: str) -> None:
    scene = half_lit_scene([PARTS[name]], TABLE, 0.0)
    top = solid_of(RIG, scene, PARTS[name], height_m=0.001)
    solid = solid_of(RIG, scene, PARTS[name])
    assert shown_beyond(solid, EYES, views(scene), contours(top, own=False)) == 1
    assert shown_beyond(solid, EYES, views(scene), contours(solid)) == 1
