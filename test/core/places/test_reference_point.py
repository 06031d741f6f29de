"""The point of an object that its position is."""

from __future__ import annotations

import numpy as np
import pytest
from rendering import Box, Cylinder, Scene, Sphere, render
from rigs import RIGS

from stereo_pick.core.arrays import Floats
from stereo_pick.core.correspondence.feature import Feature
from stereo_pick.core.pipeline import Pipeline, Steps

RIG = RIGS["thesis"]
PARTS = (
    Cylinder(-0.10, 0.0, (0.04, 0.04, 0.06)),
    Box(0.0, 0.01, (0.06, 0.05, 0.04), yaw_rad=0.3),
    Sphere(0.10, 0.0, (0.05, 0.05, 0.05)),
)
SCENE = Scene(PARTS, ambient=0.8)


def positions_m(choice: str) -> Floats:
    poses = Pipeline(RIG, Steps(method=Feature(reference_point=choice))).run(render(RIG, SCENE)).poses
    assert len(poses) == len(PARTS)
    return poses.xyz


def test_the_top_is_half_the_height_above_the_centre() -> None:
    tops = SCENE.left_T_table.apply(np.array([part.centre_m + (0, 0, part.size_m[2] / 2) for part in PARTS]))
    np.testing.assert_allclose(positions_m("top"), tops, atol=1.5e-3)


def test_the_surface_is_met_on_the_way_from_the_left_camera() -> None:
    origin = SCENE.left_T_table.inverse().translation
    centres = SCENE.positions_m()
    rays = centres @ SCENE.left_T_table.rotation  # turned into the table's frame
    for part, centre, ray, found in zip(PARTS, centres, rays, positions_m("surface")):
        reach_m = part.hit(origin, ray[None] / np.linalg.norm(ray)).at[0]
        np.testing.assert_allclose(found, centre / np.linalg.norm(centre) * reach_m, atol=1.5e-3)


@pytest.mark.parametrize("choice", ["top", "surface"])
def test_an_object_of_unknown_shape_has_no_such_point(choice: str) -> None:
    """Outlines of whole pixels explain no solid."""
    steps = Steps(method=Feature(reference_point=choice))
    steps = Steps(detector=type(steps.detector)(subpixel=False), method=steps.method)
    poses = Pipeline(RIG, steps).run(render(RIG, SCENE)).poses
    assert len(poses) == 0 and {refusal.reason for refusal in poses.refused} == {"no_solid"}
