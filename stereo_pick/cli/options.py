"""Options that several subcommands share."""

from __future__ import annotations

import argparse
from typing import Any

from stereo_pick.core.configuration import DEFAULT_METHOD, parsed
from stereo_pick.core.correspondence import methods
from stereo_pick.core.images import FULL_SCALE_16, check_full_scale
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
        action=_FullScale,
        type=int,
        default=FULL_SCALE_16,
        metavar="VALUE",
        help="value of a 16-bit image that is white (full_scale_16): 4095 for a 12-bit camera (default: %(default)s)",
    )


class _FullScale(argparse.Action):
    """Keeps the value, checked at once: images of 8 bits never ask for it."""

    def __call__(
        self, parser: argparse.ArgumentParser, namespace: argparse.Namespace, value: Any, option: str | None = None
    ) -> None:
        check_full_scale(value)
        setattr(namespace, self.dest, value)


def pipeline_values(args: argparse.Namespace) -> dict[str, Value]:
    """The parameter values of the options; raises ParameterError on a bad one."""
    return {"method": args.method, **parsed(args.param)}
