"""Where an object's centre is, from renderings with truth: found, or refused, but not mistaken."""

from __future__ import annotations

from functools import cache
from typing import NamedTuple

import numpy as np
import pytest
from families import staged
from marks import first_of
from rendered_solids import half_lit_scene
from rendering import Box, Cylinder, Scene, Solid, render
from rendering.rigs import table_before
from rigs import RIGS

from stereo_pick.core.arrays import Floats
from stereo_pick.core.correspondence.feature import Feature
from stereo_pick.core.pipeline import Pipeline, Steps
from stereo_pick.core.poses import ObjectPoses
from stereo_pick.core.refusal import count_reasons

RIG = RIGS["thesis"]
TABLE = table_before(RIG, 0.9, elevation_deg=50)
SEEDS = 20


def poses_of(scene: Scene, flat_parts: bool = False, seed: int = 0) -> ObjectPoses:
    steps = Steps(method=Feature(flat_parts=flat_parts))
    return Pipeline(RIG, steps).run(render(RIG, scene, seed=seed)).poses


def off_m(poses: ObjectPoses, scene: Scene) -> Floats:
    """Distance (N,) of each pose from the nearest centre."""
    apart = poses.xyz[:, None] - scene.positions_m()
    return np.asarray(np.linalg.norm(apart, axis=2).min(axis=1))


class Outcome(NamedTuple):
    sides: float
    off_m: Floats
    refused: dict[str, int]


@cache
def half_lit() -> list[Outcome]:
    """One cylinder each, lit from above: its sides between as bright as the table and 20 grey levels brighter."""
    outcomes = []
    for seed in range(SEEDS):
        random = np.random.default_rng(seed)
        table = table_before(RIG, random.uniform(0.85, 0.95), random.uniform(35, 65), random.uniform(0, 360))
        (x, y), width = random.uniform(-0.02, 0.02, 2), random.uniform(0.03, 0.045)
        part = Cylinder(x, y, (width, width, random.uniform(0.03, 0.06)))
        sides = random.uniform(0, 0.08)
        scene = half_lit_scene((part,), table, sides)
        poses = poses_of(scene, seed=seed)
        outcomes.append(Outcome(sides, off_m(poses, scene), count_reasons(poses.refused)))
    return outcomes


def test_a_half_lit_cylinder_is_found_or_refused() -> None:
    """Its top alone would be half its height off, 15 to 30 mm."""
    for outcome in half_lit():
        assert (outcome.off_m < 5e-3).all()
        assert len(outcome.off_m) == 1 or outcome.refused
    found = np.array([outcome.off_m[0] for outcome in half_lit() if len(outcome.off_m)])
    assert len(found) >= SEEDS / 3
    assert (found < 5e-4).mean() >= 0.85


def test_sides_without_any_edge_are_never_guessed() -> None:
    without = [outcome for outcome in half_lit() if outcome.sides < 0.01]
    assert without and not any(len(outcome.off_m) for outcome in without)
    assert all(outcome.refused.keys() & {"flat", "half_lit"} for outcome in without)


def test_sides_of_a_few_grey_levels_are_enough() -> None:
    clear = [outcome for outcome in half_lit() if outcome.sides > 0.055]
    assert clear and all(len(outcome.off_m) for outcome in clear)


def test_a_flat_part_needs_to_be_allowed() -> None:
    plates: tuple[Solid, ...] = (
        Box(-0.06, 0.0, (0.05, 0.03, 0.001), yaw_rad=0.5),
        Cylinder(0.06, 0.01, (0.04, 0.04, 0.001)),
    )
    scene = Scene(plates, TABLE)
    refused = poses_of(scene)
    assert len(refused) == 0 and count_reasons(refused.refused) == {"flat": 2}
    allowed = poses_of(scene, flat_parts=True)
    assert len(allowed) == 2 and not allowed.refused
    assert (off_m(allowed, scene) < 5e-4).all()


def test_who_allows_flat_parts_gets_the_lit_tops_of_bodies_too() -> None:
    body = Cylinder(0.0, 0.0, (0.04, 0.04, 0.05))
    scene = half_lit_scene((body,), TABLE, 0.0)
    assert count_reasons(poses_of(scene).refused) == {"flat": 1}
    poses = poses_of(scene, flat_parts=True)
    np.testing.assert_allclose(poses.xyz, [TABLE.apply(body.top_m)], atol=1e-3)


def touching(seed: int) -> Scene:
    """Two parts that touch, in any direction from each other."""
    random = np.random.default_rng(seed)
    angle = random.uniform(0, 2 * np.pi)
    x, y = 0.5 * np.array([np.cos(angle), np.sin(angle)])
    one = Cylinder(0.04 * x, 0.04 * y, (0.04, 0.04, 0.05))
    if seed % 2:
        return Scene((one, Box(-0.046 * x, -0.046 * y, (0.046, 0.046, 0.04), yaw_rad=angle)), TABLE, ambient=0.7)
    return Scene((one, Cylinder(-0.04 * x, -0.04 * y, (0.04, 0.04, 0.05))), TABLE, ambient=0.7)


@pytest.mark.parametrize("seed", [0, 1, 3, 4, *first_of(6, 2, 5), 7, 8, 9])
def test_of_touching_parts_each_is_found_or_none_but_nothing_between(seed: int) -> None:
    scene = touching(seed)
    poses = poses_of(scene)
    assert (off_m(poses, scene) < 5e-3).all()
    assert len(poses) or count_reasons(poses.refused).keys() & {"merged", "half_lit"}


def test_touching_cylinders_beside_each_other_are_both_found() -> None:
    right = TABLE.rotation.T @ (1.0, 0.0, 0.0) * 0.02
    scene = Scene(tuple(Cylinder(s * right[0], s * right[1], (0.04, 0.04, 0.05)) for s in (-1, 1)), TABLE, ambient=0.7)
    poses = poses_of(scene)
    assert len(poses) == 2 and poses.kinds == ("cylinder", "cylinder")
    assert (off_m(poses, scene) < 5e-4).all()


def test_touching_parts_are_no_tube_with_a_bite() -> None:
    """Two thirds of the outline that two of these have in common lie on one, which is enough for a tube by itself."""
    scene = staged("bright_and_dark", 13)
    frame, truth = scene.taken()
    poses = Pipeline(scene.rig, Steps()).run(frame).poses
    centres = np.array([each.centre_m for each in truth.objects])
    assert np.linalg.norm(poses.xyz[:, None] - centres, axis=2).min(axis=1).max() < 5e-3
