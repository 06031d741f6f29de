"""Prints what the package finds where there is more to be seen than parts on a plain table, as Markdown.

python benchmark/evaluate_surroundings.py [--family NAME ...] [--first-seed N] [--seeds N] [--cache DIR] [--jobs N]
python benchmark/evaluate_surroundings.py --jobs 2 --write docs/surroundings.md
python benchmark/evaluate_surroundings.py --show FAMILY SEED OUT.png
"""

from __future__ import annotations

import argparse
from collections import Counter
from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from statistics import fmean

import cv2
import numpy as np
from accuracy import replace_generated
from family_picture import picture
from family_scoring import SceneScore, score
from formatting import markdown_table, percent
from mahalanobis import CHI2_3
from processes import each, scene_parser
from rendering import Truth
from rendering.rigs import BENCH_RIGS
from scene_cache import kept
from surroundings import SURROUNDINGS, staged

from stereo_pick.core.configuration import steps
from stereo_pick.core.frames import StereoFrame
from stereo_pick.core.pipeline import Pipeline

Job = tuple[str, int]
_SOURCES = ("surroundings", "staging", "parts", "placing")
_UNSEEN = 0.0, 0.0  # what need not be found counts as hidden
_REASONS = 3


def main() -> None:
    """Print the tables, put them into a page, or draw one scene."""
    options = _options()
    if options.show:
        family, seed, file = options.show
        rig_name, frame, truth = taken(options.cache, (family, int(seed)))
        cv2.imwrite(file, picture(Pipeline(BENCH_RIGS[rig_name], steps({})), frame, truth))
        return
    seeds = range(options.first_seed, options.first_seed + options.seeds)
    jobs = [(family, seed) for family in options.family for seed in seeds]
    text = _report(each(jobs, partial(scored, options.cache), options.jobs), options.family)
    if options.write:
        replace_generated(options.write, text)
    else:
        print(text)


def scored(folder: Path | None, job: Job) -> SceneScore:
    """What is found in one scene."""
    rig_name, frame, truth = taken(folder, job)
    return score(*job, Pipeline(BENCH_RIGS[rig_name], steps({})), frame, truth)


def taken(folder: Path | None, job: Job) -> tuple[str, StereoFrame, Truth]:
    """The rig's name, the raw pair, and its truth, of which the parts alone must be found."""
    return kept(folder, "_".join(map(str, job)), _SOURCES, lambda: _rendered(*job))


def _rendered(family: str, seed: int) -> tuple[str, StereoFrame, Truth]:
    scene, parts = staged(family, seed)
    frame, truth = scene.taken()
    others = tuple(replace(thing, visible=_UNSEEN) for thing in truth.objects[parts:])
    return scene.rig_name, frame, replace(truth, objects=truth.objects[:parts] + others)


def _report(scores: Sequence[SceneScore], families: Sequence[str]) -> str:
    described = [(name, (SURROUNDINGS[name].__doc__ or "").strip()) for name in families]
    rows = [_row(name, [one for one in scores if one.family == name]) for name in families]
    header = (
        "surroundings", "scenes", "found / required", "others", "ghosts", "> 5 mm wrong", "not admitted of these",
        "d² < 7.81", "refused most often",
    )  # fmt: skip
    return "\n\n".join(
        [
            f"{len(scores)} scenes. OpenCV {cv2.__version__}, NumPy {np.__version__}.",
            markdown_table(("surroundings", "what there is"), described, words=True),
            markdown_table(header, [*rows, _row("all", scores)]),
        ]
    )


def _row(name: str, scores: Sequence[SceneScore]) -> tuple[str, ...]:
    required, missed = sum(one.required for one in scores), sum(len(one.missed) for one in scores)
    surprise = [value for one in scores for value in one.mahalanobis2]
    refused = sum((one.refused for one in scores), Counter[str]())
    return (
        name,
        str(len(scores)),
        f"{required - missed} / {required}",
        str(sum(not found.truth.required for one in scores for found in one.found)),
        str(sum(len(one.ghosts_m) for one in scores)),
        str(sum(one.wrong for one in scores)),
        str(sum(one.unadmitted for one in scores)),
        percent(fmean(value < CHI2_3[95] for value in surprise)) if surprise else "–",
        ", ".join(f"{count} {reason}" for reason, count in refused.most_common(_REASONS)),
    )


def _options() -> argparse.Namespace:
    parser = scene_parser(__doc__, default=list(SURROUNDINGS), families=SURROUNDINGS, seeds=6)
    parser.add_argument("--first-seed", type=int, default=0)
    parser.add_argument("--show", nargs=3, metavar=("FAMILY", "SEED", "PNG"), help="draw one scene")
    return parser.parse_args()


if __name__ == "__main__":
    main()
