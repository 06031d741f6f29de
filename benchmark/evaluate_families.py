"""Prints what the package finds in families of rendered scenes with exact truth, as Markdown.

python benchmark/evaluate_families.py [--family NAME ...] [--seeds N] [--cache DIR] [--method feature|ssd] [--jobs N]
python benchmark/evaluate_families.py --rivals --write docs/families.md
python benchmark/evaluate_families.py --show FAMILY SEED OUT.png
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Sequence
from functools import cache, partial
from pathlib import Path

import cv2
import numpy as np
from accuracy import replace_generated
from families import FAMILIES
from family_cache import taken
from family_picture import picture
from family_report import report
from family_rivals import RivalScore, rival_scores
from family_scoring import SceneScore, score
from family_tables import failed_scenes
from processes import each
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
    jobs = [(family, seed) for family in options.family or FAMILIES for seed in seeds]
    scores = each(jobs, partial(_scored, options.method, tuple(options.param), options.cache), options.jobs)
    rivals = each(jobs, partial(_rivals, options.cache), options.jobs) if options.rivals else []
    text = report(scores, [one for of_scene in rivals for one in of_scene])
    if options.write:
        replace_generated(options.write, text)
    else:
        print(text)
    if options.failures:
        print(f"\n{failed_scenes(scores)}")
    if options.dump:
        options.dump.write_text(dumped(scores), encoding="utf-8")


def dumped(scores: Sequence[SceneScore]) -> str:
    """The errors as JSON, object by object."""
    return json.dumps([_record(of) for of in scores], indent=1)


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--family", nargs="+", choices=FAMILIES, help="default: all")
    parser.add_argument("--seeds", type=int, default=30, help="scenes a family (default 30)")
    parser.add_argument("--first-seed", type=int, default=0)
    parser.add_argument("--method", default="feature")
    parser.add_argument("--param", action="append", default=[], metavar="NAME=VALUE", help="as of stereo-pick locate")
    parser.add_argument("--cache", type=Path, help="folder that keeps the rendered scenes")
    parser.add_argument("--jobs", type=int, default=1, help="processes")
    parser.add_argument("--dump", type=Path, help="JSON file for the errors, object by object")
    parser.add_argument("--rivals", action="store_true", help="other methods on some families as well")
    parser.add_argument("--write", type=Path, help="page whose generated part is replaced")
    parser.add_argument("--failures", action="store_true", help="list the scenes that are not wholly right")
    parser.add_argument("--show", nargs=3, metavar=("FAMILY", "SEED", "OUT.png"), help="draw one scene")
    return parser.parse_args()


def _scored(method: str, param: tuple[str, ...], folder: Path | None, job: Job) -> SceneScore:
    family, seed = job
    rig_name, frame, truth = taken(family, seed, folder)
    return score(family, seed, _pipeline(rig_name, method, param), frame, truth)


def _rivals(folder: Path | None, job: Job) -> list[RivalScore]:
    return rival_scores(*job, folder)


@cache
def _pipeline(rig_name: str, method: str, param: tuple[str, ...]) -> Pipeline:
    return Pipeline(BENCH_RIGS[rig_name], steps({"method": method, **parsed(param)}))


def _record(of: SceneScore) -> dict[str, object]:
    found = {each.which: each for each in of.found}
    objects = []
    for number, truth in enumerate(of.objects):
        hit = found.get(number)
        objects.append(
            {
                "shape": f"lying {truth.shape}" if truth.lying else truth.shape,
                "required": truth.required,
                "visible": truth.visible,
                "centre_mm": _mm(truth.centre_m),
                "extent_mm": _mm(np.array(truth.extent_m)),
                "error_mm": _mm(hit.position_m) if hit else None,
                "mahalanobis2": hit.mahalanobis2 if hit else None,
                "size_error_mm": _mm(hit.size_m) if hit and hit.size_m is not None else None,
                "yaw_error_deg": float(np.rad2deg(hit.yaw_rad)) if hit and hit.yaw_rad is not None else None,
            }
        )
    return {
        "family": of.family, "seed": of.seed, "right": of.right, "objects": objects,
        "ghosts_mm": _mm(of.ghosts_m), "refused": dict(of.refused), "ms": of.seconds * 1000,
    }  # fmt: skip


def _mm(metres: np.ndarray) -> list[float]:
    return np.round(1000 * metres, 4).tolist()


if __name__ == "__main__":
    main()
