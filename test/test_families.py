"""The families of scenes show what their names say, and the evaluation counts what is wrong."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from families import FAMILIES, staged
from family_report import report
from family_rivals import held_to_its_point
from family_scoring import SceneScore, score
from family_tables import covariance_table
from placing import Table, footprint_gap_m
from processes import each
from reliability import reliability_table
from rendering import Box, Cylinder, Solid, TrueObject, Truth
from rendering.rigs import BENCH_RIGS, DISTANCES_M, table_before
from rivals import Contender

from stereo_pick.core.arrays import Floats
from stereo_pick.core.transform import Transform

SEEDS = range(6)
staged_once = cache(staged)


def gaps_px(family: str, seed: int) -> list[tuple[float, float]]:
    scene = staged_once(family, seed)
    table = Table(scene.rig, scene.scene.left_T_table, np.random.default_rng(0))
    solids = scene.scene.solids
    return [table.gaps_px(one, other) for n, one in enumerate(solids) for other in solids[:n]]


@pytest.mark.parametrize("family", FAMILIES)
def test_a_seed_gives_the_same_scene_and_another_seed_another(family: str) -> None:
    one, again, other = (staged(family, seed) for seed in (3, 3, 4))
    assert one.scene.solids == again.scene.solids
    assert one.noise_seed == again.noise_seed != other.noise_seed


@pytest.mark.parametrize("family", sorted(set(FAMILIES) - {"touching", "occluded"}))
@pytest.mark.parametrize("seed", range(2))
def test_parts_stand_apart_and_whole_in_both_images(family: str, seed: int) -> None:
    scene = staged_once(family, seed)
    table = Table(scene.rig, scene.scene.left_T_table, np.random.default_rng(0))
    assert all(table.whole(solid) for solid in scene.scene.solids)
    assert min((min(pair) for pair in gaps_px(family, seed)), default=9.0) > 3.9


@pytest.mark.parametrize("seed", SEEDS)
def test_two_identical_cylinders_differ_in_depth_as_in_the_thesis(seed: int) -> None:
    scene = staged("two_cylinders", seed).scene
    assert len({solid.size_m for solid in scene.solids}) == 1
    first, second = scene.positions_m()
    assert 0.034 < abs(first[2] - second[2]) < 0.241


@pytest.mark.parametrize("seed", SEEDS)
def test_touching_parts_are_in_contact_or_their_images_nearly(seed: int) -> None:
    solids = staged_once("touching", seed).scene.solids
    closest = min(min(pair) for pair in gaps_px("touching", seed))
    apart_m = footprint_gap_m(solids[0], solids[1])
    assert apart_m >= 0
    assert closest <= 3.01 or apart_m < 0.0005


@pytest.mark.parametrize("seed", range(3))
def test_a_part_is_hidden_in_one_view_only(seed: int) -> None:
    _, truth = staged("occluded", seed).taken()
    hidden = [sorted(each.visible) for each in truth.objects if min(each.visible) < 0.97]
    assert len(hidden) == 1
    assert 0.3 < hidden[0][0] < 0.97 and hidden[0][1] > 0.99


@pytest.mark.parametrize("name", BENCH_RIGS)
@pytest.mark.parametrize("elevation_deg", [30.0, 90.0])
def test_the_table_is_seen_at_its_elevation_and_equally_far_from_both_image_centres(
    name: str, elevation_deg: float
) -> None:
    rig, distance = BENCH_RIGS[name], DISTANCES_M[name][0]
    left_T_table = table_before(rig, distance, elevation_deg, turn_deg=20)
    camera = left_T_table.inverse().translation
    assert np.linalg.norm(camera) == pytest.approx(distance)
    assert camera[2] / distance == pytest.approx(np.sin(np.deg2rad(elevation_deg)))
    left, right = rig.project(left_T_table.translation[None])
    assert left[0, 0] - rig.left.width_px / 2 == pytest.approx(rig.right.width_px / 2 - right[0, 0], rel=0.05, abs=2)


def true_object(solid: Solid) -> TrueObject:
    return TrueObject(
        "part", solid.lying, solid.centre_m, solid.top_m, None, solid.extent_m, solid.yaw_rad, solid.yaw_period_rad,
        (1.0, 1.0),
    )  # fmt: skip


PARTS = (Box(0, 0, (0.04, 0.06, 0.05), yaw_rad=0.3), Cylinder(0.06, 0, (0.05, 0.05, 0.05)))
TRUTH = Truth(tuple(true_object(part) for part in PARTS), Transform.identity())
CENTRES_M = TRUTH.centres_m


def scored(xyz: Floats, yaw_rad: float = 0.0) -> SceneScore:
    """The score of poses at these points [m], boxes of 60 x 40 x 50 mm that state a sigma of 1 mm."""
    turn = [0, 0, np.sin(yaw_rad / 2), np.cos(yaw_rad / 2)]
    poses = SimpleNamespace(
        xyz=xyz,
        covariance=np.tile(np.eye(3) * 1e-6, (len(xyz), 1, 1)),
        size_m=np.tile([0.06, 0.04, 0.05], (len(xyz), 1)),
        quaternions=lambda: np.tile(turn, (len(xyz), 1)),
        refused=(),
    )
    pipeline: Any = SimpleNamespace(run=lambda frame: SimpleNamespace(poses=poses))
    frame: Any = None
    return score("mixed_shapes", 0, pipeline, frame, TRUTH)


def test_poses_at_the_truth_are_right() -> None:
    result = scored(CENTRES_M + (0.001, 0, 0), yaw_rad=0.3 + np.pi / 2 + np.pi)
    assert result.right and not result.missed and result.wrong == 0
    assert result.mahalanobis2 == pytest.approx([1, 1])
    assert result.distances_m == pytest.approx([0.001, 0.001])
    assert result.depths_m == pytest.approx([0])
    box, cylinder = result.found
    np.testing.assert_allclose(box.size_m, 0, atol=1e-12)
    assert box.yaw_rad == pytest.approx(0, abs=1e-9) and cylinder.yaw_rad is None


def test_what_is_missing_doubled_or_between_is_counted() -> None:
    missed = scored(CENTRES_M[:1])
    assert missed.missed == [1] and not missed.right and missed.wrong == 0
    between = scored(CENTRES_M.mean(axis=0, keepdims=True) + (0, 0, 0.015))
    assert between.between == 1 and len(between.ghosts_m) == 1 and between.missed == [0, 1]
    doubled = scored(np.concatenate([CENTRES_M, CENTRES_M[:1] + 0.002]))
    assert len(doubled.ghosts_m) == 1 and not doubled.right
    assert doubled.mahalanobis2 == pytest.approx([0, 0, np.inf])
    wrong = scored(CENTRES_M + (0, 0, 0.006))
    assert wrong.wrong == wrong.unadmitted == 2 and not wrong.missed and not wrong.right


def test_what_is_published_though_wrong_counts_among_the_distances() -> None:
    far_off = CENTRES_M + (0, 0, 0.019)
    scores = [scored(CENTRES_M), scored(far_off), scored(np.concatenate([CENTRES_M, CENTRES_M[:1] + 0.002]))]
    last = covariance_table(scores).splitlines()[-1]
    assert [cell.strip() for cell in last.split("|")[2:-1]] == ["7", "0.00", "361.00", "∞", "∞", "∞", "57.1 %", "1"]


def test_confidence_is_held_against_how_many_are_near_enough() -> None:
    scores = [scored(CENTRES_M + (0, 0, 0.0015)), scored(np.concatenate([CENTRES_M, CENTRES_M[:1] + 0.002]))]
    stated = [chi_3(tolerance) for tolerance in (0.5, 1, 2, 5)]
    rows = [[cell.strip() for cell in line.split("|")[1:-1]] for line in reliability_table(scores).splitlines()[2:]]
    assert [row for row in rows if row[2] != "0"] == [
        ["0.5 mm", "below 0.5", "5", f"{stated[0]:.4f}", "0.4000", f"{5 * (1 - stated[0]):.2f}", "3"],
        ["1 mm", "below 0.5", "5", f"{stated[1]:.4f}", "0.4000", f"{5 * (1 - stated[1]):.2f}", "3"],
        ["2 mm", "0.5 to 0.9", "5", f"{stated[2]:.4f}", "0.8000", f"{5 * (1 - stated[2]):.2f}", "1"],
        ["5 mm", "above 0.999", "5", f"{stated[3]:.4f}", "0.8000", "0.00", "1"],
    ]
    assert {tuple(row[2:]) for row in rows if row[2] == "0"} == {("0", "–", "–", "–", "–")}
    assert reliability_table([scored(CENTRES_M[:0])]).count("| 0 |") == 20


def chi_3(sigmas: float) -> float:
    """The probability that an error with the same sigma in all directions is no longer than so many sigmas."""
    return math.erf(sigmas / math.sqrt(2)) - math.sqrt(2 / math.pi) * sigmas * math.exp(-(sigmas**2) / 2)


def test_the_report_says_how_many_were_found_and_how_many_are_wrong() -> None:
    scores = [scored(CENTRES_M), scored(CENTRES_M[:1] + (0, 0, 0.006))]
    text = report(scores, [])
    assert "Of 4 parts that must be found, 3 are; of 3 positions that are published, 1 are more than 5 mm wrong" in text
    assert "wrong, 1 of them by more than their covariance admits" in text
    assert "### Confidence" in text and reliability_table(scores) in text
    (of_shape,) = [line for line in text.splitlines() if line.startswith("| part |")]
    assert of_shape == "| part | 3 | 0.00 | 36.00 | 36.00 | 36.00 | 36.00 | 66.7 % | 1 |"


def test_other_methods_are_held_to_the_point_that_they_mean() -> None:
    surface_m = CENTRES_M - [(0, 0, 0.02), (0, 0, 0.03)]
    truth = Truth(tuple(replace(each, visible_m=m) for each, m in zip(TRUTH.objects, surface_m)), TRUTH.left_T_table)
    found: Any = SimpleNamespace(xyz=surface_m + (0, 0, 0.001), refused=())
    of_surface, of_volume = (
        held_to_its_point("", Contender("", meant, lambda frame: found), found, truth)
        for meant in ("mean of visible surface", "centre of volume")
    )
    assert of_surface.depths_m == pytest.approx([0]) and of_surface.distances_m == pytest.approx([0.001, 0.001])
    assert of_volume.depths_m == pytest.approx([0.01]) and of_volume.distances_m == pytest.approx([0.019, 0.029])


def test_processes_change_nothing() -> None:
    assert each(range(12), math.factorial, processes=2) == each(range(12), math.factorial, processes=1)
