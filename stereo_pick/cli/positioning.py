"""Options for what is known of a rig beyond its camera_info: its uncertainty, and its place in the robot's frame."""

from __future__ import annotations

import argparse
from pathlib import Path

from stereo_pick.cli.warning import warn
from stereo_pick.core.calibration.record import FILE_NAME, CalibrationRecord, record_of
from stereo_pick.core.errors import CalibrationError
from stereo_pick.core.hand_eye.files import load_hand_eye
from stereo_pick.core.positioning import Positioning
from stereo_pick.core.rig import StereoRig

FILE_PARAMETERS = ("calibration_file", "hand_eye_file")


def add_positioning_options(parser: argparse.ArgumentParser) -> None:
    """Add --calibration-file and --hand-eye."""
    parser.add_argument(
        "--calibration-file",
        type=Path,
        metavar="FILE",
        help="calibration.yaml, whose uncertainty goes into the covariance (default: that of --calibration DIR)",
    )
    parser.add_argument(
        "--hand-eye", type=Path, metavar="FILE", help="file of `stereo-pick hand-eye`: poses in the robot's frame"
    )


def positioning_of(args: argparse.Namespace, rig: StereoRig) -> Positioning:
    """What the options name; raises CalibrationError where it is of another calibration.

    A calibration.yaml that only happens to stand in the calibration's folder is left out then, with a warning.
    """
    hand_eye = load_hand_eye(args.hand_eye) if args.hand_eye is not None else None
    positioning = Positioning(_record(args, rig), hand_eye)
    positioning.check(rig)
    return positioning


def positioning_files(args: argparse.Namespace, rig: StereoRig) -> dict[str, str]:
    """The triangulation node's parameters for the same; raises CalibrationError as `positioning_of` does."""
    found = positioning_of(args, rig)
    files = _record_path(args) if found.record is not None else None, args.hand_eye
    return {name: str(path) for name, path in zip(FILE_PARAMETERS, files) if path is not None}


def _record_path(args: argparse.Namespace) -> Path | None:
    if args.calibration_file is not None:
        return Path(args.calibration_file)
    beside = args.calibration / FILE_NAME if args.calibration is not None else None
    return beside if beside is not None and beside.is_file() else None


def _record(args: argparse.Namespace, rig: StereoRig) -> CalibrationRecord | None:
    path = _record_path(args)
    if path is None:
        return None
    try:
        return record_of(path, rig)
    except CalibrationError as error:
        if args.calibration_file is not None:
            raise
        warn(f"covariance without the calibration's part: {error}")
        return None
