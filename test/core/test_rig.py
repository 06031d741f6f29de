"""Two cameras as one rig, and the calibrations that no real rig can have."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from rigs import RIGS, camera, looking_at, random_rigs, rotation, thesis_cameras

from stereo_pick.core.errors import CalibrationError
from stereo_pick.core.rig import StereoRig
from stereo_pick.core.transform import Transform


def rig_of(centre_m: tuple[float, float, float], unit: float = 1.0) -> StereoRig:
    """A rig whose right camera stands at `centre_m`, read as if in another unit."""
    towards = looking_at(centre_m, (centre_m[0], centre_m[1], 1.0))
    shift = Transform(towards.rotation, towards.translation * unit)
    return StereoRig.from_extrinsics(camera("left"), camera("right"), shift)


@given(random_rigs())
def test_the_right_projection_holds_the_baseline(rig: StereoRig) -> None:
    assert rig.right.P[0, 3] == pytest.approx(-rig.focal_px * rig.baseline_m)
    assert rig.left.P[0, 3] == 0 and rig.left.P[1, 3] == rig.right.P[1, 3] == 0
    assert rig.baseline_m == pytest.approx(np.linalg.norm(rig.right_T_left.inverse().translation))


@pytest.mark.parametrize("name", RIGS)
def test_the_extrinsics_survive_the_way_through_R_and_P(name: str) -> None:
    rig = RIGS[name]
    again = StereoRig.from_extrinsics(rig.left, rig.right, rig.right_T_left)
    np.testing.assert_allclose(again.right_T_left.rotation, rig.right_T_left.rotation, atol=1e-12)
    np.testing.assert_allclose(again.right_T_left.translation, rig.right_T_left.translation, atol=1e-12)


def test_the_thesiss_extrinsics_are_kept() -> None:
    _, _, right_T_left = thesis_cameras()
    np.testing.assert_allclose(RIGS["thesis"].right_T_left.rotation, right_T_left.rotation, atol=1e-12)
    np.testing.assert_allclose(RIGS["thesis"].right_T_left.translation, right_T_left.translation, atol=1e-12)
    assert RIGS["thesis"].baseline_m == pytest.approx(0.210344, abs=1e-6)


@given(st.floats(-0.2, 0.2), st.floats(-0.2, 0.2), st.floats(0.5, 2.0))
def test_a_point_is_projected_through_both_cameras(x: float, y: float, z: float) -> None:
    rig = RIGS["rolled"]
    left_px, right_px = rig.project([(x, y, z)])
    np.testing.assert_array_equal(left_px, rig.left.project([(x, y, z)]))
    in_right = rig.right_T_left.rotation @ (x, y, z) + rig.right_T_left.translation
    np.testing.assert_allclose(right_px, rig.right.project([in_right]), atol=1e-9)


def test_cameras_that_come_with_any_rectification_get_the_rigs_own() -> None:
    """Another program's R and P say where the cameras stand; the rectified view is made anew."""
    rig = RIGS["verged"]
    turn = looking_at((0.3, 0.1, 0.0), (0.0, 0.1, 0.9)).rotation.T
    common = np.array([[500.0, 0, 100, 0], [0, 500.0, 50, 0], [0, 0, 1, 0]])
    left_R, right_R = rig.left.R, rig.right.R
    right_P = common.copy()
    right_P[0, 3] = -500 * rig.baseline_m
    foreign = replace(rig.left, R=left_R, P=common), replace(rig.right, R=right_R, P=right_P)
    assert not np.allclose(turn, left_R)
    again = StereoRig.from_cameras(*foreign)
    np.testing.assert_allclose(again.left.P, rig.left.P)
    np.testing.assert_allclose(again.right.P, rig.right.P)


def test_cameras_of_two_image_sizes_are_refused() -> None:
    """Windows of one view reached beyond the other, which ended in a traceback."""
    rig = RIGS["verged"]
    small = replace(rig.right, width_px=320, height_px=240)
    with pytest.raises(
        CalibrationError, match="left camera's images are 640 x 480, the right one's 320 x 240: let both"
    ):
        StereoRig.from_cameras(rig.left, small)


def test_a_zero_baseline_is_refused() -> None:
    """data/vigir2024_same_camera: both images came from one camera, and the rms was excellent."""
    with pytest.raises(CalibrationError, match=r"baseline = 0\.100 mm is zero: both images come from the same place"):
        rig_of((0.0001, 0.0, 0.0))


def test_a_camera_info_of_a_single_calibration_is_refused() -> None:
    with pytest.raises(CalibrationError, match="calibrated one by one"):
        StereoRig.from_cameras(camera("left"), camera("right"))


def test_a_negative_baseline_is_refused() -> None:
    with pytest.raises(CalibrationError, match=r"baseline = -0\.2000 m is negative.*left and right are swapped"):
        rig_of((-0.2, 0.0, 0.0))


def test_a_camera_on_its_head_left_of_the_other_one_is_told_from_exchanged_ones() -> None:
    """Each stands left of the other one, as that sees it: to exchange them, as it said, led to the same error."""
    right_T_left = Transform(np.diag([-1.0, -1.0, 1.0]), np.array([-0.2, 0.0, 0.0]))
    for transform in (right_T_left, right_T_left.inverse()):
        with pytest.raises(CalibrationError, match=r"-0\.2000 m is negative.*one of them stands on its head"):
            StereoRig.from_extrinsics(camera("left"), camera("right"), transform)


@pytest.mark.parametrize("name", [name for name in RIGS if name != "vertical"])
def test_exchanged_cameras_are_refused(name: str) -> None:
    rig = RIGS[name]
    with pytest.raises(CalibrationError, match="swapped"):
        StereoRig.from_extrinsics(rig.right, rig.left, rig.right_T_left.inverse())
    with pytest.raises(CalibrationError, match=r"baseline -P\[0,3\] / fx of the right camera = -0\.\d+ m is negative"):
        StereoRig.from_cameras(rig.left, replace(rig.right, P=rig.right.P * np.where(np.arange(4) == 3, -1, 1)))


@pytest.mark.parametrize("name", RIGS)
def test_exchanged_camera_infos_are_refused(name: str) -> None:
    """P[0,3] stands in the right camera's; where it stands in the left one's, the files are exchanged."""
    with pytest.raises(CalibrationError, match=r"P\[0,3\] of the left camera = -\d.* swapped"):
        StereoRig.from_cameras(RIGS[name].right, RIGS[name].left)


def test_a_baseline_in_millimetres_is_refused() -> None:
    with pytest.raises(CalibrationError, match=r"baseline = 200\.0 m .* is in millimetres; divide .* by 1000"):
        rig_of((0.2, 0.0, 0.0), unit=1000)


def test_a_baseline_that_may_be_in_centimetres_is_not_called_one_in_millimetres() -> None:
    with pytest.raises(
        CalibrationError, match=r"baseline = 20\.0 m .* is in centimetres or millimetres; .* by 100 or by"
    ):
        rig_of((0.2, 0.0, 0.0), unit=100)


def test_cameras_one_above_the_other_are_no_swapped_ones() -> None:
    for height_m in (-0.2, 0.2):
        assert rig_of((-0.01, height_m, 0.0)).baseline_m == pytest.approx(0.2, rel=0.01)


@pytest.mark.parametrize("height_m", [0.0, 0.02])
@pytest.mark.parametrize("before_m", [-0.1, 0.1])
def test_a_camera_that_stands_where_the_other_one_looks_is_refused(height_m: float, before_m: float) -> None:
    with pytest.raises(
        CalibrationError, match=f"{height_m:.3f} below and {before_m:.3f} before it, and looks 0 deg away"
    ):
        rig_of((0.005, height_m, before_m))
    assert rig_of((0.1, height_m, before_m)).baseline_m > 0.1, "aslant"


def test_cameras_exactly_behind_each_other_are_refused() -> None:
    with pytest.raises(CalibrationError, match="0.000 below and -0.100 before it"):
        StereoRig.from_extrinsics(camera("left"), camera("right"), Transform(np.eye(3), np.array([0.0, 0.0, 0.1])))


def turned_by(turned_deg: float) -> StereoRig:
    """A rig of two lenses of 53 degrees, each of which is turned towards the other one by half of that."""
    towards = [rotation((0.0, np.deg2rad(sign * turned_deg / 2), 0.0)) for sign in (-1, 1)]
    left_T_world, right_T_turned = (Transform(each, np.zeros(3)) for each in towards)
    right_T_left = right_T_turned @ Transform(np.eye(3), np.array([-0.5, 0.0, 0.0])) @ left_T_world.inverse()
    return StereoRig.from_extrinsics(camera("left", 640.0), camera("right", 640.0), right_T_left)


@pytest.mark.parametrize("turned_deg", [-40, 0, 60, 100, 120])
def test_cameras_that_see_one_scene_may_be_turned_towards_each_other(turned_deg: float) -> None:
    """As on both sides of a cell."""
    assert turned_by(turned_deg).baseline_m == pytest.approx(0.5)


@pytest.mark.parametrize(
    ("turned_deg", "complaint"),
    [
        (-60, "see nothing in common, at any distance"),
        (-120, "see nothing in common"),
        (-170, "looks 170 deg away"),
        (160, "looks 160 deg away from where that looks: they cannot see one scene"),
    ],
)
def test_cameras_that_look_past_each_other_or_into_each_other_are_refused(turned_deg: float, complaint: str) -> None:
    with pytest.raises(CalibrationError, match=complaint):
        turned_by(turned_deg)


def test_cameras_whose_views_share_no_row_are_refused() -> None:
    nodding = Transform(rotation((0.8, 0.0, 0.0)), np.array([-0.1, 0.0, 0.0]))
    with pytest.raises(CalibrationError, match="the two cameras see nothing in common, at any distance"):
        StereoRig.from_extrinsics(camera("left"), camera("right"), nodding)


@pytest.mark.parametrize("factor", [0.5, 0.99, 1.001])
def test_projections_of_different_focal_lengths_are_refused_with_both(factor: float) -> None:
    rig = RIGS["parallel"]
    P = rig.right.P.copy()
    P[[0, 1], [0, 1]] *= factor
    with pytest.raises(CalibrationError, match=f"fx {rig.focal_px:.3f} and {factor * rig.focal_px:.3f}"):
        StereoRig.from_cameras(rig.left, replace(rig.right, P=P))


def test_a_left_projection_with_a_shift_is_refused() -> None:
    """As of the second of three cameras: the baseline would be that from the first one."""
    rig = RIGS["parallel"]
    P = rig.left.P.copy()
    P[0, 3] = -35.0
    with pytest.raises(CalibrationError, match=r"P\[0,3\] and P\[1,3\] of the left camera are -35 and 0, must be 0"):
        StereoRig.from_cameras(replace(rig.left, P=P), rig.right)


@pytest.mark.parametrize(("name", "row"), [("parallel", 1), ("verged", 1), ("vertical", 0)])
@pytest.mark.parametrize("off_px", [-2.0, 0.1])
def test_principal_points_in_different_rows_are_refused_with_both(name: str, row: int, off_px: float) -> None:
    rig = RIGS[name]
    across = np.diag([1.0, 1.0, 1.0]) if row else np.array([[0.0, -1, 0], [1, 0, 0], [0, 0, 1]])
    left_P, right_P = rig.left.P.copy(), rig.right.P.copy()
    if not row:  # as other programs have it: the view is not turned, and the shift is in y
        left_P[:2, 2], right_P[:2, 2] = left_P[[1, 0], 2], right_P[[1, 0], 2]
        right_P[:2, 3] = right_P[[1, 0], 3]
    left, right = (replace(each, R=across @ each.R, P=P) for each, P in ((rig.left, left_P), (rig.right, right_P)))
    if row:
        StereoRig.from_cameras(left, right)
    right_P[row, 2] += off_px
    with pytest.raises(CalibrationError, match=f"c{'xy'[row]} {left_P[row, 2]:.3f} and {right_P[row, 2]:.3f}"):
        StereoRig.from_cameras(left, replace(right, P=right_P))


@pytest.mark.parametrize(
    ("row", "column", "value", "complaint"),
    [
        (1, 1, 701.0, "different focal lengths"),
        (1, 2, 250.0, "do not share their rows"),
        (1, 3, 20.0, "do not share their rows"),
    ],
)
def test_projections_that_share_no_rows_are_refused(row: int, column: int, value: float, complaint: str) -> None:
    rig = RIGS["parallel"]
    P = rig.right.P.copy()
    P[row, column] = value
    with pytest.raises(CalibrationError, match=complaint):
        StereoRig(rig.left, replace(rig.right, P=P))
