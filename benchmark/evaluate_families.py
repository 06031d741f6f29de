"""Prints what the package finds in families of rendered scenes with exact truth, as Markdown.

python benchmark/evaluate_families.py [--family NAME ...] [--seeds N] [--cache DIR] [--method feature|ssd] [--jobs N]
python benchmark/evaluate_families.py --rivals --write docs/families.md
python benchmark/evaluate_families.py --given-table
python benchmark/evaluate_families.py --show FAMILY SEED OUT.png
"""

from __future__ import annotations

import argparse
from functools import lru_cache, partial
from pathlib import Path

import cv2
from families import FAMILIES
from family_cache import taken
from family_output import ask_for_output, give_out
from family_picture import picture
from family_report import report
from family_rivals import RivalScore, rival_scores
from family_scoring import SceneScore, score
from given_table import given_table
from processes import each, scene_parser
from rendering.rigs import BENCH_RIGS

from stereo_pick.core.configuration import parsed, steps
from stereo_pick.core.pipeline import Pipeline

Job = tuple[str, int]


def main() -> None:
    """Print the tables, or draw one scene."""
    options = _options()
    if options.show:
        family, seed, file = options.show
        rig_name, frame, truth = taken(family, int(seed), options.cache)
        cv2.imwrite(file, picture(_pipeline(rig_name, options.method, tuple(options.param)), frame, truth))
        return
    seeds = range(options.first_seed, options.first_seed + options.seeds)
    jobs = [(family, seed) for family in options.family for seed in seeds]
    score_one = partial(_scored, options.method, tuple(options.param), options.cache, options.given_table)
    scores = each(jobs, score_one, options.jobs)
    rivals = each(jobs, partial(_rivals, options.cache), options.jobs) if options.rivals else []
    text = report(scores, [one for of_scene in rivals for one in of_scene])
    give_out(options, scores, text)


def _options() -> argparse.Namespace:
    parser = scene_parser(__doc__, default=list(FAMILIES))
    parser.add_argument("--first-seed", type=int, default=0)
    parser.add_argument("--method", default="feature")
    parser.add_argument("--param", action="append", default=[], metavar="NAME=VALUE", help="as of stereo-pick locate")
    parser.add_argument("--rivals", action="store_true", help="other methods on some families as well")
    parser.add_argument("--given-table", action="store_true", help="tell the method the true table of each scene")
    ask_for_output(parser)
    return parser.parse_args()


def _scored(method: str, param: tuple[str, ...], folder: Path | None, is_given: bool, job: Job) -> SceneScore:
    family, seed = job
    rig_name, frame, truth = taken(family, seed, folder)
    table = (given_table(BENCH_RIGS[rig_name], truth),) if is_given else ()
    return score(family, seed, _pipeline(rig_name, method, param + table), frame, truth)


def _rivals(folder: Path | None, job: Job) -> list[RivalScore]:
    return rival_scores(*job, folder)


@lru_cache(maxsize=len(BENCH_RIGS))
def _pipeline(rig_name: str, method: str, param: tuple[str, ...]) -> Pipeline:
    return Pipeline(BENCH_RIGS[rig_name], steps({"method": method, **parsed(param)}))


if __name__ == "__main__":
    main()
