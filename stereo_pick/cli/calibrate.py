"""`stereo-pick calibrate`: from chessboard images to calibration files."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from stereo_pick.cli.calibration_report import report
from stereo_pick.cli.image_pairs import FilePair, disagreement, find_files, pair_files
from stereo_pick.cli.options import add_depth_option
from stereo_pick.cli.recorded_pairs import choose_pairs
from stereo_pick.core.calibration.any_board import Board, parse_board
from stereo_pick.core.calibration.detection import BoardImages
from stereo_pick.core.calibration.verdict import check_given_baseline
from stereo_pick.core.calibration_run import calibrate_from
from stereo_pick.core.errors import ParameterError
from stereo_pick.core.frames import grey
from stereo_pick.core.images import read_image
from stereo_pick.core.params import check_folder

_DESCRIPTION = """\
Calibrate a stereo rig from pairs of images of a chessboard or a ChArUco board: image files, or a bag
in which the board is moved about (hold it still now and then; sharp and different views are chosen).

Left and right files are paired by order (left2 before left10), and each pair must be taken at the
same moment. 15 to 20 pairs are good: the board in both images (a chessboard whole, a ChArUco board
at least in part), tilted to all sides by up to 45 degrees, near and far, and in all parts of the
image. Pairs that do not fit the others (taken at different moments, over-exposed, blurred) are left
out and named."""

_EPILOG = """\
examples:
  stereo-pick calibrate --left 'calib/left*.png' --right 'calib/right*.png' \\
      --board 9x6 --square 0.030 --output my_rig
  stereo-pick calibrate --bag calib.mcap --board charuco:11x8:0.75:5X5_100 --square 0.020 --output my_rig

  A board of 10 x 7 squares has 9x6 inner corners.
  DIR then holds left.yaml and right.yaml (camera_info), stereo.yaml (OpenCV, in metres), and
  calibration.yaml: all of it with uncertainties, the evidence and the verdict; and
  calibration_report.html, a page with tables and pictures, which is written for a refused calibration too."""


def add_parser(subparsers: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the `calibrate` subcommand."""
    parser = subparsers.add_parser(
        "calibrate",
        help="calibrate a stereo rig from images of a board",
        description=_DESCRIPTION,
        epilog=_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    _add_inputs(parser)
    parser.add_argument(
        "--board",
        required=True,
        metavar="BOARD",
        help="chessboard:9x6 (or 9x6): INNER corners, where four squares meet; charuco:11x8:0.75:5X5_100: SQUARES, "
        "the markers' side in squares (or 22mm), their dictionary",
    )
    parser.add_argument(
        "--square", required=True, type=float, metavar="METRES", help="side of one square in metres: 0.030 for 30 mm"
    )
    parser.add_argument(
        "--output", required=True, type=Path, metavar="DIR", help="folder for the result; files in it are replaced"
    )
    parser.add_argument(
        "--baseline",
        type=float,
        metavar="METRES",
        help="distance of the two lenses, measured on the rig with a ruler: contradicts a wrong --square",
    )
    parser.set_defaults(run=run)


def _add_inputs(parser: argparse.ArgumentParser) -> None:
    inputs = parser.add_mutually_exclusive_group(required=True)
    inputs.add_argument("--left", nargs="+", metavar="GLOB", help="raw images of the left camera: files or a pattern")
    inputs.add_argument("--bag", type=Path, metavar="PATH", help="instead: a bag with the raw images of both cameras")
    parser.add_argument("--right", nargs="+", metavar="GLOB", help="raw images of the right camera, with --left")
    for side in ("left", "right"):
        parser.add_argument(f"--{side}-topic", default="", metavar="TOPIC", help="with --bag, where names do not tell")
    add_depth_option(parser)


def run(args: argparse.Namespace) -> int:
    """Calibrate, write the files and print the report.

    Raises StereoPickError where the images give no rig to be trusted. Then no calibration is written,
    but the page that says why, if a board was found at all.
    """
    board = parse_board(args.board, args.square)
    if args.baseline is not None:
        check_given_baseline(args.baseline)
    check_folder(f"--output {args.output}", args.output)
    images, notes = _images(args, board)
    outcome = calibrate_from(images, board, args.baseline, notes)
    written = outcome.save(args.output)
    if outcome.result is not None:
        print(report(outcome.result, outcome.verdict, outcome.notes, written))
    return 0


def _images(args: argparse.Namespace, board: Board) -> tuple[Iterable[BoardImages], list[str]]:
    """The pairs to calibrate from, and what to warn of; raises StereoPickError where there are none."""
    if args.bag is None:
        if args.right is None or args.left_topic or args.right_topic:
            raise ParameterError("--left needs --right, and topics need --bag: give --left and --right, or --bag")
        pairs = pair_files(find_files(args.left, "--left"), find_files(args.right, "--right"))
        note = disagreement(pairs)
        return _Files(pairs, args.full_scale_16), [note] if note else []
    if args.right is not None:
        raise ParameterError("--right goes with --left, not with --bag: name topics by --left-topic and --right-topic")
    recorded = choose_pairs(args.bag, board, args.left_topic, args.right_topic, args.full_scale_16)
    print(f"{'bag':<10}{recorded.summary}")
    return recorded.images, []


@dataclass(frozen=True)
class _Files:
    """Image files, read anew at each iteration."""

    pairs: Sequence[FilePair]
    full_scale_16: int

    def __iter__(self) -> Iterator[BoardImages]:
        return _read(self.pairs, self.full_scale_16)


def _read(pairs: Sequence[FilePair], full_scale_16: int) -> Iterator[BoardImages]:
    show = sys.stderr.isatty()
    try:
        for done, pair in enumerate(pairs):
            if show:
                print(f"\r{2 * done}/{2 * len(pairs)} images", end="", file=sys.stderr, flush=True)
            left, right = (grey(read_image(file, full_scale_16)) for file in (pair.left, pair.right))
            yield BoardImages(pair.name, _short(pair.left), _short(pair.right), left, right)
    finally:
        if show:
            print("\r" + " " * 40 + "\r", end="", file=sys.stderr, flush=True)


def _short(path: Path) -> str:
    return str(Path(*path.parts[-2:]))
