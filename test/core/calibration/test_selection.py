"""Choosing views: sharp ones, unlike each other, no more than are needed."""

from __future__ import annotations

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from stereo_pick.core.calibration.boards import Chessboard
from stereo_pick.core.calibration.charuco import CharucoBoard
from stereo_pick.core.calibration.detection import BoardImages
from stereo_pick.core.calibration.selection import Candidate, Selection, moved_px, sharpness
from stereo_pick.core.calibration.views import BoardView
from stereo_pick.core.transform import Transform

BOARD = Chessboard(7, 5, 0.03)
CHARUCO = CharucoBoard(8, 6, 0.03, 0.75, "5X5_100")
IMAGES = BoardImages("pair", "left", "right", np.zeros((8, 1000), np.uint8), np.zeros((8, 1000), np.uint8))
GRID_PX = BOARD.object_points()[:, :2] * 1000
K = np.array([[420.0, 0, 165], [0, 425, 118], [0, 0, 1]])
camera_T_board = Transform(np.array([[0.8, 0, -0.6], [0, 1, 0], [0.6, 0, 0.8]]), np.array([-0.07, -0.06, 0.32]))


def candidate(index: int, x_px: float, y_px: float = 0.0, sharp: float = 0.4) -> Candidate:
    corners = GRID_PX + [x_px, y_px]
    return Candidate(index, IMAGES, BoardView(f"pair{index}", corners, corners), sharp)


def places(*candidates: Candidate, max_views: int = 40) -> list[int]:
    selection = Selection(BOARD, max_views)
    for each in candidates:
        selection.add(each)
    return [each.index for each in selection.chosen()]


def test_of_similar_views_the_sharpest_is_taken() -> None:
    assert places(candidate(0, 0, sharp=0.4), candidate(1, 5, sharp=0.5), candidate(2, 9, sharp=0.45)) == [1]
    assert places(candidate(0, 0), candidate(1, 11)) == [0, 1]


def test_a_board_that_is_moved_slowly_is_taken_again_and_again() -> None:
    taken = places(*(candidate(i, 3.0 * i, sharp=0.4 + 0.001 * i) for i in range(101)))
    assert len(taken) >= 300 / 20
    assert taken[0] <= 3
    assert taken[-1] == 100


def test_blurred_views_are_not_taken_however_different() -> None:
    sharp = [candidate(i, 50 * i) for i in range(4)]
    blurred = candidate(9, 400, sharp=0.2)
    assert places(*sharp, blurred) == places(sharp[0], blurred, *sharp[1:]) == [0, 1, 2, 3]
    assert places(blurred, *sharp) == [0, 1, 2, 3]


@given(st.lists(st.integers(0, 400), min_size=1, max_size=120), st.integers(2, 9))
def test_of_too_many_views_those_that_differ_are_taken(places_px: list[int], max_views: int) -> None:
    taken = places(*(candidate(i, float(x)) for i, x in enumerate(places_px)), max_views=max_views)
    assert 0 < len(taken) <= max_views
    assert taken == sorted(taken)
    # The best that max_views can do is to leave no gap wider than this; a stream costs a factor.
    best_px = max(10, np.ptp(places_px) / max_views)
    far_px = [min(abs(x - places_px[i]) for i in taken) for x in places_px]
    assert max(far_px) <= 4 * best_px


def test_nothing_comes_of_nothing() -> None:
    assert places() == []


def test_a_board_listed_from_the_other_end_has_not_moved() -> None:
    view = BoardView("a", GRID_PX, GRID_PX)
    assert moved_px(view, BoardView("b", GRID_PX[::-1], GRID_PX), BOARD) == 0
    assert moved_px(view, BoardView("b", GRID_PX + [3, 4], GRID_PX), BOARD) == pytest.approx(5)


def test_views_in_part_are_compared_by_what_both_show() -> None:
    def part(seen: range, shift_px: float) -> BoardView:
        corners = GRID_PX[list(seen)] + shift_px
        return BoardView("part", corners, corners, np.array(seen), np.array(seen))

    assert moved_px(part(range(20), 0), part(range(10, 35), 3), CHARUCO) == pytest.approx(3 * 2**0.5)
    assert moved_px(part(range(10), 0), part(range(20, 35), 0), CHARUCO) == np.inf


def test_sharpness_falls_with_blur_and_not_with_light(render_board) -> None:
    picture = render_board(BOARD, K, camera_T_board, (320, 240))
    points = camera_T_board.apply(BOARD.object_points()) @ K.T
    corners = points[:, :2] / points[:, 2:]
    blurred = [sharpness(cv2.GaussianBlur(picture, (0, 0), sigma), corners) for sigma in (0.5, 1, 2, 3)]
    assert blurred == sorted(blurred, reverse=True)
    assert blurred[0] > 2 * blurred[3]
    assert sharpness(picture // 3 + 20, corners) == pytest.approx(sharpness(picture, corners), rel=0.05)
