"""A chessboard that is larger than the one named is noticed; what lies around a board is not taken for squares."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import cv2
import numpy as np
import pytest

from stereo_pick.core.arrays import Floats, Image
from stereo_pick.core.calibration.board_size import goes_on
from stereo_pick.core.calibration.boards import Chessboard
from stereo_pick.core.calibration.detection import BoardImages, detect
from stereo_pick.core.errors import CalibrationError
from stereo_pick.core.transform import Transform

BOARD = Chessboard(7, 5, 0.03)
SIZE_PX = (320, 240)
K = np.array([[420.0, 0, 165], [0, 425, 118], [0, 0, 1]])
Render = Callable[..., Image]


def pose(seed: int) -> Transform:
    rng = np.random.default_rng(seed)
    R = cv2.Rodrigues(rng.uniform(-0.5, 0.5, 3))[0]
    return Transform(R, np.array([0.0, 0.0, 0.5]) - R @ BOARD.object_points().mean(axis=0))


def corners_px(camera_T_board: Transform, columns: slice, rows: slice) -> Floats:
    """Those of these columns and rows of the whole board's corners."""
    points = camera_T_board.apply(BOARD.object_points()) @ K.T
    grid = (points[:, :2] / points[:, 2:]).reshape(BOARD.rows, BOARD.columns, 2)
    return np.ascontiguousarray(grid[rows, columns].reshape(-1, 2))


@pytest.mark.parametrize("seed", range(6))
def test_a_part_of_a_board_goes_on(seed: int, render_board: Render) -> None:
    picture = render_board(BOARD, K, pose(seed), SIZE_PX)
    every = slice(None)
    for columns, rows in (
        (slice(1, None), every),
        (slice(None, -1), every),
        (slice(1, -1), every),
        (every, slice(1, None)),
        (every, slice(None, -1)),
        (slice(None, -1), slice(1, None)),
    ):
        part = corners_px(pose(seed), columns, rows)
        named = Chessboard(len(range(7)[columns]), len(range(5)[rows]), 0.03)
        assert goes_on(picture, part, named), (columns, rows)


@pytest.mark.parametrize("seed", range(6))
def test_a_whole_board_does_not_whatever_lies_around_it(seed: int, render_board: Render) -> None:
    board, corners = render_board(BOARD, K, pose(seed), SIZE_PX), corners_px(pose(seed), slice(None), slice(None))
    assert not goes_on(board, corners, BOARD)
    rim = cv2.dilate(
        cv2.fillConvexPoly(np.zeros_like(board), cv2.convexHull(corners.astype(np.int32)), 1), np.ones((71, 71))
    )
    for scene in range(20):
        rng = np.random.default_rng(scene)
        around = cv2.resize(rng.integers(0, 256, (12, 16), np.uint8), SIZE_PX, interpolation=cv2.INTER_NEAREST)
        assert not goes_on(np.where(rim > 0, board, around), corners, BOARD), scene


def test_too_few_squares_tell_nothing(render_board: Render) -> None:
    picture = render_board(BOARD, K, pose(0), SIZE_PX)
    few = corners_px(pose(0), slice(2, 5), slice(1, 4))
    assert not goes_on(picture, few, Chessboard(3, 3, 0.03))


def test_a_board_named_too_small_is_refused_with_an_image_that_shows_it(
    render_board: Render, monkeypatch: pytest.MonkeyPatch
) -> None:
    def pairs() -> Iterator[BoardImages]:
        for seed in range(3):
            picture = render_board(BOARD, K, pose(seed), SIZE_PX)
            yield BoardImages(f"pair{seed}", f"left{seed}.png", f"right{seed}.png", picture, picture)

    def first_columns(picture: Image, board: Chessboard) -> Floats:
        seed = next(s for s in range(3) if np.array_equal(picture, render_board(BOARD, K, pose(s), SIZE_PX)))
        return corners_px(pose(seed), slice(board.columns), slice(None))

    monkeypatch.setattr("stereo_pick.core.calibration.detectors.DETECTORS", {"taking a part": first_columns})
    with pytest.raises(CalibrationError, match="left0.png shows more than .* 6x5 .* in 6 of the 6 images"):
        detect(pairs(), Chessboard(6, 5, 0.03))
    assert len(detect(pairs(), BOARD)[0].views) == 3
