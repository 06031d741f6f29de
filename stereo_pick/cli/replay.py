"""`stereo-pick replay`: a whole recording offline, to JSON lines or to a new bag with the poses in it."""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import TextIO

from stereo_pick.cli.locate import rig_fault_of
from stereo_pick.cli.options import add_depth_option, add_pipeline_options, pipeline_values
from stereo_pick.cli.outputs import keep
from stereo_pick.cli.positioning import add_positioning_options, positioning_of
from stereo_pick.cli.progress import progress
from stereo_pick.cli.report import result_mapping
from stereo_pick.cli.warning import warn
from stereo_pick.core.calibration.files import load_rig, rig_files
from stereo_pick.core.configuration import steps
from stereo_pick.core.errors import CalibrationError, ImageError, ParameterError, SourceError
from stereo_pick.core.frames import StereoFrame
from stereo_pick.core.pipeline import Pipeline, Result
from stereo_pick.core.refusal import REASONS
from stereo_pick.core.rig import StereoRig
from stereo_pick.sources.fresh import FreshPairs
from stereo_pick.sources.images import ImageFolder
from stereo_pick.sources.opening import open_source
from stereo_pick.sources.source import SourcePair, StereoSource, without_partner

_DESCRIPTION = """\
Replay a whole recording offline, as fast as this machine can.

The output is one JSON object a pair and line (as `stereo-pick locate --json` prints it), or, where FILE ends in .mcap,
a new bag: everything of the old one and the topic object_poses (geometry_msgs/PoseArray)."""

_EPILOG = """\
examples:
  stereo-pick replay my_bag --output poses.jsonl
  stereo-pick replay my_bag --calibration my_rig --method ssd | head
  stereo-pick replay my_bag --output my_bag_with_poses.mcap"""


def add_parser(subparsers: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the `replay` subcommand."""
    parser = subparsers.add_parser(
        "replay",
        help="replay a whole recording offline",
        description=_DESCRIPTION,
        epilog=_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("source", type=Path, metavar="BAG", help="a bag, or a folder of image pairs")
    add_source_options(parser)
    add_pipeline_options(parser)
    parser.add_argument("--output", type=Path, metavar="FILE", help="a .jsonl file (default: standard output) or .mcap")
    parser.set_defaults(run=run)


def add_source_options(parser: argparse.ArgumentParser) -> None:
    """Add what says how a recording is to be read, and what its positions mean."""
    add_reading_options(parser)
    add_positioning_options(parser)


def add_recording_option(parser: argparse.ArgumentParser) -> None:
    """Add --source, for commands that need something else first."""
    parser.add_argument(
        "--source", type=Path, required=True, metavar="BAG_OR_FOLDER", help="a bag, or a folder of image pairs"
    )


def add_reading_options(parser: argparse.ArgumentParser) -> None:
    """Add what says how a recording is to be read."""
    parser.add_argument(
        "--calibration",
        type=Path,
        metavar="DIR",
        help="folder with left.yaml and right.yaml, or an OpenCV YAML file (default: the bag's camera_info)",
    )
    parser.add_argument(
        "--left-topic", default="", metavar="TOPIC", help="the bag's left images (default: by its name)"
    )
    parser.add_argument("--right-topic", default="", metavar="TOPIC", help="the bag's right images")
    add_depth_option(parser)
    parser.add_argument(
        "--max-stamp-offset",
        type=float,
        default=0.01,
        metavar="SECONDS",
        help="by how much the stamps of a pair may differ (max_stamp_offset_s; default: %(default)s)",
    )


def run(args: argparse.Namespace) -> int:
    """Replay; raises StereoPickError on unusable input, after what came before it was written."""
    source, values = opened_source(args), pipeline_values(args)
    if args.output is not None:
        keep(source.paths, "--output", args.output, "part of the recording")
        _check_kind(args.output, source)
    rig, method = source_rig(source, args), str(values["method"])
    pipeline = Pipeline(rig, steps(values), positioning_of(args, rig))
    results = progress(_results(pipeline, source), source.count, "pairs")
    if args.output is not None and args.output.suffix == ".mcap":
        from stereo_pick.cli.pose_bag import write_pose_bag

        write_pose_bag(args.source, args.output, results)
        return 0
    if args.output is None:
        _write_lines(sys.stdout, results, method)
        return 0
    try:
        with args.output.open("w", encoding="utf-8") as lines:
            _write_lines(lines, results, method)
    except OSError as error:
        raise SourceError(f"--output {args.output} cannot be written: {error.strerror}") from None
    return 0


def _check_kind(output: Path, source: StereoSource) -> None:
    """Raise ParameterError for a file of another kind than can be written."""
    if output.suffix not in (".jsonl", ".mcap"):
        raise ParameterError(
            f"--output {output} must end in .jsonl (a JSON object a pair) or .mcap (a bag with the poses in it)"
        )
    if output.suffix == ".mcap" and isinstance(source, ImageFolder):
        raise ParameterError(f"--output {output}: a folder of images cannot become a bag of poses: give a .jsonl file")


def opened_source(args: argparse.Namespace) -> StereoSource:
    """The recording that the options name; raises SourceError or ParameterError."""
    return open_source(
        args.source,
        left_topic=args.left_topic,
        right_topic=args.right_topic,
        max_stamp_offset_s=args.max_stamp_offset,
        uses_camera_info=args.calibration is None,
        full_scale_16=args.full_scale_16,
    )


def source_rig(source: StereoSource, args: argparse.Namespace) -> StereoRig:
    """The rig of --calibration, else that of the recording; raises SourceError where neither is given."""
    if args.calibration is not None:
        return load_rig(args.calibration)
    if source.cameras is None:
        raise SourceError(f"{args.source} holds no camera_info of both cameras: give --calibration DIR")
    try:
        return StereoRig.from_cameras(*source.cameras)
    except CalibrationError as error:
        raise CalibrationError(f"{args.source}: camera_info: {error}; or give --calibration DIR") from None


def read_files(source: StereoSource, args: argparse.Namespace) -> list[Path]:
    """What is read: the recording's files, or its folder, and those of --calibration."""
    return [*source.paths, *(rig_files(args.calibration) if args.calibration is not None else ())]


def _write_lines(lines: TextIO, results: Iterable[tuple[SourcePair, Result]], method: str) -> None:
    for _, result in results:
        print(json.dumps(result_mapping(result, method)), file=lines)


def _results(pipeline: Pipeline, source: StereoSource) -> Iterator[tuple[SourcePair, Result]]:
    """Yield each pair with its result, but those of a camera that hangs.

    Raises ImageError at the end where no pair fits the calibration.
    """
    pairs, located, faults, notice = FreshPairs(source), 0, [], ""
    for pair in pairs:
        pipeline.positioning.check(pipeline.rig, pair.left_frame_id)
        result = pipeline.run(StereoFrame(*pair.images(), pair.stamp_ns))
        located += len(result.poses)
        faults += [fault] if (fault := rig_fault_of(result)) else []
        notice = result.correspondences.notice or notice
        yield pair, result
    warn(notice, without_partner(source, pairs.read), *pairs.warnings)
    if faults and not located:
        remedy = (
            "; exchange --left-topic and --right-topic, or the files" if "swapped" in faults else " Calibrate again"
        )
        raise ImageError(f"{REASONS[faults[0]]} ({len(faults)} pairs){remedy}")
