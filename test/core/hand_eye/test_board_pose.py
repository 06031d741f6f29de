"""Board poses for hand-eye: from an image, and the same way round in every view."""

from __future__ import annotations

from collections.abc import Callable

import cv2
import numpy as np
import pytest

from stereo_pick.core.arrays import Image
from stereo_pick.core.calibration.boards import Chessboard
from stereo_pick.core.calibration.charuco import CharucoBoard
from stereo_pick.core.camera import Camera
from stereo_pick.core.errors import CalibrationError
from stereo_pick.core.hand_eye.board_pose import camera_T_board, settle_turns
from stereo_pick.core.hand_eye.pairs import Mount, RobotView
from stereo_pick.core.hand_eye.rotations import angle_rad, rotation_matrix
from stereo_pick.core.hand_eye.solving import solve_hand_eye
from stereo_pick.core.transform import Transform

K = np.array([[420.0, 0, 165], [0, 425, 118], [0, 0, 1]])
CAMERA = Camera("left", 320, 240, K, np.zeros(5), np.eye(3), np.c_[K, np.zeros(3)])
TRUTH = Transform(rotation_matrix(np.array([2.1, 0.3, -0.4])), np.array([0.8, 0.1, 0.9]))
flange_T_board = Transform(rotation_matrix(np.array([0.1, 0.2, -0.3])), np.array([0.02, 0.03, 0.1]))


def board_views(rng: np.random.Generator, count: int) -> list[Transform]:
    return [
        Transform(rotation_matrix(rng.uniform(-0.5, 0.5, 3)), rng.uniform(-0.05, 0.05, 3) + [0, 0, 0.6])
        for _ in range(count)
    ]


def _angle_rad(pose: Transform) -> float:
    return angle_rad(pose.rotation)


def test_a_rendered_board_is_found_where_it_is(render_board: Callable[..., Image]) -> None:
    board = Chessboard(7, 5, 0.03)
    truth = Transform(cv2.Rodrigues(np.array([0.3, -0.2, 0.1]))[0], np.array([-0.1, -0.05, 0.5]))
    found = camera_T_board(render_board(board, K, truth, (320, 240)), CAMERA, board)
    nearest = min(
        (found @ board.turned(order) for order in board.orders()),
        key=lambda T: angle_rad(T.rotation.T @ truth.rotation),
    )
    assert np.degrees(angle_rad(nearest.rotation.T @ truth.rotation)) < 0.2
    np.testing.assert_allclose(nearest.translation, truth.translation, atol=1e-3)


@pytest.mark.skipif(not hasattr(cv2, "aruco"), reason="this OpenCV has no aruco module")
@pytest.mark.parametrize(("legacy", "angle"), [(False, 0.1), (True, 0.1), (False, 3.0)])
def test_a_charuco_board_is_found_where_it_is_from_a_part_of_it(
    legacy: bool, angle: float, render_charuco: Callable[..., Image]
) -> None:
    board = CharucoBoard(8, 6, 0.03, 0.75, "5X5_100")
    R = cv2.Rodrigues(np.array([0.3, -0.2, 0]))[0] @ cv2.Rodrigues(np.array([0, 0, angle]))[0]
    centre = np.array([0.09, 0.01, 0.45])
    truth = Transform(R, centre - R @ board.object_points().mean(axis=0))
    right_most_px = CAMERA.project(truth.apply(board.object_points()))[:, 0].max()
    assert right_most_px > 320, "a part of the board is outside the image"
    found = camera_T_board(render_charuco(board, K, truth, (320, 240), legacy), CAMERA, board)
    assert np.degrees(angle_rad(found.rotation.T @ truth.rotation)) < 0.5
    np.testing.assert_allclose(found.translation, truth.translation, atol=1.5e-3)


@pytest.mark.skipif(not hasattr(cv2, "aruco"), reason="this OpenCV has no aruco module")
def test_too_little_of_a_charuco_board_is_refused(render_charuco: Callable[..., Image]) -> None:
    board = CharucoBoard(8, 6, 0.03, 0.75, "5X5_100")
    beside = Transform(np.eye(3), np.array([0.13, -0.05, 0.45]))
    with pytest.raises(CalibrationError, match="show at least 6 corners of the board, in two rows"):
        camera_T_board(render_charuco(board, K, beside, (320, 240)), CAMERA, board)


def test_an_image_without_the_board_or_of_another_size_is_refused() -> None:
    board = Chessboard(7, 5, 0.03)
    with pytest.raises(CalibrationError, match="no 7x5 board found"):
        camera_T_board(np.full((240, 320), 90, np.uint8), CAMERA, board)
    with pytest.raises(CalibrationError, match="the image is 160 x 120, the left camera was calibrated at 320 x 240"):
        camera_T_board(np.zeros((120, 160), np.uint8), CAMERA, board)


@pytest.mark.parametrize("board", [Chessboard(7, 5, 0.03), Chessboard(5, 5, 0.03)])
@pytest.mark.parametrize("mount", Mount)
def test_boards_seen_the_other_way_up_are_turned_back(board: Chessboard, mount: Mount) -> None:
    for seed in range(8):
        rng = np.random.default_rng(seed)
        turns = [board.turned(order) for order in board.orders()]
        views = []
        for i, truth in enumerate(board_views(rng, 12)):
            stand_T_parent = flange_T_board @ truth.inverse() @ TRUTH.inverse()
            A = stand_T_parent if mount is Mount.EYE_IN_HAND else stand_T_parent.inverse()
            noise = Transform(rotation_matrix(rng.normal(0, 2e-3, 3)), rng.normal(0, 3e-4, 3))
            views.append(RobotView(f"view{i}", A, truth @ noise @ turns[rng.integers(len(turns))]))
        result = solve_hand_eye(settle_turns(views, board, mount), mount)
        assert result.rms_mm < 1.5 and (result.rms_deg or 0) < 0.4, seed
        np.testing.assert_allclose(
            result.found.transform.translation, TRUTH.translation, atol=5 * result.found.sigma_mm.max() / 1000
        )


def test_poses_that_determine_nothing_are_refused_before_boards_are_turned() -> None:
    views = [RobotView("view", Transform.identity(), pose) for pose in board_views(np.random.default_rng(0), 5)]
    with pytest.raises(CalibrationError, match="the robot's poses differ by 0.00 deg"):
        settle_turns(views, Chessboard(7, 5, 0.03), Mount.EYE_TO_HAND)
