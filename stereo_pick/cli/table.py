"""`stereo-pick table`: where the table lies, by a calibration board on it."""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np
import yaml

from stereo_pick.cli.outputs import keep
from stereo_pick.cli.progress import progress
from stereo_pick.cli.recorded_pairs import timed_pairs
from stereo_pick.cli.replay import add_reading_options, add_recording_option, opened_source, read_files, source_rig
from stereo_pick.cli.warning import warn
from stereo_pick.core.calibration.any_board import Board, parse_board
from stereo_pick.core.calibration.collecting import first_view
from stereo_pick.core.calibration.detection import BoardImages
from stereo_pick.core.calibration.views import BoardView
from stereo_pick.core.drafts import drafted
from stereo_pick.core.errors import CalibrationError, ParameterError
from stereo_pick.core.frames import check_size
from stereo_pick.core.measured_table import MeasuredTable, table_under
from stereo_pick.core.rig import StereoRig
from stereo_pick.sources.fresh import FreshPairs

_DESCRIPTION = """\
Find where the table lies, from a bag or a folder of image pairs that show a calibration board lying flat on it, once or
in several places. What it prints is the value of the parameter feature.table: with it the table need not be found in
each picture, and more parts are. It holds for one calibration and one place of the cameras."""

_EPILOG = """\
example:
  stereo-pick table --source board_on_table --calibration my_rig --board 9x6 --square 0.029 --output table.yaml
  ros2 launch stereo_pick stereo_pick.launch.py calibration:=my_rig params_file:=table.yaml"""


def add_parser(subparsers: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the `table` subcommand."""
    parser = subparsers.add_parser(
        "table",
        help="find where the table lies, by a board on it",
        description=_DESCRIPTION,
        epilog=_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    add_recording_option(parser)
    add_reading_options(parser)
    parser.add_argument("--board", required=True, metavar="BOARD", help="the board: as at `calibrate`")
    parser.add_argument("--square", required=True, type=float, metavar="METRES", help="side of one square in metres")
    parser.add_argument(
        "--thickness",
        type=float,
        default=0.0,
        metavar="METRES",
        help="how far its squares are above the table (default: %(default)s, a sheet of paper)",
    )
    parser.add_argument("--output", type=Path, metavar="FILE", help="also write it as a node's parameter file (.yaml)")
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """Measure, print and write; raises StereoPickError on unusable input, after what was measured is printed."""
    source, board = opened_source(args), parse_board(args.board, args.square)
    if args.output is not None:
        keep(read_files(source, args), "--output", args.output, "part of the recording or of the calibration")
    rig = source_rig(source, args)
    pairs = FreshPairs(source)
    looks = [_look(pair, board, rig) for pair in progress(timed_pairs(pairs), source.count, "pairs")]
    warn(*pairs.warnings)
    views = [view for view in looks if view is not None]
    if not views:
        raise CalibrationError(
            f"{args.source}: no {board.title} found in both images of any of {len(looks)} pairs: {board.advice}"
        )
    try:
        measured = table_under(views, board, args.thickness, rig)
    except CalibrationError as error:
        raise CalibrationError(f"{args.source}: {error}") from None
    print(f"views     the board in {len(views)} of {len(looks)} pairs\n{report(measured, board)}")
    if args.output is not None:
        _write(args.output, measured)
        print(f"written   {args.output}")
    return 0


def report(measured: MeasuredTable, board: Board) -> str:
    """The result for people, one fact a line."""
    table, tilt_deg = measured.table, np.rad2deg(measured.tilt_rad)
    from_view_deg = np.rad2deg(np.arccos(-table.normal[2]))
    return "\n".join(
        [
            f"squares   {measured.square_m * 1000:.3f} mm as measured, {board.square_m * 1000:g} mm as given",
            f"flat      corners {measured.rms_m * 1000:.2f} mm rms from one plane",
            f"table     {table.offset_m * 1000:.1f} mm from the left camera, its normal {from_view_deg:.2f} deg "
            f"(+- {tilt_deg:.3f}) from the view",
            f'use       --param feature.table="{table.text}"',
        ]
    )


def _look(pair: BoardImages, board: Board, rig: StereoRig) -> BoardView | None:
    """The board as a pair shows it, or None; raises ImageError where that is not of the calibration's size."""
    check_size(pair.left_name, pair.left, rig.left.frame_size)
    check_size(pair.right_name, pair.right, rig.right.frame_size)
    return first_view(pair, board)


def _write(path: Path, measured: MeasuredTable) -> None:
    parameters = {"/**/correspondence": {"ros__parameters": {"feature": {"table": measured.table.text}}}}
    try:
        with drafted(path) as draft:
            draft.write_text(yaml.safe_dump(parameters), encoding="utf-8")
    except OSError as error:
        raise ParameterError(f"--output {path} cannot be written: {error.strerror}") from None
