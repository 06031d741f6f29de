"""`stereo-pick calibrate`: from chessboard images to calibration files."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path

from stereo_pick.cli.calibration_report import report
from stereo_pick.cli.image_pairs import FilePair, disagreement, find_files, pair_files
from stereo_pick.core.calibration.boards import Chessboard
from stereo_pick.core.calibration.detection import BoardImages, detect
from stereo_pick.core.calibration.files import save_rig
from stereo_pick.core.calibration.record import save_record
from stereo_pick.core.calibration.solving import calibrate_best
from stereo_pick.core.calibration.verdict import Word, check_baseline, judge
from stereo_pick.core.errors import CalibrationError
from stereo_pick.core.frames import grey
from stereo_pick.core.images import read_image

_DESCRIPTION = """\
Calibrate a stereo rig from pairs of images of a chessboard.

Left and right images are paired by order (left2 before left10), and each pair must be taken at the
same moment. 15 to 20 pairs are good: the whole board in both images, tilted to all sides by up to
45 degrees, near and far, and in all parts of the image. Pairs that do not fit the others (taken at
different moments, over-exposed, blurred) are left out and named."""

_EPILOG = """\
example:
  stereo-pick calibrate --left 'calib/left*.png' --right 'calib/right*.png' \\
      --board 9x6 --square 0.030 --output my_rig

  A board of 10 x 7 squares has 9x6 inner corners. Quote the patterns, or the shell expands them.
  DIR then holds left.yaml and right.yaml (camera_info), stereo.yaml (OpenCV, in metres), and
  calibration.yaml: all of it with uncertainties, the evidence and the verdict."""


def add_parser(subparsers: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the `calibrate` subcommand."""
    parser = subparsers.add_parser(
        "calibrate",
        help="calibrate a stereo rig from images of a chessboard",
        description=_DESCRIPTION,
        epilog=_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--left", required=True, metavar="GLOB", help="raw images of the left camera, a quoted pattern")
    parser.add_argument("--right", required=True, metavar="GLOB", help="raw images of the right camera")
    parser.add_argument(
        "--board", required=True, metavar="COLSxROWS", help="INNER corners, where four squares meet: 9x6"
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


def run(args: argparse.Namespace) -> int:
    """Calibrate, write the files and print the report.

    Raises StereoPickError, and writes nothing, where the images give no rig to be trusted.
    """
    board = Chessboard.parse(args.board, args.square)
    if args.output.exists() and not args.output.is_dir():
        raise CalibrationError(f"--output {args.output} is a file: name a folder")
    pairs = pair_files(find_files(args.left, "--left"), find_files(args.right, "--right"))
    result = calibrate_best(detect(_read(pairs), board), board)
    if args.baseline is not None:
        check_baseline(result, args.baseline)
    verdict = judge(result)
    if verdict.word is Word.REFUSED:
        raise CalibrationError(f"calibration {verdict}")
    try:
        written = [*save_rig(result.rig, args.output), save_record(result, args.output)]
    except OSError as error:
        raise CalibrationError(f"--output {args.output} cannot be written: {error.strerror}") from None
    notes = [disagreement(pairs), *result.warnings]
    print(report(result, verdict, [note for note in notes if note], written))
    return 0


def _read(pairs: Sequence[FilePair]) -> Iterator[BoardImages]:
    show = sys.stderr.isatty()
    try:
        for done, pair in enumerate(pairs):
            if show:
                print(f"\r{2 * done}/{2 * len(pairs)} images", end="", file=sys.stderr, flush=True)
            left, right = grey(read_image(pair.left)), grey(read_image(pair.right))
            yield BoardImages(pair.name, _short(pair.left), _short(pair.right), left, right)
    finally:
        if show:
            print("\r" + " " * 40 + "\r", end="", file=sys.stderr, flush=True)


def _short(path: Path) -> str:
    return f"{path.parent.name}/{path.name}"
