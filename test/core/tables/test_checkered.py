"""Squares that meet at their corners, and nothing else with them, are those of a chessboard."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import cv2
import numpy as np
import pytest
from evaluate_surroundings import scored
from outlines import disc, seen

from stereo_pick.core.arrays import Floats
from stereo_pick.core.matches.similarity import Similarity
from stereo_pick.core.objects import Blob
from stereo_pick.core.tables.checkered import among_squares, told_from_boards

SIDE_PX = 24.0
CORNER = 3.0  # of a hundred, cut off by blur
SEEN_FROM: dict[str, Floats] = {
    "above": np.array([[1.0, 0.1, 40.0], [-0.1, 1.0, 60.0], [0.0, 0.0, 1.0]]),
    "aslant": np.array([[1.0, 0.2, 40.0], [0.1, 0.6, 60.0], [4e-4, 1.2e-3, 1.0]]),
}
Cell = tuple[float, float]


def box(cell: Cell, side: float = 1.0, view: Floats = SEEN_FROM["above"]) -> Blob:
    """The outline of a square in this column and row of a grid, its corners rounded a little."""
    ends = side * np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)])
    ahead = np.roll(ends, -1, axis=0)
    along = np.linspace(CORNER / 100, 1 - CORNER / 100, 20)[:, None]
    points = np.concatenate([start + along * (end - start) for start, end in zip(ends, ahead)]) + cell
    return Blob(cv2.perspectiveTransform(SIDE_PX * points[None], view)[0], 100.0)


def board(columns: int, rows: int) -> list[Cell]:
    return [(x, y) for y in range(rows) for x in range(columns) if (x + y) % 2 == 0]


def boxes(cells: Iterable[Cell], side: float = 1.0, view: Floats = SEEN_FROM["above"]) -> list[Blob]:
    return [box(cell, side, view) for cell in cells]


@pytest.mark.parametrize("side", [0.9, 1.0])
@pytest.mark.parametrize("view", SEEN_FROM.values(), ids=list(SEEN_FROM))
def test_all_squares_of_a_board_are_told(view: Floats, side: float) -> None:
    """Light makes them smaller, so that they do not quite meet."""
    squares = boxes(board(7, 5), side, view)
    assert among_squares(squares) == squares


def test_what_is_one_with_a_square_lies_among_them_and_what_is_beyond_does_not() -> None:
    _, *squares = boxes(board(7, 5))
    first = Blob(np.concatenate([box((0, 0)).contour_px, box((1, 1), 0.5).contour_px]), 100.0, fault="merged")
    part = box((10, 2))
    assert among_squares([first, *squares, part]) == [first, *squares]


@pytest.mark.parametrize("gap", [0.05, 0.15])
def test_boxes_that_are_packed_are_objects(gap: float) -> None:
    """On a pallet four meet at each corner."""
    assert among_squares(boxes([(x, y) for y in range(4) for x in range(5)], 1 - gap)) == []


@pytest.mark.parametrize(
    "parts",
    [
        boxes([(0, 0), (1, 1), (2, 0)]),
        boxes([(1.0 * x, 0) for x in range(6)], 0.95),
        boxes([(1.4 * x, 1.4 * y) for y in range(4) for x in range(4)]),
        [disc(100 + 40 * x + 20 * (y % 2), 100 + 35 * y) for y in range(4) for x in range(5)],
    ],
    ids=["three at their corners", "in a row", "apart", "discs"],
)
def test_nor_is_a_board_what_meets_otherwise(parts: Sequence[Blob]) -> None:
    assert among_squares(parts) == []


def test_each_square_is_refused_once_and_the_other_outlines_stay() -> None:
    """Also where one view shows the squares, as the other does not tell them from each other."""
    squares, part = boxes(board(7, 5)), box((10, 2))
    similarity = Similarity(1.5, 0.03, 1.5, (-20.0, 20.0))
    for right in (squares, []):
        rest, printed = told_from_boards(seen([*squares, part], [*right, part]), similarity)
        assert rest.left == rest.right == (part,)
        assert len(printed) == len(squares) and {each.reason for each in printed} == {"flat"}


def test_parts_among_the_squares_of_a_thick_board_are_found_where_they_are() -> None:
    """The squares passed for small prisms, and these made a table on which a rod was 10 mm off."""
    found = scored(None, ("thick_board", 37))
    assert found.missed == [] and found.wrong == 0
