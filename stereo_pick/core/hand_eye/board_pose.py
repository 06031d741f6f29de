"""Where one camera sees a board, and which way round the board is."""

from __future__ import annotations

from collections.abc import Sequence

import cv2
import numpy as np

from stereo_pick.core.arrays import Image
from stereo_pick.core.calibration.any_board import Board
from stereo_pick.core.calibration.boards import Chessboard
from stereo_pick.core.calibration.detectors import SeenCorners, finders
from stereo_pick.core.calibration.parameters import transform
from stereo_pick.core.camera import Camera
from stereo_pick.core.errors import CalibrationError
from stereo_pick.core.hand_eye.pairs import Mount, RobotView, check
from stereo_pick.core.hand_eye.refinement import residual_norms
from stereo_pick.core.hand_eye.rotations import angle_rad
from stereo_pick.core.hand_eye.solving import closest_start
from stereo_pick.core.transform import Transform

MAX_RMS_PX = 2.0
_MAX_ROUNDS = 5


def camera_T_board(picture: Image, camera: Camera, board: Board) -> Transform:
    """The board's pose [m] in the camera's raw optical frame, up to the board's turns onto itself.

    picture: (H, W) uint8, raw. Raises CalibrationError where the image has another size than the calibration, or
    does not show enough of the board.
    """
    if picture.shape != (camera.height_px, camera.width_px):
        raise CalibrationError(
            f"the image is {picture.shape[1]} x {picture.shape[0]}, the {camera.name} camera was calibrated at "
            f"{camera.width_px} x {camera.height_px}"
        )
    corners = [found for find in finders(board).values() if (found := find(picture)) is not None]
    corners = [found for found in corners if isinstance(board, Chessboard) or board.spans_plane(found.seen)]
    if not corners:
        shown = "the whole board" if board.needs_all_corners else "at least 6 corners of the board, in two rows"
        raise CalibrationError(f"no {board} board found: show {shown}, lit evenly")
    rms_px, pose = min((_pose(each, camera, board) for each in corners), key=lambda each: each[0])
    if rms_px > MAX_RMS_PX:
        raise CalibrationError(f"the board's corners miss the calibrated camera's by {rms_px:.1f} px: another camera?")
    return pose


def settle_turns(views: Sequence[RobotView], board: Board, mount: Mount) -> list[RobotView]:
    """The views with the board the same way round in all: a detector may start at either end of it.

    Begins with the turns whose angles suit the robot's, and corrects them by the residuals until none changes.
    Raises CalibrationError where the robot's poses could determine nothing.
    """
    check(views)
    turns = [board.turned(order) for order in board.orders()]
    settled = [_by_angle(view, views[0], turns) for view in views]
    for _ in range(_MAX_ROUNDS):
        before = settled
        X, Y = closest_start(before, mount)
        settled = [min(_turned(view, turns), key=lambda each: _miss_rad(each, mount, X, Y)) for view in before]
        if all(a.camera_T_board is b.camera_T_board for a, b in zip(before, settled)):
            break
    return settled


def _pose(corners: SeenCorners, camera: Camera, board: Board) -> tuple[float, Transform]:
    points, rays = board.object_points()[corners.seen], camera.normalized(corners.px)
    _, rvec, tvec = cv2.solvePnP(points, rays, np.eye(3), None, flags=cv2.SOLVEPNP_IPPE)
    pose = transform(*cv2.solvePnPRefineLM(points, rays, np.eye(3), None, rvec, tvec))
    misses = camera.project(pose.apply(points)) - corners.px
    return float(np.sqrt((misses**2).sum(axis=1).mean())), pose


def _turned(view: RobotView, turns: Sequence[Transform]) -> list[RobotView]:
    """The view itself, and with its board turned onto itself; the first turn is none."""
    return [view, *(RobotView(view.name, view.base_T_flange, view.camera_T_board @ turn) for turn in turns[1:])]


def _by_angle(view: RobotView, first: RobotView, turns: Sequence[Transform]) -> RobotView:
    robot = angle_rad(first.base_T_flange.rotation.T @ view.base_T_flange.rotation)

    def gap(candidate: RobotView) -> float:
        turn = first.camera_T_board.rotation @ candidate.camera_T_board.rotation.T
        return abs(angle_rad(turn) - robot)

    return min(_turned(view, turns), key=gap)


def _miss_rad(view: RobotView, mount: Mount, X: Transform, Y: Transform) -> float:
    return float(residual_norms([view.stand_T_parent(mount)], [view.camera_T_board], X, Y)[0, 0])
