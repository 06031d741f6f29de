"""Options that several subcommands share."""

from __future__ import annotations

import argparse

from stereo_pick.core.configuration import DEFAULT_METHOD, parsed
from stereo_pick.core.correspondence import methods
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


def pipeline_values(args: argparse.Namespace) -> dict[str, Value]:
    """The parameter values of the options; raises ParameterError on a bad one."""
    return {"method": args.method, **parsed(args.param)}
