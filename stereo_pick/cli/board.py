"""`stereo-pick board`: a calibration board to print, in true size."""

from __future__ import annotations

import argparse
from pathlib import Path

from stereo_pick.core.calibration.any_board import Board, parse_board
from stereo_pick.core.calibration.boards import Chessboard
from stereo_pick.core.calibration.sheet import lay_out, parse_page
from stereo_pick.core.calibration.sheet_files import pdf, svg
from stereo_pick.core.errors import ParameterError

_WRITERS = {".svg": svg, ".pdf": pdf}

_DESCRIPTION = """\
Write a calibration board to print: an SVG or a PDF in true size, with a line of 100 mm to check the print by.

Print at 100 % ("actual size"), measure the line, glue the sheet onto something flat and rigid, and measure the
squares: what `stereo-pick calibrate --square` is told is the scale of every later result."""

_EPILOG = """\
examples:
  stereo-pick board --board chessboard:9x6 --square 0.025 --output board.pdf
  stereo-pick board --board charuco:11x8:0.75:5X5_100 --square 0.030 --page a3 --output board.svg

  A chessboard is named by its inner corners, a ChArUco board by its squares."""


def add_parser(subparsers: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the `board` subcommand."""
    parser = subparsers.add_parser(
        "board",
        help="write a calibration board to print",
        description=_DESCRIPTION,
        epilog=_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument(
        "--board", required=True, metavar="BOARD", help="chessboard:9x6 or charuco:11x8:0.75:5X5_100, as for calibrate"
    )
    parser.add_argument("--square", required=True, type=float, metavar="METRES", help="side of one square in metres")
    parser.add_argument(
        "--page", default="a4", metavar="PAGE", help="a4, a3, letter or like 500x400_mm (default: %(default)s)"
    )
    parser.add_argument("--output", required=True, type=Path, metavar="FILE", help=".svg or .pdf; it is replaced")
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """Write the file; raises StereoPickError, and writes nothing, where that is not possible."""
    board = parse_board(args.board, args.square)
    write = _WRITERS.get(args.output.suffix.lower())
    if write is None:
        raise ParameterError(f"--output {args.output} is neither .svg nor .pdf: name the file by its kind")
    sheet = lay_out(board, parse_page(args.page))
    try:
        args.output.write_bytes(write(sheet))
    except OSError as error:
        raise ParameterError(f"--output {args.output} cannot be written: {error.strerror}") from None
    print(f"{args.output}: {board.title}, squares of {board.square_m * 1000:g} mm, on a page of ", end="")
    print(f"{sheet.width_mm:g} x {sheet.height_mm:g} mm; print at 100 % and measure the line of 100 mm")
    print(hint(board), end="")
    return 0


def hint(board: Board) -> str:
    """What to know of a chessboard that looks the same turned by half; empty for others."""
    if not isinstance(board, Chessboard) or (board.columns + board.rows) % 2:
        return ""
    return (
        f"hint: {board} inner corners look the same turned by half; an even and an odd number, like "
        f"{board.columns + 1}x{board.rows}, or a ChArUco board, shows which way up it is\n"
    )
