"""Chessboards, and finding their corners."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from stereo_pick.core.calibration.boards import Chessboard
from stereo_pick.core.calibration.corners import DETECTORS, half_window_px
from stereo_pick.core.calibration.detection import BoardImages, detect
from stereo_pick.core.calibration.detectors import may_show
from stereo_pick.core.errors import CalibrationError, ParameterError, StereoPickError
from stereo_pick.core.transform import Transform

BOARD = Chessboard(7, 5, 0.03)
K = np.array([[420.0, 0, 165], [0, 425, 118], [0, 0, 1]])
camera_T_board = Transform(np.array([[0.8, 0, -0.6], [0, 1, 0], [0.6, 0, 0.8]]), np.array([-0.07, -0.06, 0.32]))
GREY = np.full((240, 320), 128, np.uint8)


@pytest.mark.parametrize("text", ["9x6", "chessboard:9x6", "9X6", " 9 x 6 ", "9×6", "Chessboard: 9*6"])
def test_board_is_read_from_text(text: str) -> None:
    assert Chessboard.parse(text, 0.03) == Chessboard(9, 6, 0.03)


@pytest.mark.parametrize("text", ["", "9", "9x", "9x6x3", "nine by six", "circles:9x6", "9.5x6", "-9x6"])
def test_text_that_is_no_board_is_refused(text: str) -> None:
    with pytest.raises(ParameterError, match="9x6"):
        Chessboard.parse(text, 0.03)


@pytest.mark.parametrize(
    ("columns", "rows", "square_m", "message"),
    [
        (2, 6, 0.03, "at least 3x3"),
        (9, 0, 0.03, "at least 3x3"),
        (9, 6, 0.0, "positive"),
        (9, 6, float("nan"), "positive"),
        (9, 6, 24.23, r"millimetres: give metres, 0\.02423"),
    ],
)
def test_impossible_board_is_refused(columns: int, rows: int, square_m: float, message: str) -> None:
    with pytest.raises(ParameterError, match=message):
        Chessboard(columns, rows, square_m)


def test_object_points_go_row_by_row_in_metres() -> None:
    points = BOARD.object_points()
    assert points.shape == (35, 3)
    np.testing.assert_allclose(points[[0, 1, 7, 34]], [[0, 0, 0], [0.03, 0, 0], [0, 0.03, 0], [0.18, 0.12, 0]])


@given(st.integers(3, 12), st.integers(3, 12))
def test_turning_the_board_reorders_its_corners(columns: int, rows: int) -> None:
    board = Chessboard(columns, rows, 0.025)
    orders = board.orders()
    assert len(orders) == (4 if columns == rows else 2)
    np.testing.assert_array_equal(orders[0], np.arange(columns * rows))
    for order in orders:
        np.testing.assert_allclose(
            board.turned(order).apply(board.object_points()), board.object_points()[order], atol=1e-12
        )


@given(st.floats(1, 100), st.floats(0, 6.3))
def test_sub_pixel_window_does_not_reach_a_neighbouring_corner(spacing_px: float, angle: float) -> None:
    turn = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
    half = half_window_px(BOARD.object_points()[:, :2] / BOARD.square_m * spacing_px @ turn, BOARD)
    assert 2 <= half <= 7
    assert half == 2 or 2 * half < spacing_px


@pytest.mark.parametrize("detector", DETECTORS.values(), ids=DETECTORS)
def test_corners_are_found_where_they_are(detector, render_board) -> None:
    truth = BOARD.object_points() @ camera_T_board.rotation.T + camera_T_board.translation
    truth_px = (truth / truth[:, 2:] @ K.T)[:, :2]
    found = detector(render_board(BOARD, K, camera_T_board, (320, 240)), BOARD)
    assert found is not None
    assert min(np.linalg.norm(found[order] - truth_px, axis=1).max() for order in BOARD.orders()) < 0.5


@pytest.mark.parametrize("detector", DETECTORS.values(), ids=DETECTORS)
def test_no_board_is_none(detector) -> None:
    assert detector(GREY, BOARD) is None


def test_recording_without_a_board_names_files_and_board() -> None:
    pairs = [BoardImages(f"pair{i}", f"left{i}.png", f"right{i}.png", GREY, GREY) for i in range(5)]
    with pytest.raises(CalibrationError, match=r"7x5 inner corners .*left0\.png, right0\.png, .* and 4 more"):
        detect(pairs, BOARD)


def test_pair_with_a_board_in_one_image_only_is_named(render_board) -> None:
    picture = render_board(BOARD, K, camera_T_board, (320, 240))
    pairs = [
        BoardImages("both", "left0.png", "right0.png", picture, picture),
        BoardImages("one", "left1.png", "right1.png", picture, GREY),
    ]
    for found in detect(pairs, BOARD):
        assert [view.name for view in found.views] == ["both"]
        assert [(view.name, view.reason) for view in found.rejected] == [("one", "no 7x5 board found in right1.png")]


def test_images_of_different_size_are_refused() -> None:
    pairs = [BoardImages("pair", "left.png", "right.png", GREY, GREY[:200])]
    with pytest.raises(CalibrationError, match=r"right\.png is 320 x 200, but left\.png is 320 x 240"):
        detect(pairs, BOARD)


def test_no_pairs_are_refused() -> None:
    with pytest.raises(StereoPickError, match="no image pairs"):
        detect([], BOARD)


@pytest.mark.parametrize("square_px", [20, 60, 100])
def test_large_images_are_looked_at_in_small(square_px: int) -> None:
    picture = np.full((960, 1280), 210, np.uint8)
    assert not may_show(picture, BOARD)
    squares = np.indices((BOARD.rows + 1, BOARD.columns + 1)).sum(axis=0) % 2 * 170 + 40
    board = np.kron(squares, np.ones((square_px, square_px)))
    picture[150 : 150 + board.shape[0], 131 : 131 + board.shape[1]] = board
    assert may_show(picture, BOARD)


def test_small_images_are_looked_at_as_they_are() -> None:
    assert may_show(GREY, BOARD)
