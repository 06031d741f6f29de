"""Stereo calibration: exact geometry is recovered, bad pairs are named, and what is no rig is refused."""

from __future__ import annotations

import json
from itertools import pairwise
from pathlib import Path

import cv2
import numpy as np
import pytest
from simulated_views import BOARD, RIG, SIZE_PX, make_views, rotation

from stereo_pick.core.calibration.boards import Chessboard
from stereo_pick.core.calibration.result import CalibrationResult
from stereo_pick.core.calibration.solving import calibrate
from stereo_pick.core.calibration.views import BoardView
from stereo_pick.core.errors import CalibrationError
from stereo_pick.core.rig import StereoRig

TOOLBOX = "findChessboardCorners + cornerSubPix"  # the toolbox's own method


def replaced(views: list[BoardView], index: int, left_px: np.ndarray, right_px: np.ndarray) -> list[BoardView]:
    return [BoardView(v.name, left_px, right_px) if i == index else v for i, v in enumerate(views)]


def assert_is_rig(result: CalibrationResult, rig: StereoRig, px: float, m: float) -> None:
    for found, true in ((result.rig.left, rig.left), (result.rig.right, rig.right)):
        np.testing.assert_allclose(found.K, true.K, atol=px)
    np.testing.assert_allclose(result.rig.right_T_left.translation, rig.right_T_left.translation, atol=m)
    np.testing.assert_allclose(result.rig.right_T_left.rotation, rig.right_T_left.rotation, atol=px / 800)


def test_exact_corners_give_the_exact_rig() -> None:
    result = calibrate(make_views(), SIZE_PX, BOARD)
    assert_is_rig(result, RIG, px=0.01, m=1e-6)
    np.testing.assert_allclose(result.rig.left.D, RIG.left.D, atol=1e-4)
    assert result.rms_px < 1e-3
    assert len(result.used) == 12
    assert result.rejected == ()
    assert result.warnings == ()
    assert result.rotation_deg == pytest.approx(np.degrees(np.linalg.norm([0.02, 0.2, -0.03])), abs=1e-3)


def test_ends_no_higher_than_opencv() -> None:
    views = make_views(noise_px=0.05)
    points = [BOARD.object_points().astype(np.float32)] * len(views)
    left, right = ([getattr(v, side).astype(np.float32) for v in views] for side in ("left_px", "right_px"))
    guesses = [
        a for side in (left, right) for a in cv2.calibrateCamera(points, side, SIZE_PX, None, None, flags=128)[1:3]
    ]
    flags = cv2.CALIB_USE_INTRINSIC_GUESS | cv2.CALIB_FIX_K3
    opencv_rms_px = cv2.stereoCalibrate(points, left, right, *guesses, SIZE_PX, flags=flags)[0]
    assert calibrate(views, SIZE_PX, BOARD).rms_px <= opencv_rms_px + 1e-6


def test_baseline_scatters_as_much_as_its_standard_deviation_says() -> None:
    results = [calibrate(make_views(8, noise_px=0.2, seed=seed), SIZE_PX, BOARD) for seed in range(20)]
    errors_m = np.array([result.rig.baseline_m - RIG.baseline_m for result in results])
    normalised = errors_m / [result.baseline_sigma_m for result in results]
    assert 0.6 < np.sqrt(np.mean(normalised**2)) < 1.5


@pytest.mark.parametrize("noise_px", [0.0, 0.3])
def test_a_board_listed_from_either_end_is_the_same_board(noise_px: float) -> None:
    views = make_views(noise_px=noise_px)
    rng = np.random.default_rng(1)
    turned = [BoardView(v.name, v.left_px[:: rng.choice([-1, 1])], v.right_px[:: rng.choice([-1, 1])]) for v in views]
    expected, result = (calibrate(each, SIZE_PX, BOARD) for each in (views, turned))
    assert len(result.used) == len(views)
    assert_is_rig(result, expected.rig, px=0.01, m=1e-6)


def test_square_board_may_be_listed_from_any_corner() -> None:
    board = Chessboard(6, 6, 0.025)
    views = []
    rng = np.random.default_rng(0)
    for i in range(8):
        points = board.object_points() @ rotation(*rng.uniform(-0.5, 0.5, 3)).T + [-0.06, -0.06, 0.5 + 0.02 * i]
        left_px, right_px = RIG.project(points)
        views.append(BoardView(str(i), left_px, right_px[board.orders()[i % 4]]))
    assert_is_rig(calibrate(views, SIZE_PX, board), RIG, px=0.01, m=1e-6)


@pytest.mark.parametrize("shift_px", [(2.0, 1.5), (40.0, 10.0)])
def test_pair_of_two_moments_is_rejected_by_name(shift_px: tuple[float, float]) -> None:
    views = make_views(noise_px=0.1)
    result = calibrate(replaced(views, 4, views[4].left_px, views[4].right_px + shift_px), SIZE_PX, BOARD)
    assert [view.name for view in result.rejected] == ["pair4"]
    assert "not taken at the same moment" in result.rejected[0].reason
    assert "px" in result.rejected[0].reason
    assert_is_rig(result, RIG, px=5, m=5e-4)


def test_a_third_of_the_pairs_may_be_shuffled() -> None:
    views = make_views(noise_px=0.1)
    shuffled = [BoardView(views[i].name, views[i].left_px, views[(i + 1) % 4].right_px) for i in range(4)]
    result = calibrate(shuffled + views[4:], SIZE_PX, BOARD)
    assert {view.name for view in result.rejected} == {"pair0", "pair1", "pair2", "pair3"}
    assert_is_rig(result, RIG, px=5, m=5e-4)


def test_imprecise_corners_are_rejected_by_name() -> None:
    views = make_views(noise_px=0.1)
    blurred = views[7].left_px + np.random.default_rng(5).normal(0, 1.5, (48, 2))
    result = calibrate(replaced(views, 7, blurred, views[7].right_px), SIZE_PX, BOARD)
    assert [view.name for view in result.rejected] == ["pair7"]
    assert "left image" in result.rejected[0].reason
    assert_is_rig(result, RIG, px=5, m=5e-4)


@pytest.mark.parametrize("noise_px", [0.0, 0.3])
def test_both_images_from_one_camera_are_refused(noise_px: float) -> None:
    rng = np.random.default_rng(2)
    views = [
        BoardView(v.name, v.left_px, v.left_px + rng.normal(0, 1, v.left_px.shape) * noise_px)
        for v in make_views(noise_px=noise_px)
    ]
    with pytest.raises(CalibrationError, match=r"baseline = \d.* mm .*both cameras see from the same place"):
        calibrate(views, SIZE_PX, BOARD)


def test_swapped_cameras_are_refused() -> None:
    views = [BoardView(v.name, v.right_px, v.left_px) for v in make_views()]
    with pytest.raises(CalibrationError, match="swapped"):
        calibrate(views, SIZE_PX, BOARD)


def test_pairs_off_by_one_are_refused() -> None:
    views = make_views(noise_px=0.1)
    shifted = [BoardView(a.name, a.left_px, b.right_px) for a, b in pairwise(views)]
    with pytest.raises(CalibrationError, match="do not agree on where the cameras stand.*paired correctly"):
        calibrate(shifted, SIZE_PX, BOARD)


def test_views_all_alike_are_refused() -> None:
    rng = np.random.default_rng(3)
    view = make_views(1)[0]
    views = [
        BoardView(str(i), view.left_px + rng.normal(0, 0.2, (48, 2)), view.right_px + rng.normal(0, 0.2, (48, 2)))
        for i in range(8)
    ]
    with pytest.raises(CalibrationError, match="tilt"):
        calibrate(views, SIZE_PX, BOARD)


@pytest.mark.parametrize("count", [0, 1, 2])
def test_too_few_views_are_refused(count: int) -> None:
    with pytest.raises(CalibrationError, match=f"^{count} usable pairs .* at least 3 are needed"):
        calibrate(make_views(count), SIZE_PX, BOARD)


def test_few_views_are_warned_of() -> None:
    result = calibrate(make_views(5, noise_px=0.05), SIZE_PX, BOARD)
    assert "only 5 views: take 8 or more" in result.warnings[0]


def test_corners_of_another_board_are_refused() -> None:
    with pytest.raises(CalibrationError, match="pair0: 48 corners in the left image, but a 9x6 board has 54"):
        calibrate(make_views(), SIZE_PX, Chessboard(9, 6, 0.025))


def test_bouguet_gives_what_the_toolbox_published(calibrated, shared_data: Path) -> None:
    result = calibrated("bouguet_stereo/left*.jpg", "bouguet_stereo/right*.jpg", Chessboard(9, 6, 0.03), TOOLBOX)
    published = json.loads((shared_data / "bouguet_stereo/published.json").read_text())["after_stereo_optimisation"]
    assert len(result.used) == 14
    assert result.rms_px == pytest.approx(0.204, abs=0.001)
    for side, camera in (("left", result.rig.left), ("right", result.rig.right)):
        np.testing.assert_allclose(camera.K[[0, 1], [0, 1]], published[f"fc_{side}"], atol=0.005)
        np.testing.assert_allclose(camera.K[:2, 2], published[f"cc_{side}"], atol=0.005)
        np.testing.assert_allclose(camera.D, published[f"kc_{side}"], atol=5e-5)
    om = cv2.Rodrigues(np.array(result.rig.right_T_left.rotation))[0].ravel()
    np.testing.assert_allclose(om, published["om"], atol=2e-5)
    np.testing.assert_allclose(result.rig.right_T_left.translation * 1000, published["T_mm"], atol=0.002)
    assert 3000 * result.baseline_sigma_m == pytest.approx(published["T_mm_pm"][0], rel=0.05)


def test_flipped_boards_of_a_students_rig_are_all_used(calibrated) -> None:
    result = calibrated("vigir2023_puma/calib/left*", "vigir2023_puma/calib/right*", Chessboard(8, 6, 0.025))
    assert len(result.used) == 11
    assert result.held_out.epipolar_rms_px < 0.35
    students_mm, bounds_mm = np.array([-259.404, 0.208, 39.225]), np.array([3.137, 1.247, 13.506])
    assert (np.abs(result.rig.right_T_left.translation * 1000 - students_mm) <= bounds_mm).all()


def test_webcam_rig_held_by_hand(calibrated) -> None:
    result = calibrated("sourishg/set1/left*", "sourishg/set1/right*", Chessboard(9, 6, 0.02423))
    assert len(result.used) == 29
    assert result.rig.baseline_m * 1000 == pytest.approx(93.9, abs=0.1)


def test_the_same_views_give_the_same_bits() -> None:
    views = make_views(12, noise_px=0.1)
    first, *others = (calibrate(views, SIZE_PX, BOARD).solution.parameters for _ in range(4))
    for parameters in others:
        np.testing.assert_array_equal(parameters, first)
