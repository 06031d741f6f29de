"""Which longer solids speak against a shorter one: those that have the edges that it lacks."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from rendered_solids import half_lit_scene, rectified, solid_of
from rendering import Box, Cylinder, Solid
from rendering.rigs import table_before
from rigs import RIGS

from stereo_pick.core.shapes.hypotheses import Images

RIG = RIGS["thesis"]
TABLE = table_before(RIG, 0.9, elevation_deg=50)
TOWARDS_CAMERAS = TABLE.rotation.T @ (0.0, 1.0, 0.0)
PART = Cylinder(0.0, 0.0, (0.04, 0.04, 0.05))


def before(distance_m: float) -> Solid:
    """A low box that stands across in front of the part."""
    x, y = TOWARDS_CAMERAS[:2] / np.linalg.norm(TOWARDS_CAMERAS[:2]) * distance_m
    return Box(float(x), float(y), (0.1, 0.01, 0.01), yaw_rad=float(np.arctan2(y, x)) + np.pi / 2)


@pytest.mark.parametrize("distance_m", [0.04, 0.05, 0.06])
def test_the_edges_of_a_neighbour_make_no_whole_body_longer(distance_m: float) -> None:
    scene = half_lit_scene([PART, before(distance_m)], TABLE, 0.3)
    assert Images(rectified(RIG, scene)).contradicts(solid_of(RIG, scene, PART)) is None


@pytest.mark.parametrize("height_m", [0.001, 0.01, 0.02, 0.03])
@pytest.mark.parametrize("sides", [0.05, 0.1, 0.15])
def test_a_piece_of_a_body_is_told_by_the_edges_beyond_it(height_m: float, sides: float) -> None:
    scene = half_lit_scene([PART], TABLE, sides)
    piece = solid_of(RIG, scene, PART, height_m=height_m)
    longer = Images(rectified(RIG, scene)).contradicts(piece)
    assert longer is not None and longer.fit.size_m[2] > PART.height_m - 1e-3


def test_where_no_view_shows_an_edge_nothing_is_believed() -> None:
    scene = half_lit_scene([PART], TABLE, 0.1)
    pair = rectified(RIG, scene)
    dark = replace(pair, left=np.zeros_like(pair.left), right=np.zeros_like(pair.right))
    found = Images(dark).locked(solid_of(RIG, scene, PART).turning_freely())
    assert not found.believable and not found.raises_doubt and found.support == 0
