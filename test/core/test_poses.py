"""Object poses: position, direction and size."""

from __future__ import annotations

import numpy as np
import pytest
from outlines import PARALLEL, blank_pair, seen
from rendering import Box, Cylinder, Scene, render
from rigs import RIGS, rotation

from stereo_pick.core.arrays import Floats
from stereo_pick.core.camera import Camera
from stereo_pick.core.correspondence import Correspondences
from stereo_pick.core.correspondence.feature import Feature
from stereo_pick.core.errors import ArrayError
from stereo_pick.core.objects import Blob
from stereo_pick.core.pipeline import Pipeline, Steps
from stereo_pick.core.poses import ObjectPoses, estimate_poses
from stereo_pick.core.refusal import Refusal
from stereo_pick.core.rig import StereoRig
from stereo_pick.core.triangulation import Points, Triangulator

LENGTH_M, WIDTH_M = 0.08, 0.03
SIGMA_PX = 0.5


def plate(yaw_rad: float, centre_m: tuple[float, float, float]) -> Floats:
    """Corners (4, 3) [m] of a plate that faces the left camera, its length turned by yaw from x towards y."""
    corners = np.array([(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)]) * (LENGTH_M / 2, WIDTH_M / 2, 0)
    return corners @ rotation((0, 0, yaw_rad)).T + centre_m


def outline(lens: Camera, corners: Floats) -> Blob:
    turned = corners @ lens.R.T
    return Blob(turned[:, :2] / turned[:, 2:] * lens.P[0, 0] + lens.P[:2, 2], contrast=100.0)


def poses_of(rig: StereoRig, *plates: Floats) -> ObjectPoses:
    left = [outline(rig.left, corners) for corners in plates]
    right = [outline(rig.right, rig.right_T_left.apply(corners)) for corners in plates]
    generous = Feature(epipolar_tolerance_px=10, max_area_ratio=3.0)
    found = generous.match(blank_pair(rig), seen(left, right))
    points = Triangulator().triangulate(found, rig)
    return estimate_poses(points, found, rig, stamp_ns=7)


@pytest.mark.parametrize("name", RIGS)
@pytest.mark.parametrize("yaw_deg", [-80, -30, 0, 20, 65])
def test_a_plate_has_its_place_size_and_yaw(name: str, yaw_deg: float) -> None:
    poses = poses_of(RIGS[name], plate(np.deg2rad(yaw_deg), (0.02, -0.01, 0.9)))
    np.testing.assert_allclose(poses.xyz, [(0.02, -0.01, 0.9)], atol=5e-4)  # perspective moves centroids
    np.testing.assert_allclose(poses.size_m, [(LENGTH_M, WIDTH_M, 0)], rtol=0.05)
    off = poses.heading_rad[0] - np.deg2rad(yaw_deg)
    assert np.rad2deg(np.arcsin(abs(np.sin(off)))) < 1.5


def test_on_parallel_cameras_size_and_yaw_are_exact() -> None:
    poses = poses_of(PARALLEL, plate(0.4, (-0.05, 0.03, 1.2)))
    np.testing.assert_allclose(poses.size_m, [(LENGTH_M, WIDTH_M, 0)], rtol=1e-3)
    assert np.sin(poses.heading_rad[0] - 0.4) == pytest.approx(0, abs=1e-3)


@pytest.mark.parametrize("name", RIGS)
def test_positions_project_onto_the_raw_pixels_that_are_told(name: str) -> None:
    rig = RIGS[name]
    poses = poses_of(rig, plate(0.3, (-0.06, 0.02, 0.95)), plate(0.1, (0.06, -0.05, 0.85)))
    left_raw, right_raw = rig.project(poses.xyz)
    assert len(poses) == 2 and poses.stamp_ns == 7
    np.testing.assert_allclose(poses.left_px, left_raw, atol=0.1)
    np.testing.assert_allclose(poses.right_px, right_raw, atol=0.1)


@pytest.mark.parametrize("name", RIGS)
def test_confidence_is_how_often_noisy_measurements_are_near_enough(name: str) -> None:
    rig, rng = RIGS[name], np.random.default_rng(11)
    point = np.array([[0.05, -0.03, 0.95]])
    left_px, right_px = rig.project(point)
    exact = np.hstack([rig.left.rectified(left_px), rig.right.rectified(right_px)])
    steps = Steps(triangulator=Triangulator(max_ray_gap_m=1.0, tolerance_m=0.002))
    stated = steps.locate(matched(exact), rig, 1)
    off_m = np.linalg.norm(steps.locate(matched(rng.normal(exact, SIGMA_PX, (20000, 4))), rig, 1).xyz - point, axis=1)
    assert stated.tolerance_m == 0.002
    assert 0.05 < stated.confidence[0] < 0.99
    assert stated.confidence[0] == pytest.approx(np.mean(off_m <= 0.002), abs=0.02)


def matched(points_px: Floats) -> Correspondences:
    """Matches of left and right points (N, 4)."""
    count = len(points_px)
    sigma_px, size_px = np.full((count, 2), SIGMA_PX), np.ones((count, 2))
    return Correspondences(points_px[:, :2], points_px[:, 2:], sigma_px, size_px, np.zeros(count))


def test_quaternions_turn_x_into_the_length_and_z_down_into_the_table() -> None:
    turns = np.array([rotation(vector) for vector in ((0.1, -0.7, 1.2), (0, 0, 0), (2.8, 0.3, -0.4))])
    count = len(turns)
    poses = ObjectPoses(
        0, np.zeros((count, 3)), turns, np.ones((count, 3)), ("",) * count, np.zeros((count, 3, 3)), np.zeros(count),
        np.zeros((count, 2)), np.zeros((count, 2)), 0.005,
    )  # fmt: skip
    for (x, y, z, w), turn in zip(poses.quaternions(), turns):
        length = (1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w))
        down = (2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y))
        np.testing.assert_allclose(np.stack([length, down], axis=1), turn[:, [0, 2]], atol=1e-9)


PARTS = {
    "a standing cylinder": Cylinder(0.0, 0.0, (0.04, 0.04, 0.06)),
    "a box": Box(0.0, 0.0, (0.07, 0.05, 0.04), yaw_rad=0.5),
    "a lying cylinder": Cylinder(0.0, 0.0, (0.03, 0.03, 0.08), yaw_rad=-0.6, lying=True),
}


@pytest.mark.parametrize("name", PARTS)
def test_a_part_has_its_size_and_lies_as_it_does(name: str) -> None:
    """Beside two other parts, which tell where the table is."""
    part = PARTS[name]
    others = Cylinder(-0.11, 0.02, (0.04, 0.04, 0.05)), Box(0.11, -0.02, (0.05, 0.04, 0.045), yaw_rad=0.2)
    scene = Scene((part, *others), ambient=0.8)
    poses = Pipeline(RIGS["thesis"], Steps()).run(render(RIGS["thesis"], scene)).poses
    at = int(np.linalg.norm(poses.xyz - scene.positions_m()[0], axis=1).argmin())
    table_R_part = scene.left_T_table.rotation.T @ poses.rotation[at]
    assert poses.kinds[at] == type(part).__name__.lower()
    np.testing.assert_allclose(poses.size_m[at], part.extent_m, atol=1.2e-3)
    assert table_R_part[2, 2] < -np.cos(np.deg2rad(2))
    if name != "a standing cylinder":
        yaw_rad = np.arctan2(table_R_part[1, 0], table_R_part[0, 0])
        assert abs(np.sin(yaw_rad - part.yaw_rad)) < np.sin(np.deg2rad(2))


def test_no_points_give_no_poses_but_keep_the_refusals() -> None:
    refused = (Refusal("faint", np.zeros(2), None),)
    none = np.zeros((0, 2))
    found = Correspondences(none, none, none, none, np.zeros(0), refused)
    points = Triangulator().triangulate(found, RIGS["verged"])
    poses = estimate_poses(points, found, RIGS["verged"], 1)
    assert len(poses) == 0 and poses.refused == refused and poses.quaternions().shape == (0, 4)


def test_a_pose_that_is_not_finite_cannot_be_made() -> None:
    with pytest.raises(ArrayError, match="xyz holds nan"):
        Points(np.full((1, 3), np.nan), np.zeros((1, 3, 3)), np.zeros(1), np.zeros(1, np.int64), 0.005)
