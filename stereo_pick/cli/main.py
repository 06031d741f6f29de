"""The command `stereo-pick`."""

from __future__ import annotations

import argparse
import errno
import io
import os
import re
import sys
from collections.abc import Sequence

from stereo_pick import __version__
from stereo_pick.core.errors import StereoPickError

_DESCRIPTION = """\
Stereo guidance for robotic picking: finds the objects that two calibrated cameras see on a work surface and tells
where they are, in the left camera's own optical frame (x right, y down, z forward; metres)."""

_EPILOG = """\
from two cameras to poses:
  stereo-pick calibrate --left 'calib/left*.png' --right 'calib/right*.png' \\
      --board 9x6 --square 0.030 --output my_rig
  stereo-pick locate left.png right.png --calibration my_rig
  stereo-pick run --source my_bag --calibration my_rig

`stereo-pick COMMAND --help` tells more. Exit status: 0 done, 1 an error that is named, 2 a wrong command line."""

_OF_ROS = re.compile(r"_?rclpy|rpyutils|std_srvs|\w+_(msgs|interfaces)")


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command and return its exit status."""
    try:
        _print_anything()
        args = _parser().parse_args(argv)
        status = int(args.run(args))
        print(end="", flush=True)  # what fails later nobody catches
        return status
    except (Exception, KeyboardInterrupt) as error:
        told = 130 if _is_ctrl_c(error) else _told(error)
        if told is None:
            raise
        return told


def _print_anything() -> None:
    """Print what the terminal's encoding lacks, as ± in ASCII or a file's name that is not UTF-8, by its code."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")


def _is_ctrl_c(error: BaseException | None) -> bool:
    """Whether Ctrl-C is behind an error: within the import of a C extension it becomes an ImportError."""
    while error is not None:
        if isinstance(error, KeyboardInterrupt):
            return True
        error = error.__cause__ or error.__context__
    return False


def _told(error: BaseException) -> int | None:
    """Say in one line what is wrong, and return the exit status; None of a fault of the program itself."""
    if isinstance(error, StereoPickError):
        print(f"stereo-pick: error: {error}", file=sys.stderr)
        return 1
    if isinstance(error, ImportError) and _OF_ROS.match(error.name or ""):
        needed = f"ROS 2 for Python {sys.version_info[0]}.{sys.version_info[1]} ({error.msg.partition(chr(10))[0]})"
        remedy = "source its setup.bash, or install the extra `wheels` of this package"
        print(f"stereo-pick: error: this needs {needed}: {remedy}", file=sys.stderr)
        return 1
    if isinstance(error, BrokenPipeError):
        sys.stderr.close()
        return 0
    if isinstance(error, OSError) and error.errno == errno.ENOSPC:
        print(f"stereo-pick: error: {error.filename or 'standard output'}: {error.strerror}", file=sys.stderr)
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())  # Python writes at its end what is left
        return 1
    return None


def _parser() -> argparse.ArgumentParser:
    # Here, not above: they take a second to load, and Ctrl-C must not end in a traceback even then.
    from stereo_pick.cli import (
        background,
        board,
        calibrate,
        demo,
        hand_eye,
        import_bouguet,
        locate,
        parameters,
        replay,
        run,
        table,
    )

    parser = argparse.ArgumentParser(
        prog="stereo-pick",
        description=_DESCRIPTION,
        epilog=_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--version", action="version", version=f"stereo-pick {__version__}")
    subparsers = parser.add_subparsers(required=True, metavar="COMMAND", title="commands")
    for command in (
        run,
        locate,
        replay,
        background,
        table,
        calibrate,
        board,
        import_bouguet,
        hand_eye,
        parameters,
        demo,
    ):
        command.add_parser(subparsers)
    return parser


if __name__ == "__main__":
    sys.exit(main())
