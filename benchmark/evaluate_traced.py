"""Prints what the package finds in path-traced scenes with exact truth, as Markdown.

Needs `pip install 'mitsuba>=3.9'` and LLVM's library, 15 or later; DRJIT_LIBLLVM_PATH says where that is, if it is not
found.

python benchmark/evaluate_traced.py [--family NAME ...] [--seeds N] [--param NAME=VALUE] [--cache DIR] [--jobs N]
python benchmark/evaluate_traced.py --write docs/path_traced.md
python benchmark/evaluate_traced.py --given-table
python benchmark/evaluate_traced.py --show FAMILY SEED OUT.png
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from functools import partial
from pathlib import Path

import cv2
import numpy as np
from family_output import ask_for_output, give_out
from family_picture import picture
from family_scoring import WRONG_M, SceneScore, score
from family_tables import accuracy_table, covariance_table, detection_table, shape_table, size_table
from formatting import markdown_table
from given_table import given_table
from processes import each, scene_parser
from reliability import reliability_table
from rendering import Truth
from scene_cache import kept
from traced_families import TRACED, traced

from stereo_pick.core.configuration import parsed, steps
from stereo_pick.core.frames import StereoFrame
from stereo_pick.core.pipeline import Pipeline
from stereo_pick.core.rig import StereoRig

Taken = tuple[StereoRig, StereoFrame, Truth]
_SOURCES = ("path_tracing", "traced_families", "parts", "placing")


def main() -> None:
    """Print the tables, or draw one scene."""
    options = _options()
    if options.show:
        family, seed, file = options.show
        rig, frame, truth = taken(options.cache, (family, int(seed)))
        cv2.imwrite(file, picture(Pipeline(rig, steps({})), frame, truth))
        return
    seeds = range(options.first_seed, options.first_seed + options.seeds)
    jobs = [(family, seed) for family in options.family for seed in seeds]
    scores = each(jobs, partial(_scored, options.cache, tuple(options.param), options.given_table), options.jobs)
    text = _report(scores)
    give_out(options, scores, text)


def taken(folder: Path | None, job: tuple[str, int]) -> Taken:
    """A scene's rig, raw pair and truth; traced once where a folder keeps it."""
    family, seed = job
    return kept(folder, f"traced_{family}_{seed}", _SOURCES, lambda: _taken(family, seed))


def _taken(family: str, seed: int) -> Taken:
    scene = traced(family, seed)
    return scene.rig, *scene.taken()


def _scored(folder: Path | None, param: tuple[str, ...], is_given: bool, job: tuple[str, int]) -> SceneScore:
    rig, frame, truth = taken(folder, job)
    table = (given_table(rig, truth),) if is_given else ()
    return score(*job, Pipeline(rig, steps(parsed(param + table))), frame, truth)


def _report(scores: Sequence[SceneScore]) -> str:
    required, missed = sum(one.required for one in scores), sum(len(one.missed) for one in scores)
    published, wrong = sum(one.published for one in scores), sum(one.wrong for one in scores)
    unadmitted = sum(one.unadmitted for one in scores)
    rows = [(name, (TRACED[name].__doc__ or "").strip()) for name in dict.fromkeys(one.family for one in scores)]
    return "\n\n".join(
        [
            f"{len(scores)} scenes. Of {required} parts that must be found, {required - missed} are; of {published} "
            f"positions that are published, {wrong} are more than {1000 * WRONG_M:g} mm wrong, {unadmitted} of them by "
            f"more than their covariance admits with 95 %. OpenCV {cv2.__version__}, NumPy {np.__version__}.",
            markdown_table(("family", "scene"), rows, words=True),
            "### Found, missed, refused",
            detection_table(scores),
            "### Errors",
            accuracy_table(scores),
            "### The stated covariance",
            covariance_table(scores),
            shape_table(scores),
            "### Confidence",
            reliability_table(scores),
            "### Size, orientation, time",
            size_table(scores),
        ]
    )


def _options() -> argparse.Namespace:
    parser = scene_parser(__doc__, default=list(TRACED), families=TRACED, seeds=6)
    parser.add_argument("--first-seed", type=int, default=0)
    parser.add_argument("--param", action="append", default=[], metavar="NAME=VALUE", help="as of stereo-pick locate")
    parser.add_argument("--given-table", action="store_true", help="tell the method the true table of each scene")
    ask_for_output(parser)
    return parser.parse_args()


if __name__ == "__main__":
    main()
