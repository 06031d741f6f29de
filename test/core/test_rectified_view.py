"""The rectified view: rows are epipolar lines, the scale is kept, and nothing that both cameras see is lost."""

from __future__ import annotations

from dataclasses import replace

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from rigs import RIGS, SIZE_PX, camera, looking_at, random_rigs, rotation

from stereo_pick.core.arrays import Floats
from stereo_pick.core.camera import Camera
from stereo_pick.core.errors import CalibrationError
from stereo_pick.core.rectified_view import rectification_maps, rectifying_rotations, valid_region
from stereo_pick.core.rig import StereoRig
from stereo_pick.core.transform import Transform


def points_before(rig: StereoRig, count: int = 60) -> Floats:
    """Points (N, 3) [m] in the left frame that lie before both cameras."""
    pixels = np.random.default_rng(5).uniform((0, 0), SIZE_PX, (count, 2))
    depth_m = np.random.default_rng(6).uniform(0.4, 3.0, count)
    points = np.c_[rig.left.normalized(pixels), np.ones(count)] * depth_m[:, None]
    return points[rig.right_T_left.apply(points)[:, 2] > 0.1]


def homogeneous(lens: Camera, points: Floats) -> Floats:
    projected = np.c_[points @ lens.R.T, np.ones(len(points))] @ lens.P.T
    return projected[:, :2] / projected[:, 2:]


@given(random_rigs(distorted=False))
def test_a_point_has_the_same_row_in_both_views(rig: StereoRig) -> None:
    points = points_before(rig)
    left_px, right_px = (lens.rectified(raw) for lens, raw in zip((rig.left, rig.right), rig.project(points)))
    np.testing.assert_allclose(left_px[:, 1], right_px[:, 1], atol=1e-5)


@given(random_rigs(distorted=False))
def test_disparity_is_focal_length_times_baseline_by_depth(rig: StereoRig) -> None:
    points = points_before(rig)
    left_px, right_px = (lens.rectified(raw) for lens, raw in zip((rig.left, rig.right), rig.project(points)))
    disparity = left_px[:, 0] - right_px[:, 0] - (rig.left.P[0, 2] - rig.right.P[0, 2])
    np.testing.assert_allclose(rig.focal_px * rig.baseline_m / disparity, points @ rig.left.R[2], rtol=1e-6)


@settings(max_examples=40)
@given(random_rigs())
def test_the_focal_length_is_that_of_the_raw_cameras_or_down_to_half(rig: StereoRig) -> None:
    raw_px = np.mean([lens.K[i, i] for lens in (rig.left, rig.right) for i in (0, 1)])
    assert 0.5 * raw_px * (1 - 1e-9) <= rig.focal_px <= raw_px * (1 + 1e-9)


def test_a_rig_that_is_rectified_already_stays_as_it_is() -> None:
    rig = StereoRig.from_extrinsics(camera("left"), camera("right"), Transform(np.eye(3), np.array([-0.1, 0, 0])))
    np.testing.assert_allclose(rig.left.P[:, :3], rig.left.K, atol=1e-6)
    np.testing.assert_allclose(rig.left.R, np.eye(3), atol=1e-12)


@settings(max_examples=25)
@given(random_rigs())
def test_both_rectified_views_hold_what_both_cameras_see(rig: StereoRig) -> None:
    assert max(lost_fractions(rig)) <= 0.04


@pytest.mark.parametrize("name", RIGS)
def test_typical_rigs_hold_98_percent_of_what_both_cameras_see(name: str) -> None:
    assert max(lost_fractions(RIGS[name])) <= 0.02


def lost_fractions(rig: StereoRig) -> list[float]:
    """What part of each raw image's pixels lies outside the rectified view, although its row is on both of them."""
    u, v = np.meshgrid(np.arange(0, SIZE_PX[0], 7), np.arange(0, SIZE_PX[1], 7))
    raw = np.c_[u.ravel(), v.ravel()]
    rectified = [lens.rectified(raw) for lens in (rig.left, rig.right)]
    first = max(pixels[:, 1].min() for pixels in rectified)
    last = min(pixels[:, 1].max() for pixels in rectified)
    outside = [((pixels < 0) | (pixels > np.array(SIZE_PX) - 1)).any(axis=1) for pixels in rectified]
    return [
        float((lost & (pixels[:, 1] >= first) & (pixels[:, 1] <= last)).mean())
        for lost, pixels in zip(outside, rectified)
    ]


def test_the_thesiss_rig_keeps_its_scale_where_opencv_loses_the_objects() -> None:
    """On this verged rig OpenCV's alpha = 0, the default of ROS's calibrator, zooms in until no object is left."""
    rig = RIGS["thesis"]
    assert rig.focal_px >= 0.85 * rig.left.K[0, 0]
    R1, R2, P1, P2, *_ = cv2.stereoRectify(
        rig.left.K, rig.left.D, rig.right.K, rig.right.D, SIZE_PX,
        rig.right_T_left.rotation, rig.right_T_left.translation, flags=cv2.CALIB_ZERO_DISPARITY, alpha=0,
    )  # fmt: skip
    assert P1[0, 0] > 3 * rig.left.K[0, 0]
    points = np.array([(-0.128, 0.005, 0.884), (0.006, -0.078, 1.004), (0.07, 0.03, 0.9)])
    opencv = [
        Camera(lens.name, *SIZE_PX, lens.K, lens.D, R, P) for lens, R, P in ((rig.left, R1, P1), (rig.right, R2, P2))
    ]
    seen = [inside(rig.left, rig.right, points), inside(*opencv, points)]
    assert seen[0].all() and not seen[1].all()


def inside(left: Camera, right: Camera, points: Floats) -> Floats:
    shown = [homogeneous(left, points)]
    turned = points @ left.R.T @ right.R  # the same point, seen along the right camera's own axes
    shown.append(homogeneous(right, turned))
    return np.array([((pixels >= 0) & (pixels < SIZE_PX)).all(axis=1) for pixels in shown]).all(axis=0)


@given(random_rigs(distorted=False))
def test_the_baseline_is_the_rectified_x_axis_and_both_share_the_view(rig: StereoRig) -> None:
    left_R, right_R = rectifying_rotations(rig.right_T_left)
    along = left_R @ rig.right_T_left.inverse().translation
    np.testing.assert_allclose(along, (np.linalg.norm(along), 0, 0), atol=1e-9)
    np.testing.assert_allclose(right_R @ rig.right_T_left.rotation, left_R, atol=1e-9)


@pytest.mark.parametrize("name", RIGS)
def test_the_view_looks_half_way_between_the_cameras(name: str) -> None:
    """Turning about the baseline is the one freedom of a rectified view; in it both axes are equally far off."""
    above = [lens.R[1, 2] for lens in (RIGS[name].left, RIGS[name].right)]
    assert above[0] == pytest.approx(-above[1], abs=1e-9)


@pytest.mark.parametrize("model", ["plumb_bob", "rational_polynomial", "equidistant"])
def test_the_maps_lead_every_rectified_pixel_to_its_raw_one(model: str) -> None:
    D = {"plumb_bob": (-0.2, 0.05, 0.001, 0, 0), "rational_polynomial": (0.5, 0.1, 0, 0, 0, 0.7, 0.2, 0)}
    lens = camera(D=D.get(model, (0.02, 0.0, 0.0, 0.0)), model=model)
    rig = StereoRig.from_extrinsics(lens, lens, looking_at((0.2, 0.0, 0.0), (0.1, 0.0, 1.0)))
    map_x, map_y = rectification_maps(rig.left)
    rows, columns = np.array([5, 100, 240, 470]), np.array([10, 300, 320, 600])
    raw = rig.left.unrectified(np.stack([columns, rows], axis=1))
    np.testing.assert_allclose(map_x[rows, columns], raw[:, 0], atol=1e-3)
    np.testing.assert_allclose(map_y[rows, columns], raw[:, 1], atol=1e-3)


def test_the_valid_region_is_where_the_raw_image_reaches() -> None:
    lens = RIGS["thesis"].left
    region = valid_region(lens)
    rows, columns = np.nonzero(np.ones(region.shape, bool))
    raw = lens.unrectified(np.stack([columns, rows], axis=1)).reshape(*region.shape, 2)
    clearly_in = ((raw > 0.01) & (raw < np.array(SIZE_PX) - 1.01)).all(axis=2)
    clearly_out = ((raw < -0.01) | (raw > np.array(SIZE_PX) - 0.99)).any(axis=2)
    assert region[clearly_in].all() and not region[clearly_out].any() and not region.flags.writeable
    assert clearly_in.any() and clearly_out.any()


def test_a_lens_that_shows_nothing_is_refused() -> None:
    with pytest.raises(CalibrationError, match=r"left camera: its rectified view shows nothing .* D = \[1\.e\+09"):
        valid_region(replace(camera("left"), D=np.array([1e9, 0, 0, 0, 0])))


def test_a_wide_lens_keeps_half_its_scale() -> None:
    fisheye = camera(focal_px=210.0, D=(0.0, 0.0, 0.0, 0.0), model="equidistant")
    rig = StereoRig.from_extrinsics(fisheye, fisheye, Transform(rotation((0, 0.02, 0)), np.array([-0.1, 0, 0])))
    assert rig.focal_px == pytest.approx(105.0)
