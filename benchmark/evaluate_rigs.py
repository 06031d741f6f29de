"""Prints what the package finds with rigs of all makes, each drawn at random, as Markdown.

python benchmark/evaluate_rigs.py [--family NAME ...] [--seeds N] [--cache DIR] [--jobs N]
python benchmark/evaluate_rigs.py --jobs 2 --write docs/other_rigs.md
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from statistics import fmean, median

import cv2
import numpy as np
from accuracy import replace_generated
from drawn_rigs import DrawnRig, drawn_rig
from families import FAMILIES, staged
from family_scoring import SceneScore, score
from formatting import decimals, markdown_table, percent
from mahalanobis import CHI2_3
from processes import each, scene_parser
from rendering import Truth
from rendering.rigs import BENCH_RIGS, DISTANCES_M
from scene_cache import kept

from stereo_pick.core.configuration import steps
from stereo_pick.core.frames import StereoFrame
from stereo_pick.core.pipeline import Pipeline

Job = tuple[str, int]
Scored = tuple[DrawnRig, SceneScore]
_TRIES = 20
_SOURCES = ("drawn_rigs", "families", "staging", "parts", "placing")


def main() -> None:
    """Print the tables, or put them into a page."""
    options = scene_parser(__doc__, default=list(FAMILIES), seeds=10).parse_args()
    jobs = [(family, seed) for family in options.family for seed in range(options.seeds)]
    scores = each(jobs, partial(scored, options.cache), options.jobs)
    text = _report(scores, options.family, options.seeds)
    if options.write:
        replace_generated(options.write, text)
    else:
        print(text)


def scored(folder: Path | None, job: Job) -> Scored:
    """What is found of a scene of a family before a rig of its own."""
    family, seed = job
    drawn, frame, truth = kept(folder, f"drawn_{family}_{seed}", _SOURCES, lambda: _taken(family, seed))
    return drawn, score(family, seed, Pipeline(drawn.rig, steps({})), frame, truth)


def _taken(family: str, seed: int) -> tuple[DrawnRig, StereoFrame, Truth]:
    """The scene before its rig; of rigs before which the family finds no room the next one."""
    for attempt in range(_TRIES):
        drawn = drawn_rig(family, seed + 1000 * attempt)
        with _instead_of_all(drawn):
            try:
                scene = staged(family, seed)
            except RuntimeError:
                continue
            return drawn, *scene.taken()
    raise RuntimeError(f"{family} {seed}: no rig has room for it")


@contextmanager
def _instead_of_all(drawn: DrawnRig) -> Iterator[None]:
    """Families choose one of the benchmark's rigs: for a while all of these are this one."""
    before = dict(BENCH_RIGS), dict(DISTANCES_M)
    try:
        for name in before[0]:
            BENCH_RIGS[name], DISTANCES_M[name] = drawn.rig, drawn.distances_m
        yield
    finally:
        BENCH_RIGS.update(before[0])
        DISTANCES_M.update(before[1])


def _report(several: Sequence[Scored], families: Sequence[str], seeds: int) -> str:
    widths = sorted({drawn.width_px for drawn, _ in several})
    by_width = [_row(f"{width} px", several, lambda drawn, _, width=width: drawn.width_px == width) for width in widths]
    by_family = [_row(name, several, lambda _, one, name=name: one.family == name) for name in families]
    all_ = _row("all", several, lambda *_: True)
    return "\n\n".join(
        [
            f"{len(several)} scenes, {seeds} of each family, and as many rigs. "
            f"OpenCV {cv2.__version__}, NumPy {np.__version__}.",
            markdown_table(("images", *_HEADER), [*by_width, all_]),
            markdown_table(("family", *_HEADER), [*by_family, all_]),
        ]
    )


_HEADER = ("scenes", "found / required", "ghosts", "> 5 mm wrong", "of these not admitted", "median mm", "d² < 7.81")


def _row(name: str, several: Sequence[Scored], belongs: Callable[[DrawnRig, SceneScore], bool]) -> tuple[str, ...]:
    scores = [one for drawn, one in several if belongs(drawn, one)]
    required, missed = sum(one.required for one in scores), sum(len(one.missed) for one in scores)
    off_m = [value for one in scores for value in one.off_m]
    surprise = [value for one in scores for value in one.mahalanobis2]
    return (
        name,
        str(len(scores)),
        f"{required - missed} / {required}",
        str(sum(len(one.ghosts_m) for one in scores)),
        str(sum(one.wrong for one in scores)),
        str(sum(one.unadmitted for one in scores)),
        decimals(1000 * median(off_m), 2) if off_m else "–",
        percent(fmean(value < CHI2_3[95] for value in surprise)) if surprise else "–",
    )


if __name__ == "__main__":
    main()
