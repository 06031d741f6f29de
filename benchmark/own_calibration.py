"""Prints how the whole chain errs with calibrations of its own in place of the true one, as Markdown.

python benchmark/own_calibration.py [--family NAME ...] [--calibrations N] [--seeds N] [--cache DIR] [--write PAGE]

Each calibration is made by the package's solver from simulated corners of a board before the rig that renders the
scenes; then it locates the parts in all of them.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import cv2
from accuracy import replace_generated
from calibrated_scenes import outcome
from calibration_tables import report
from families import FAMILIES


def main() -> None:
    """Print the tables, or put them into a page."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument(
        "--family", nargs="+", choices=FAMILIES, default=["two_cylinders", "four_cylinders", "mixed_shapes"]
    )
    parser.add_argument("--calibrations", type=int, default=20, help="of each rig (default 20)")
    parser.add_argument("--seeds", type=int, default=10, help="scenes a family (default 10)")
    parser.add_argument("--cache", type=Path, help="folder that keeps the rendered scenes")
    parser.add_argument("--write", type=Path, help="page whose generated part is replaced")
    options = parser.parse_args()
    cv2.setNumThreads(1)
    scenes = [(family, seed) for family in options.family for seed in range(options.seeds)]
    ways = [None, *range(options.calibrations)]
    text = report([outcome(*scene, options.cache, way) for scene in scenes for way in ways])
    if options.write:
        replace_generated(options.write, text)
    else:
        print(text)


if __name__ == "__main__":
    main()
