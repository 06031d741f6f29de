"""Prints how the whole chain errs with calibrations of its own in place of the true one, as Markdown.

python benchmark/own_calibration.py [--family NAME ...] [--calibrations N] [--seeds N] [--jobs N] [--write PAGE]

Each calibration is made by the package's solver from simulated corners of a board before the rig that renders the
scenes; then it locates the parts in all of them.
"""

from __future__ import annotations

from functools import partial
from pathlib import Path

from accuracy import replace_generated
from calibrated_scenes import Outcome, outcome
from calibration_tables import report
from processes import each, scene_parser


def main() -> None:
    """Print the tables, or put them into a page."""
    parser = scene_parser(__doc__, ["two_cylinders", "four_cylinders", "mixed_shapes"])
    parser.add_argument("--calibrations", type=int, default=20, help="of each rig (default 20)")
    options = parser.parse_args()
    jobs = [(family, seed) for family in options.family for seed in range(options.seeds)]
    outcomes = each(jobs, partial(_outcomes, options.calibrations, options.cache), options.jobs)
    text = report([one for of_scene in outcomes for one in of_scene])
    if options.write:
        replace_generated(options.write, text)
    else:
        print(text)


def _outcomes(calibrations: int, folder: Path | None, job: tuple[str, int]) -> list[Outcome]:
    return [outcome(*job, folder, way) for way in (None, *range(calibrations))]


if __name__ == "__main__":
    main()
