"""`stereo-pick import-bouguet`: calibration files from the result of Bouguet's Matlab toolbox."""

from __future__ import annotations

import argparse
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from stereo_pick.core.arrays import Floats
from stereo_pick.core.calibration.bouguet import METRES_PER_UNIT, rig_from_bouguet
from stereo_pick.core.calibration.files import save_rig
from stereo_pick.core.drafts import renewed
from stereo_pick.core.errors import CalibrationError

_PIP = "pip install scipy"

_DESCRIPTION = f"""\
Turn the stereo result of Bouguet's Camera Calibration Toolbox for Matlab into left.yaml, right.yaml (camera_info) and
stereo.yaml (OpenCV, in metres). Needs scipy (the extra `bouguet`): {_PIP}, or your system's python3-scipy."""

_EPILOG = """\
example:
  stereo-pick import-bouguet Calib_Results_stereo.mat --output my_rig"""


def add_parser(subparsers: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the `import-bouguet` subcommand."""
    parser = subparsers.add_parser(
        "import-bouguet",
        help="take over a calibration from Bouguet's Matlab toolbox",
        description=_DESCRIPTION,
        epilog=_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("file", type=Path, metavar="FILE", help="Calib_Results_stereo.mat")
    parser.add_argument(
        "--output", required=True, type=Path, metavar="DIR", help="folder for the result; files in it are replaced"
    )
    parser.add_argument(
        "--unit", choices=tuple(METRES_PER_UNIT), default="mm", help="in which the squares were given (default: mm)"
    )
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """Read, write the files and say what they hold; raises CalibrationError on anything unusable."""
    values = read_mat(args.file)
    try:
        rig = rig_from_bouguet(values, args.unit)
    except CalibrationError as error:
        raise CalibrationError(f"{args.file}: {error}") from None
    try:
        with renewed(args.output) as draft:
            written = [args.output / file.name for file in save_rig(rig, draft)]
    except OSError as error:
        raise CalibrationError(f"--output {args.output} cannot be written: {error.strerror}") from None
    print(f"images    {rig.left.width_px} x {rig.left.height_px}")
    for camera in (rig.left, rig.right):
        print(f"{camera.name:<10}fx fy cx cy {_numbers(camera.K[[0, 1, 0, 1], [0, 1, 2, 2]])} px")
    print(f"baseline  {rig.baseline_m * 1000:.3f} mm, T {_numbers(rig.right_T_left.translation * 1000)} mm")
    print("\n".join(f"written   {path}" for path in written))
    return 0


def read_mat(path: Path) -> Mapping[str, Any]:
    """The variables of a Matlab file; raises CalibrationError naming it, or how to get scipy where that is absent."""
    try:
        from scipy.io import loadmat
    except ImportError:
        raise CalibrationError(f"{path}: Matlab files need scipy, which is not installed: {_PIP}") from None
    try:
        values: Mapping[str, Any] = loadmat(str(path), appendmat=False)
    except FileNotFoundError:
        raise CalibrationError(f"{path}: no such file") from None
    except OSError as error:
        raise CalibrationError(f"{path}: cannot be read: {error.strerror or error}") from None
    except NotImplementedError:
        raise CalibrationError(f"{path}: is of Matlab's version 7.3; save it again with save(..., '-v7')") from None
    except Exception as error:  # of a damaged file, scipy lets out whatever its parser stumbles over
        raise CalibrationError(f"{path}: is no Matlab file: {error}") from None
    return values


def _numbers(values: Floats) -> str:
    return " ".join(f"{value:.3f}" for value in values)
