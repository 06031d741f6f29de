"""Object poses: position, direction and size."""

from __future__ import annotations

import numpy as np
import pytest
from outlines import PARALLEL, blank_pair, seen
from rigs import RIGS, rotation

from stereo_pick.core.arrays import Floats
from stereo_pick.core.camera import Camera
from stereo_pick.core.correspondence import Correspondences
from stereo_pick.core.correspondence.feature import Feature
from stereo_pick.core.errors import ArrayError
from stereo_pick.core.objects import Blob
from stereo_pick.core.poses import ObjectPoses, estimate_poses
from stereo_pick.core.refusal import Refusal
from stereo_pick.core.rig import StereoRig
from stereo_pick.core.triangulation import Points, Triangulator

LENGTH_M, WIDTH_M = 0.08, 0.03


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
    np.testing.assert_allclose(poses.size_m, [(LENGTH_M, WIDTH_M)], rtol=0.05)
    off = poses.yaw_rad[0] - np.deg2rad(yaw_deg)
    assert np.rad2deg(np.arcsin(abs(np.sin(off)))) < 1.5


def test_on_parallel_cameras_size_and_yaw_are_exact() -> None:
    poses = poses_of(PARALLEL, plate(0.4, (-0.05, 0.03, 1.2)))
    np.testing.assert_allclose(poses.size_m, [(LENGTH_M, WIDTH_M)], rtol=1e-3)
    assert np.sin(poses.yaw_rad[0] - 0.4) == pytest.approx(0, abs=1e-3)


@pytest.mark.parametrize("name", RIGS)
def test_positions_project_onto_the_raw_pixels_that_are_told(name: str) -> None:
    rig = RIGS[name]
    poses = poses_of(rig, plate(0.3, (-0.06, 0.02, 0.95)), plate(0.1, (0.06, -0.05, 0.85)))
    left_raw, right_raw = rig.project(poses.xyz)
    assert len(poses) == 2 and poses.stamp_ns == 7
    np.testing.assert_allclose(poses.left_px, left_raw, atol=0.1)
    np.testing.assert_allclose(poses.right_px, right_raw, atol=0.1)


def test_quaternions_turn_x_into_the_length_about_z() -> None:
    count, yaw = 3, np.array([-1.2, 0.0, 2.0])
    poses = ObjectPoses(
        0, np.zeros((count, 3)), yaw, np.ones((count, 2)), np.zeros((count, 3, 3)), np.zeros(count),
        np.zeros((count, 2)), np.zeros((count, 2)),
    )  # fmt: skip
    for (x, y, z, w), angle in zip(poses.quaternions(), yaw):
        turned = (1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w))
        np.testing.assert_allclose(turned, (np.cos(angle), np.sin(angle), 0), atol=1e-12)


def test_no_points_give_no_poses_but_keep_the_refusals() -> None:
    refused = (Refusal("faint", np.zeros(2), None),)
    none = np.zeros((0, 2))
    found = Correspondences(none, none, none, none, np.zeros(0), refused)
    points = Triangulator().triangulate(found, RIGS["verged"])
    poses = estimate_poses(points, found, RIGS["verged"], 1)
    assert len(poses) == 0 and poses.refused == refused and poses.quaternions().shape == (0, 4)


def test_a_pose_that_is_not_finite_cannot_be_made() -> None:
    with pytest.raises(ArrayError, match="xyz holds nan"):
        Points(np.full((1, 3), np.nan), np.zeros((1, 3, 3)), np.zeros(1), np.zeros(1, np.int64))
