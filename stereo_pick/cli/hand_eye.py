"""`stereo-pick hand-eye`: where the camera stands in the robot's frame."""

from __future__ import annotations

import argparse
from pathlib import Path

from stereo_pick.cli.options import add_depth_option
from stereo_pick.cli.outputs import keep
from stereo_pick.core.calibration.any_board import Board, parse_board
from stereo_pick.core.calibration.files import load_rig, rig_files
from stereo_pick.core.calibration.fingerprint import calibration_hash
from stereo_pick.core.camera import Camera
from stereo_pick.core.errors import CalibrationError, ImageError
from stereo_pick.core.frames import grey
from stereo_pick.core.hand_eye.board_pose import camera_T_board, settle_turns
from stereo_pick.core.hand_eye.files import FramedHandEye, save_hand_eye
from stereo_pick.core.hand_eye.pairs import RobotView
from stereo_pick.core.hand_eye.recording import RecordedPair, RecordedPairs, read_recording
from stereo_pick.core.hand_eye.result import HandEye
from stereo_pick.core.hand_eye.solving import solve_hand_eye
from stereo_pick.core.hand_eye.touched import TouchedPoint, solve_touched
from stereo_pick.core.images import read_image
from stereo_pick.core.rig import StereoRig

_FRAMES = {"base": "base_link", "flange": "flange"}

_DESCRIPTION = """\
Find where the left camera stands in the robot's base frame (fixed camera), or on its flange (camera on the hand), from
a YAML file of pairs (the robot's pose, and the board as the camera saw it then) or of points that the robot's tool
touched. 12 or more pairs are good, the flange tilted by 30 degrees and more about two axes; or 6 or more points,
spread over the work volume."""

_EPILOG = """\
example:
  stereo-pick hand-eye pairs.yaml --calibration my_rig --board 9x6 --square 0.030 --output base_T_camera.yaml

pairs.yaml (metres; image names are relative to the file; instead of an image, an entry may have
camera_T_board: {xyz_m: ..., quaternion_xyzw: ...}, and then no --calibration is needed):
  mount: eye-to-hand        # the board is on the flange; eye-in-hand: the camera is
  pairs:
    - base_T_flange: {xyz_m: [0.412, 0.020, 0.350], quaternion_xyzw: [0.0, 0.966, 0.259, 0.0]}
      image: left01.png
    - ...

or touched points (camera_xyz_m as `stereo-pick locate` tells it, in the left camera's raw optical frame):
  points:
    - {name: corner A, base_xyz_m: [0.510, 0.100, 0.020], camera_xyz_m: [0.031, -0.052, 0.841]}
    - ..."""


def add_parser(subparsers: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the `hand-eye` subcommand."""
    parser = subparsers.add_parser(
        "hand-eye",
        help="find where the camera stands in the robot's frame",
        description=_DESCRIPTION,
        epilog=_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("recording", type=Path, metavar="FILE", help="YAML or JSON file of pairs or touched points")
    parser.add_argument(
        "--calibration",
        type=Path,
        metavar="DIR",
        help="the rig's calibration: needed where FILE names images; its hash goes into the result, which then is "
        "refused beside any other calibration",
    )
    parser.add_argument("--board", metavar="BOARD", help="the board in the images: as at `calibrate`")
    parser.add_argument("--square", type=float, metavar="METRES", help="side of one square in metres")
    add_depth_option(parser)
    parser.add_argument(
        "--output", type=Path, metavar="FILE", help="default: base_T_camera.yaml, or flange_T_camera.yaml"
    )
    parser.add_argument("--parent-frame", metavar="NAME", help="the robot's frame (default: base_link, or flange)")
    parser.add_argument("--child-frame", metavar="NAME", default="left_camera_optical_frame", help="the camera's frame")
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """Solve, write the file and print the report; raises StereoPickError, and writes nothing, on unusable input."""
    recording = read_recording(args.recording)
    rig = load_rig(args.calibration) if args.calibration is not None else None
    try:
        result = _from_pairs(recording, args, rig) if isinstance(recording, RecordedPairs) else solve_touched(recording)
    except CalibrationError as error:
        raise CalibrationError(f"{args.recording}: {error}") from None
    output = args.output or Path(f"{result.name}.yaml")
    keep(_inputs(args, recording), "--output", output, "one of the files it is made from")
    made_with = calibration_hash(rig) if rig is not None else ""
    parent_frame = args.parent_frame or _FRAMES[result.parent]
    save_hand_eye(FramedHandEye(result, parent_frame, args.child_frame, made_with), output)
    print(f"{report(result)}\nwritten   {output}")
    return 0


def report(result: HandEye) -> str:
    """The result for people, one fact a line."""
    found = result.found
    x, y, z = found.transform.translation * 1000
    angles = "" if result.rms_deg is None else f", {result.rms_deg:.4f} deg"
    lines = [
        (result.name, ""),
        ("method", result.method),
        ("position", f"{x:.3f} {y:.3f} {z:.3f} mm, standard deviation {_three(found.sigma_mm.tolist(), 3)} mm"),
        ("rotation", f"standard deviation {_three(found.sigma_deg.tolist(), 4)} deg"),
        ("residual", f"rms {result.rms_mm:.3f} mm{angles} over {len(result.residuals)}"),
        *(("", f"{each.name}: {each.translation_mm:.3f} mm{_angle(each.rotation_deg)}") for each in result.residuals),
        *(("solver", str(attempt)) for attempt in result.attempts),
        *(("warning", text) for text in result.warnings),
    ]
    return "\n".join(f"{label:<10}{text}".rstrip() for label, text in lines)


def _inputs(args: argparse.Namespace, recording: RecordedPairs | tuple[TouchedPoint, ...]) -> list[Path]:
    """All files that are read."""
    calibration = rig_files(args.calibration) if args.calibration is not None else []
    pairs = recording.pairs if isinstance(recording, RecordedPairs) else ()
    return [args.recording, *calibration, *(pair.image for pair in pairs if pair.image is not None)]


def _from_pairs(recording: RecordedPairs, args: argparse.Namespace, rig: StereoRig | None) -> HandEye:
    if all(pair.image is None for pair in recording.pairs):
        views = [_view(pair, None, None, args.full_scale_16) for pair in recording.pairs]
        return solve_hand_eye(views, recording.mount)
    if rig is None or args.board is None or args.square is None:
        raise CalibrationError("it names images: give --calibration, --board and --square to find the board in them")
    camera, board = rig.left, parse_board(args.board, args.square)
    views = [_view(pair, camera, board, args.full_scale_16) for pair in recording.pairs]
    return solve_hand_eye(settle_turns(views, board, recording.mount), recording.mount)


def _view(pair: RecordedPair, camera: Camera | None, board: Board | None, full_scale_16: int) -> RobotView:
    pose = pair.camera_T_board
    if pair.image is not None and camera is not None and board is not None:
        try:
            pose = camera_T_board(grey(read_image(pair.image, full_scale_16)), camera, board)
        except (CalibrationError, ImageError) as error:
            raise CalibrationError(f"{pair.name}: {error}") from None
    if pose is None:
        raise CalibrationError(f"{pair.name}: neither an image nor camera_T_board")
    return RobotView(pair.name, pair.base_T_flange, pose)


def _three(values: list[float], digits: int) -> str:
    return " ".join(f"{value:.{digits}f}" for value in values)


def _angle(angle_deg: float | None) -> str:
    return "" if angle_deg is None else f", {angle_deg:.4f} deg"
