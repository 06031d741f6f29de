"""Chessboard corners in images, found by several detectors none of which wins on every recording."""

from __future__ import annotations

from collections.abc import Callable

import cv2
import numpy as np

from stereo_pick.core.arrays import Floats, Image
from stereo_pick.core.calibration.boards import Chessboard
from stereo_pick.core.calibration.saddle_model import fitted_corners

Detector = Callable[[Image, Chessboard], Floats | None]

_MAX_HALF_WINDOW_PX = 7
SUB_PIXEL = (cv2.TERM_CRITERIA_COUNT + cv2.TERM_CRITERIA_EPS, 100, 1e-4)


def saddle_corners(picture: Image, board: Chessboard) -> Floats | None:
    """Corners (N, 2) [px] where the grey value's gradients around each cross (cornerSubPix); None without a board.

    picture: (H, W) uint8.
    """
    flags = cv2.CALIB_CB_ADAPTIVE_THRESH | cv2.CALIB_CB_NORMALIZE_IMAGE
    found, rough = cv2.findChessboardCorners(picture, (board.columns, board.rows), flags=flags)
    if not found:
        return None
    half = half_window_px(np.asarray(rough, np.float64).reshape(-1, 2), board)
    exact = cv2.cornerSubPix(picture, rough, (half, half), (-1, -1), SUB_PIXEL)
    return np.asarray(exact, np.float64).reshape(-1, 2)


def sector_corners(picture: Image, board: Chessboard) -> Floats | None:
    """Corners (N, 2) [px] by the sector-based detector (Duda and Frese 2018); None without a board.

    picture: (H, W) uint8.
    """
    flags = cv2.CALIB_CB_NORMALIZE_IMAGE | cv2.CALIB_CB_ACCURACY
    found, corners = cv2.findChessboardCornersSB(picture, (board.columns, board.rows), flags=flags)
    return np.asarray(corners, np.float64).reshape(-1, 2) if found else None


def modelled_corners(picture: Image, board: Chessboard) -> Floats | None:
    """Corners (N, 2) [px] where a model of two blurred edges that cross fits the picture; None without a board.

    picture: (H, W) uint8.
    """
    found = saddle_corners(picture, board)
    if found is None:
        return None
    return fitted_corners(picture, found.reshape(board.rows, board.columns, 2)).reshape(-1, 2)


DETECTORS: dict[str, Detector] = {
    "findChessboardCorners + cornerSubPix": saddle_corners,
    "findChessboardCornersSB": sector_corners,
    "findChessboardCorners + model of crossing edges": modelled_corners,
}
# What finds a board wherever any of them does.
SEEKING: tuple[Detector, ...] = (saddle_corners, sector_corners)


def half_window_px(corners_px: Floats, board: Chessboard) -> int:
    """Half the search window [px] of the sub-pixel step: below half the way to the nearest neighbour, 2 to 7.

    A window that holds a neighbouring corner mixes both: on Bouguet's recording half a window of
    11 px doubles the rms.
    """
    grid = corners_px.reshape(board.rows, board.columns, 2)
    spacing_px = min(float(np.linalg.norm(np.diff(grid, axis=axis), axis=2).min()) for axis in (0, 1))
    return int(np.clip(np.ceil(spacing_px / 2) - 1, 2, _MAX_HALF_WINDOW_PX))
