"""`stereo-pick locate`: the objects in one pair of image files; needs no ROS."""

from __future__ import annotations

import argparse
import json
from pathlib import Path

import cv2

from stereo_pick.cli.options import add_depth_option, add_pipeline_options, pipeline_values
from stereo_pick.cli.outputs import keep
from stereo_pick.cli.positioning import add_positioning_options, positioning_of
from stereo_pick.cli.report import result_mapping, result_text
from stereo_pick.core.annotation import annotate
from stereo_pick.core.calibration.files import load_rig
from stereo_pick.core.configuration import steps
from stereo_pick.core.drafts import drafted
from stereo_pick.core.errors import ImageError
from stereo_pick.core.frames import StereoFrame
from stereo_pick.core.images import read_image
from stereo_pick.core.pipeline import Pipeline, Result
from stereo_pick.core.refusal import REASONS, RIG_FAULTS

_DESCRIPTION = """\
Find the objects in one pair of images and print where they are.

Positions are metres (millimetres in the table) in the left camera's own optical frame: x right, y down, z forward,
of the RAW left camera, not of the rectified one; or, with --hand-eye, in the robot's frame. Each comes with a
covariance, with the confidence that it is within triangulation.tolerance_m, with the gap between its two rays, and with
its pixels in the raw images. What was seen but cannot be trusted is listed under `refused`, with the reason."""

_EPILOG = """\
examples:
  stereo-pick locate left.png right.png --calibration my_rig
  stereo-pick locate left.png right.png --calibration my_rig --json
  stereo-pick locate left.png right.png --calibration my_rig --param segmentation.polarity=dark --picture seen.png"""


def add_parser(subparsers: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the `locate` subcommand."""
    parser = subparsers.add_parser(
        "locate",
        help="find the objects in one pair of image files",
        description=_DESCRIPTION,
        epilog=_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("left", type=Path, metavar="LEFT", help="raw image of the left camera")
    parser.add_argument("right", type=Path, metavar="RIGHT", help="raw image of the right camera")
    parser.add_argument(
        "--calibration",
        type=Path,
        required=True,
        metavar="DIR",
        help="folder with left.yaml and right.yaml, or an OpenCV stereo YAML file",
    )
    add_depth_option(parser)
    add_positioning_options(parser)
    add_pipeline_options(parser)
    parser.add_argument("--json", action="store_true", help="print JSON instead of a table")
    parser.add_argument("--picture", type=Path, metavar="FILE", help="also write an annotated picture (.png, .jpg)")
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """Locate and print; raises StereoPickError on unusable input, ImageError on exchanged images."""
    if args.picture is not None:
        keep((args.left, args.right), "--picture", args.picture, "one of the two images")
    values = pipeline_values(args)
    rig = load_rig(args.calibration)
    pipeline = Pipeline(rig, steps(values), positioning_of(args, rig))
    left, right = (read_image(file, args.full_scale_16) for file in (args.left, args.right))
    result = pipeline.run(StereoFrame(left, right))
    print(json.dumps(result_mapping(result, str(values["method"])), indent=2) if args.json else result_text(result))
    if args.picture is not None:
        write_picture(args.picture, result)
    fault = rig_fault_of(result)
    if fault:
        remedy = "; give the left image first" if fault == "swapped" else " Calibrate again"
        raise ImageError(f"{args.left} and {args.right}: {REASONS[fault]}{remedy}")
    return 0


def rig_fault_of(result: Result) -> str:
    """The reason why nothing of this pair is believed, or nothing."""
    return next((refusal.reason for refusal in result.poses.refused if refusal.reason in RIG_FAULTS), "")


def write_picture(path: Path, result: Result) -> None:
    """Write the annotated picture of a result; raises ImageError where that is not possible."""
    picture = annotate(result.pair, result.blobs, result.correspondences, result.poses)
    try:
        encoded, data = cv2.imencode(path.suffix, picture)
    except cv2.error:
        encoded = False
    if not encoded:
        raise ImageError(f"{path} cannot be written: give a .png or .jpg file")
    try:
        with drafted(path) as draft:
            draft.write_bytes(data.tobytes())
    except OSError as error:
        remedy = "; give a file in a folder that exists" if isinstance(error, FileNotFoundError) else ""
        raise ImageError(f"{path} cannot be written: {error.strerror}{remedy}") from None
