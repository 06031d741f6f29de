"""OpenCV's aruco module: in contrib up to 4.6, in OpenCV itself, with other names, from 4.7 on."""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import cv2
import numpy as np

from stereo_pick.core.arrays import Bools, Floats, Image, Ints
from stereo_pick.core.calibration.charuco import CharucoBoard
from stereo_pick.core.calibration.corners import SUB_PIXEL
from stereo_pick.core.errors import CalibrationError

_ARUCO: Any = getattr(cv2, "aruco", None)
_NEW = hasattr(_ARUCO, "CharucoDetector")
_MAX_HALF_WINDOW_PX = 7

LEGACY = hasattr(getattr(_ARUCO, "CharucoBoard", None), "setLegacyPattern")
"""Whether this OpenCV finds boards printed by OpenCV before 4.6: with an even number of rows their first square is
white."""


def charuco_corners(picture: Image, board: CharucoBoard, legacy: bool = False) -> tuple[Floats, Ints]:
    """The corners (N, 2) [px] that are seen of the board in an image (H, W) uint8, and which they are (N,).

    legacy: look for the pattern of OpenCV before 4.6. Raises CalibrationError without an aruco module.
    """
    corners, ids = _new(picture, board, legacy) if _NEW else _old(picture, board)
    if ids is None or corners is None:
        return np.empty((0, 2)), np.empty(0, np.int64)
    seen = np.asarray(ids, np.int64).ravel()
    return _refined(picture, board, np.asarray(corners, np.float32).reshape(-1, 1, 2), seen), seen


def _refined(picture: Image, board: CharucoBoard, rough: Any, seen: Ints) -> Floats:
    """The corners (N, 2) [px] where the grey value's gradients cross; OpenCV 4.6 gives them half a pixel off."""
    half = half_window_px(np.asarray(rough, np.float64).reshape(-1, 2), board, seen)
    exact = cv2.cornerSubPix(picture, rough, (half, half), (-1, -1), SUB_PIXEL)
    return np.asarray(exact, np.float64).reshape(-1, 2)


def half_window_px(corners_px: Floats, board: CharucoBoard, seen: Ints) -> int:
    """Half the search window [px] of the sub-pixel step, 2 to 7: it ends before the nearest marker."""
    grid = np.full((board.corner_count, 2), np.nan)
    grid[seen] = corners_px
    cells = grid.reshape(board.rows - 1, board.columns - 1, 2)
    steps_px = np.concatenate([np.linalg.norm(np.diff(cells, axis=axis), axis=2).ravel() for axis in (0, 1)])
    spacing_px = np.min(steps_px, where=np.isfinite(steps_px), initial=np.inf)
    return int(np.clip(np.floor(spacing_px * (1 - board.marker_ratio) / 2), 2, _MAX_HALF_WINDOW_PX))


def _new(picture: Image, board: CharucoBoard, legacy: bool) -> tuple[Any, Any]:
    corners, ids, _, _ = _detector(board, legacy).detectBoard(picture)
    return corners, ids


@lru_cache(8)
def _detector(board: CharucoBoard, legacy: bool) -> Any:
    sides_m = board.square_m, board.square_m * board.marker_ratio
    pattern = _ARUCO.CharucoBoard((board.columns, board.rows), *sides_m, _dictionary(board))
    if legacy:
        pattern.setLegacyPattern(True)
    return _ARUCO.CharucoDetector(pattern)


def _old(picture: Image, board: CharucoBoard) -> tuple[Any, Any]:
    dictionary = _dictionary(board)
    markers, marker_ids, _ = _ARUCO.detectMarkers(picture, dictionary)
    if marker_ids is None:
        return None, None
    sides_m = board.square_m, board.square_m * board.marker_ratio
    pattern = _ARUCO.CharucoBoard_create(board.columns, board.rows, *sides_m, dictionary)
    _, corners, ids = _ARUCO.interpolateCornersCharuco(markers, marker_ids, picture, pattern)
    return corners, ids


def _dictionary(board: CharucoBoard) -> Any:
    """OpenCV's dictionary; raises CalibrationError without an aruco module."""
    if _ARUCO is None:
        raise CalibrationError(
            f"OpenCV {cv2.__version__} is built without its aruco module, which finds ChArUco boards: "
            "install opencv-python-headless 4.7 or later, or use a chessboard"
        )
    return _ARUCO.getPredefinedDictionary(getattr(_ARUCO, f"DICT_{board.dictionary}"))


def marker_is_black(board: CharucoBoard, marker_id: int) -> Bools:
    """Which cells (n, n) of a marker are black, its border of one cell included.

    Raises CalibrationError without an aruco module.
    """
    dictionary = _dictionary(board)
    draw = _ARUCO.generateImageMarker if _NEW else _ARUCO.drawMarker
    return np.asarray(draw(dictionary, marker_id, dictionary.markerSize + 2) == 0)
