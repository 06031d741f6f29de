"""`stereo-pick background`: learn the empty work surface from a recording."""

from __future__ import annotations

import argparse
from pathlib import Path

from stereo_pick.cli.outputs import keep
from stereo_pick.cli.progress import progress
from stereo_pick.cli.replay import add_reading_options, add_recording_option, opened_source, read_files, source_rig
from stereo_pick.cli.warning import warn
from stereo_pick.core.frames import StereoFrame
from stereo_pick.core.learned_parts import parts_learned
from stereo_pick.core.objects.background_files import save_background
from stereo_pick.core.objects.learned import BackgroundLearner
from stereo_pick.core.rectification import Rectifier
from stereo_pick.sources.fresh import FreshPairs

_DESCRIPTION = """\
Learn what the empty work surface looks like, from a bag or a folder of image pairs that show it with nothing on it.
With it, planks, prints, and the edge of the table are no objects any more. It belongs to one calibration and one place
of the cameras; a change of the light is allowed for. On live cameras, call the correspondence node's service
~/learn_background instead."""

_EPILOG = """\
example:
  stereo-pick background --source empty_table --calibration my_rig --output my_rig/background.npz
  stereo-pick run --source my_bag --calibration my_rig --param segmentation.background_file=my_rig/background.npz"""


def add_parser(subparsers: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the `background` subcommand."""
    parser = subparsers.add_parser(
        "background",
        help="learn the empty work surface",
        description=_DESCRIPTION,
        epilog=_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    add_recording_option(parser)
    add_reading_options(parser)
    parser.add_argument("--output", type=Path, required=True, metavar="FILE", help="the .npz file to write")
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """Learn and save; raises StereoPickError on unusable input."""
    source = opened_source(args)
    keep(read_files(source, args), "--output", args.output, "part of the recording or of the calibration")
    rectifier, learner = Rectifier(source_rig(source, args)), BackgroundLearner()
    pairs = FreshPairs(source)
    for pair in progress(pairs, source.count, "pairs"):
        learner.add(rectifier.rectify(StereoFrame(*pair.images(), pair.stamp_ns)))
    warn(*pairs.warnings)
    background = learner.finished()
    save_background(args.output, background)
    warn(parts_learned(learner.mean_pair()))
    print(f"{args.output}: learned from {background.pairs} pairs, for calibration {background.calibration_hash}")
    return 0
