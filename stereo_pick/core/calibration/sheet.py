"""A board laid out on a sheet of paper, in true size."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass

import numpy as np

from stereo_pick.core.arrays import Floats, floats
from stereo_pick.core.calibration.any_board import Board
from stereo_pick.core.calibration.pattern import black_rectangles, size_squares
from stereo_pick.core.errors import ParameterError

PAGES_MM = {"a4": (210.0, 297.0), "a3": (297.0, 420.0), "letter": (215.9, 279.4)}
RULER_MM = 100.0
MARGIN_MM = 10.0
TEXT_MM = 3.0
_FOOT_MM = 15.0  # white, two lines and the ruler
_LINE_MM = 0.25
_PAGE = re.compile(r"(\d+(?:\.\d+)?)\s*[x×]\s*(\d+(?:\.\d+)?)\s*_?\s*mm", re.IGNORECASE)


@dataclass(frozen=True)
class Text:
    """A line of text: its left end on the base line [mm] from the page's upper left corner."""

    x_mm: float
    y_mm: float
    text: str


@dataclass(frozen=True)
class Sheet:
    """A page: black rectangles (N, 4) x, y, width, height [mm] from its upper left corner, and lines of text.

    Raises ArrayError on rectangles of another shape.
    """

    width_mm: float
    height_mm: float
    rectangles_mm: Floats
    texts: tuple[Text, ...]

    def __post_init__(self) -> None:
        object.__setattr__(self, "rectangles_mm", floats("rectangles_mm", self.rectangles_mm, None, 4))


def parse_page(text: str) -> tuple[float, float]:
    """Width and height [mm] of a page: a4, a3, letter or like 500x400_mm; raises ParameterError on any other text."""
    name = text.strip().lower()
    if name in PAGES_MM:
        return PAGES_MM[name]
    match = _PAGE.fullmatch(name)
    if match is None:
        raise ParameterError(
            f"page {text!r} is not understood: write {', '.join(PAGES_MM)}, or its size like 500x400_mm"
        )
    return float(match[1]), float(match[2])


def lay_out(board: Board, page_mm: tuple[float, float]) -> Sheet:
    """Lay the board in the middle of a page, upright or on its side, over its name and a ruler.

    Raises ParameterError, naming both sizes, where it does not fit; CalibrationError where this
    OpenCV cannot draw the board.
    """
    columns, rows = size_squares(board)
    square_mm = board.square_m * 1000
    width_mm, height_mm = columns * square_mm, rows * square_mm
    page_width_mm, page_height_mm = _turned_to_fit(board, page_mm)
    x_mm = (page_width_mm - width_mm) / 2
    y_mm = (page_height_mm - height_mm - _FOOT_MM) / 2
    black_mm = black_rectangles(board) * square_mm + [x_mm, y_mm, 0, 0]
    foot_x_mm, foot_y_mm = min(x_mm, (page_width_mm - RULER_MM) / 2), y_mm + height_mm + _FOOT_MM
    texts = (
        Text(foot_x_mm, foot_y_mm - 8.5, f"--board {_name(board)} --square {board.square_m:g}"),
        Text(foot_x_mm, foot_y_mm - 4, f"print at 100 %: squares of {square_mm:g} mm, this line {RULER_MM:g} mm"),
    )
    ruler_mm = _ruler(foot_x_mm, foot_y_mm)
    return Sheet(page_width_mm, page_height_mm, np.concatenate([black_mm, ruler_mm]), texts)


def _turned_to_fit(board: Board, page_mm: tuple[float, float]) -> tuple[float, float]:
    """The page's width and height [mm], exchanged where only that lets the board fit."""
    for page in (page_mm, page_mm[::-1]):
        if board.square_m * 1000 <= _largest_square_mm(board, page):
            return page
    columns, rows = size_squares(board)
    square_mm = board.square_m * 1000
    largest_mm = max(_largest_square_mm(board, page) for page in (page_mm, page_mm[::-1]))
    smaller = f"squares of {largest_mm:.4g} mm would fit; " if largest_mm > 1 else ""
    raise ParameterError(
        f"the board is {columns * square_mm:g} x {rows * square_mm:g} mm and needs a page of "
        f"{max(columns * square_mm, RULER_MM) + 2 * MARGIN_MM:g} x {rows * square_mm + _FOOT_MM + 2 * MARGIN_MM:g} mm "
        f"with its margin and ruler, but the page is {page_mm[0]:g} x {page_mm[1]:g} mm: {smaller}"
        "take fewer or smaller squares, or a larger page"
    )


def _largest_square_mm(board: Board, page_mm: tuple[float, float]) -> float:
    """Side [mm], to a tenth, of the largest squares with which the board fits a page; 0 where none fit."""
    columns, rows = size_squares(board)
    width_mm, height_mm = page_mm[0] - 2 * MARGIN_MM, page_mm[1] - 2 * MARGIN_MM - _FOOT_MM
    if width_mm < RULER_MM or height_mm <= 0:
        return 0.0
    return math.floor(min(width_mm / columns, height_mm / rows) * 10 + 1e-6) / 10


def _ruler(x_mm: float, y_mm: float) -> Floats:
    """A line of 100 mm between two ticks: their outer edges are 100 mm apart."""
    tick_mm = 3.0
    ends = [(x, y_mm - tick_mm, _LINE_MM, tick_mm) for x in (x_mm, x_mm + RULER_MM - _LINE_MM)]
    return np.array([(x_mm, y_mm - (tick_mm + _LINE_MM) / 2, RULER_MM, _LINE_MM), *ends])


def _name(board: Board) -> str:
    return str(board) if ":" in str(board) else f"chessboard:{board}"
