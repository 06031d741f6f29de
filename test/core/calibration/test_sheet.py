"""Printable boards: true size in SVG and PDF, and what is drawn is what the detectors find."""

from __future__ import annotations

import re
from xml.etree import ElementTree

import cv2
import numpy as np
import pytest

from stereo_pick.core.arrays import Floats, Image
from stereo_pick.core.calibration.any_board import Board, parse_board
from stereo_pick.core.calibration.boards import Chessboard
from stereo_pick.core.calibration.charuco import CharucoBoard
from stereo_pick.core.calibration.detectors import finders
from stereo_pick.core.calibration.pattern import size_squares
from stereo_pick.core.calibration.sheet import PAGES_MM, Sheet, lay_out, parse_page
from stereo_pick.core.calibration.sheet_files import pdf, svg
from stereo_pick.core.errors import ParameterError

MM_PER_POINT = 25.4 / 72
NAMESPACE = "{http://www.w3.org/2000/svg}"
BOARDS = [Chessboard(9, 6, 0.025), Chessboard(5, 8, 0.02), CharucoBoard(11, 8, 0.02, 0.75, "5X5_100")]


def of_svg(document: bytes) -> tuple[tuple[float, float], Floats]:
    """Page size and black rectangles [mm] of an SVG."""
    root = ElementTree.fromstring(document)
    size = [float(root.get(side, "").removesuffix("mm")) for side in ("width", "height")]
    assert root.get("viewBox") == "0 0 {:.10g} {:.10g}".format(*size)
    black = root.find(f"{NAMESPACE}g")
    assert black is not None
    rectangles = [[float(r.get(k, "")) for k in ("x", "y", "width", "height")] for r in black]
    return (size[0], size[1]), np.array(rectangles)


def of_pdf(document: bytes) -> tuple[tuple[float, float], Floats]:
    """Page size and black rectangles [mm], y down, of a PDF, whose objects are found by its own table."""
    table = int(re.search(rb"startxref\n(\d+)\n%%EOF\n$", document)[1])
    starts = [int(line[:10]) for line in document[table:].splitlines()[3:8]]
    for number, start in enumerate(starts, start=1):
        assert document[start:].startswith(b"%d 0 obj" % number)
    width, height = (float(n) * MM_PER_POINT for n in re.search(rb"MediaBox \[0 0 (\S+) (\S+)\]", document).groups())
    length, stream = re.search(rb"/Length (\d+) >>\nstream\n(.*)\nendstream", document, re.DOTALL).groups()
    assert int(length) == len(stream)
    scale = float(stream.split()[0]) * MM_PER_POINT
    rectangles = np.array([line.split()[:4] for line in stream.splitlines() if line.endswith(b" re")], float) * scale
    rectangles[:, 1] = height - rectangles[:, 1] - rectangles[:, 3]
    return (width, height), rectangles


def rasterised(size_mm: tuple[float, float], rectangles_mm: Floats, px_per_mm: int = 4) -> Image:
    """The page as an image, each pixel black where a rectangle covers its centre."""
    picture = np.full([round(n * px_per_mm) for n in size_mm[::-1]], 255, np.uint8)
    edges = np.ceil(np.c_[rectangles_mm[:, :2], rectangles_mm[:, :2] + rectangles_mm[:, 2:]] * px_per_mm - 0.5)
    for left, top, right, bottom in edges.astype(int):
        picture[top:bottom, left:right] = 0
    return picture


@pytest.mark.parametrize("board", BOARDS, ids=str)
@pytest.mark.parametrize(("write", "read"), [(svg, of_svg), (pdf, of_pdf)], ids=["svg", "pdf"])
def test_squares_and_ruler_have_their_true_size(board: Board, write, read) -> None:
    size_mm, rectangles = read(write(lay_out(board, PAGES_MM["a4"])))
    assert sorted(size_mm) == pytest.approx(sorted(PAGES_MM["a4"]), abs=1e-3)
    square_mm, (columns, rows) = board.square_m * 1000, size_squares(board)
    squares = rectangles[np.isclose(rectangles[:, 2:], square_mm, atol=1e-3).all(axis=1)]
    assert len(squares) == (columns * rows + 1) // 2
    steps = (squares[:, :2] - squares[0, :2]) / square_mm
    np.testing.assert_allclose(steps, np.round(steps), atol=1e-3)
    assert (np.round(steps).sum(axis=1) % 2 == 0).all()
    assert np.ptp(rectangles[-3:, 0]) + rectangles[-1, 2] == pytest.approx(100, abs=1e-3)
    assert rectangles[-3, 2] == pytest.approx(100, abs=1e-3)


@pytest.mark.parametrize("board", BOARDS, ids=str)
def test_a_white_margin_surrounds_everything(board: Board) -> None:
    sheet = lay_out(board, PAGES_MM["a4"])
    ends = sheet.rectangles_mm[:, :2] + sheet.rectangles_mm[:, 2:]
    assert sheet.rectangles_mm[:, :2].min() > 10 - 1e-6
    assert (ends.max(axis=0) <= np.array([sheet.width_mm, sheet.height_mm]) - 10 + 1e-6).all()
    bottom_mm = (sheet.rectangles_mm[:-3, 1] + sheet.rectangles_mm[:-3, 3]).max()
    assert min(text.y_mm for text in sheet.texts) - 3 - bottom_mm > 3


@pytest.mark.parametrize("board", BOARDS, ids=str)
@pytest.mark.parametrize(("write", "read"), [(svg, of_svg), (pdf, of_pdf)], ids=["svg", "pdf"])
def test_the_detectors_find_what_is_printed(board: Board, write, read) -> None:
    if isinstance(board, CharucoBoard) and not hasattr(cv2, "aruco"):
        pytest.skip("this OpenCV has no aruco module")
    sheet = lay_out(board, PAGES_MM["a4"])
    picture = cv2.GaussianBlur(rasterised(*read(write(sheet))), (0, 0), 0.8)
    name, find = next(iter(finders(board).items()))
    found = find(picture)
    assert found is not None, name
    assert len(found.seen) == board.corner_count
    first = sheet.rectangles_mm[0, :2] + board.square_m * 1000  # the origin of the board frame
    truth_px = (first + board.object_points()[:, :2] * 1000) * 4 - 0.5
    errors = [np.abs(found.px[order] - truth_px).max() for order in board.orders()]
    assert min(errors) < 0.3


def test_the_caption_is_what_calibrate_takes() -> None:
    for board in BOARDS:
        sheet = lay_out(board, PAGES_MM["a4"])
        match = re.fullmatch(r"--board (\S+) --square (\S+)", sheet.texts[0].text)
        assert match is not None
        assert parse_board(match[1], float(match[2])) == board
        assert "print at 100 %" in sheet.texts[1].text
        assert b"print at 100 %" in svg(sheet) and b"print at 100 %" in pdf(sheet)


@pytest.mark.parametrize(("page", "width_mm"), [("a3", 297), ("A4", 210), ("letter", 215.9), ("500x400.5_mm", 500)])
def test_page_is_read_from_text(page: str, width_mm: float) -> None:
    assert parse_page(page)[0] == width_mm


@pytest.mark.parametrize("page", ["", "a5", "500x400", "500_mm"])
def test_text_that_is_no_page_is_refused(page: str) -> None:
    with pytest.raises(ParameterError, match="a4, a3, letter"):
        parse_page(page)


def test_a_board_that_does_not_fit_names_both_sizes_and_what_would() -> None:
    with pytest.raises(ParameterError, match=r"300 x 210 mm .* 320 x 245 mm .* page is 210 x 297 mm") as caught:
        lay_out(Chessboard(9, 6, 0.03), PAGES_MM["a4"])
    largest_mm = float(re.search(r"squares of (\S+) mm would fit", str(caught.value))[1])
    assert isinstance(lay_out(Chessboard(9, 6, largest_mm / 1000), PAGES_MM["a4"]), Sheet)
    with pytest.raises(ParameterError):
        lay_out(Chessboard(9, 6, (largest_mm + 0.1) / 1000), PAGES_MM["a4"])


def test_a_page_too_small_for_the_ruler_is_refused() -> None:
    with pytest.raises(ParameterError, match="page of 120 x"):
        lay_out(Chessboard(4, 3, 0.005), (100, 80))
