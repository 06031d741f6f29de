"""A part on a table like a mirror is never surely the solid that it and its image make up."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from rendered_solids import PLACED, RIG
from rendering import CLEAN, Box, Cylinder, Scene, Solid, Sphere, views_of
from rendering.rigs import table_before

from stereo_pick.core.frames import StereoFrame
from stereo_pick.core.pipeline import Pipeline, Steps
from stereo_pick.core.poses import ObjectPoses
from stereo_pick.core.transform import Transform

DEEP_M = 0.2
STANDING = {
    "cylinder": (Cylinder(0.0, 0.0, (0.04, 0.04, 0.05)),),
    "box": (Box(0.0, 0.0, (0.05, 0.036, 0.04), yaw_rad=0.5),),
    "three": tuple(Cylinder(x, y, (0.03, 0.03, 0.05)) for x, y in ((-0.08, 0.0), (0.0, 0.06), (0.08, 0.0))),
}


def poses_on_a_mirror(
    parts: tuple[Solid, ...], reflected: float, placed: Transform = PLACED
) -> tuple[Scene, ObjectPoses]:
    """Of parts and their images, of which the table shows that part of the light."""
    scene = Scene(parts, placed, table_albedo=0.2, ambient=0.7)
    down = Transform(placed.rotation, placed.translation - placed.rotation[:, 2] * DEEP_M)
    images = tuple(replace(part, base_m=DEEP_M - part.height_m) for part in parts)
    seen, mirrored = (views_of(RIG, each) for each in (scene, Scene(images, down, table_albedo=0.0, ambient=0.7)))
    random = np.random.default_rng(0)
    both = [
        CLEAN.expose(one.light + reflected * np.where((one.labels == 0) & (other.labels > 0), other.light, 0), random)
        for one, other in zip(seen, mirrored)
    ]
    return scene, Pipeline(RIG, Steps()).run(StereoFrame(*both)).poses


@pytest.mark.parametrize("parts", STANDING.values(), ids=STANDING)
def test_a_part_and_its_image_are_not_surely_one_of_twice_the_height(parts: tuple[Solid, ...]) -> None:
    scene, poses = poses_on_a_mirror(parts, 0.3)
    off_m = [np.linalg.norm(scene.positions_m() - xyz, axis=1).min() for xyz in poses.xyz]
    assert all(confidence < 0.5 for off, confidence in zip(off_m, poses.confidence) if off > 1e-3)


def test_the_image_of_a_ball_is_not_surely_another_one() -> None:
    parts = (Sphere(0.06, 0.0, (0.04,) * 3), Cylinder(-0.06, 0.0, (0.04, 0.04, 0.05)))
    scene, poses = poses_on_a_mirror(parts, 0.3)
    off_m = np.array([np.linalg.norm(scene.positions_m() - xyz, axis=1).min() for xyz in poses.xyz])
    assert (off_m < 1e-3).any(), "the ball itself"
    assert (poses.confidence[off_m > 1e-3] < 0.5).all()


def test_nor_is_it_where_nothing_tells_of_the_table() -> None:
    """Seen low: each part and its image make up another solid, and these stand on no plane together."""
    parts = (
        Cylinder(-0.08, 0.0, (0.04, 0.04, 0.05)),
        Box(0.0, 0.02, (0.05, 0.036, 0.04), yaw_rad=0.5),
        Sphere(0.07, 0.0, (0.04,) * 3),
        Cylinder(0.0, -0.06, (0.03, 0.03, 0.07), yaw_rad=0.3, lying=True),
    )
    scene, poses = poses_on_a_mirror(parts, 0.3, table_before(RIG, 0.9, elevation_deg=35))
    off_m = np.array([np.linalg.norm(scene.positions_m() - xyz, axis=1).min() for xyz in poses.xyz])
    assert (poses.confidence[off_m > 1e-3] < 0.5).all()


@pytest.mark.parametrize("parts", STANDING.values(), ids=STANDING)
def test_on_a_dull_table_they_are_sure(parts: tuple[Solid, ...]) -> None:
    _, poses = poses_on_a_mirror(parts, 0.0)
    assert len(poses) == len(parts) and poses.confidence.min() > 0.99
