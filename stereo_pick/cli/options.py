"""Options that several subcommands share."""

from __future__ import annotations

import argparse

from stereo_pick.core.configuration import DEFAULT_METHOD, parsed
from stereo_pick.core.correspondence import methods
from stereo_pick.core.images import FULL_SCALE_16
from stereo_pick.core.params import Value


def add_pipeline_options(parser: argparse.ArgumentParser) -> None:
    """Add --method and --param."""
    parser.add_argument(
        "--method",
        choices=tuple(methods()),
        default=DEFAULT_METHOD,
        help="how objects are found again in the right view (default: %(default)s)",
    )
    parser.add_argument(
        "--param",
        action="append",
        default=[],
        metavar="NAME=VALUE",
        help="set a parameter, e.g. segmentation.polarity=dark; may be repeated; `stereo-pick parameters` lists them",
    )


def add_depth_option(parser: argparse.ArgumentParser) -> None:
    """Add --full-scale-16."""
    parser.add_argument(
        "--full-scale-16",
        type=int,
        default=FULL_SCALE_16,
        metavar="VALUE",
        help="value of a 16-bit image that is white (full_scale_16): 4095 for a 12-bit camera (default: %(default)s)",
    )


def pipeline_values(args: argparse.Namespace) -> dict[str, Value]:
    """The parameter values of the options; raises ParameterError on a bad one."""
    return {"method": args.method, **parsed(args.param)}
