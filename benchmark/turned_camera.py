"""Prints what becomes of positions when the right camera has turned since its calibration, as Markdown.

python benchmark/turned_camera.py [--family NAME ...] [--seeds N] [--cache DIR] [--jobs N] [--write PAGE]
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache, partial
from pathlib import Path

import numpy as np
from accuracy import replace_generated
from family_cache import taken
from family_scoring import SceneScore, score
from family_tables import by_family
from formatting import markdown_table, mean_and_max
from mahalanobis import covered
from processes import each, scene_parser
from rendering.rigs import BENCH_RIGS, rotation

from stereo_pick.core.pipeline import Pipeline, Steps
from stereo_pick.core.rig import StereoRig
from stereo_pick.core.transform import Transform

Turn = tuple[float, float, float]
"""About the right camera's x, y and z axis [mrad]."""

_TURNS: dict[str, Turn] = {
    "none": (0.0, 0.0, 0.0),
    "0.5 mrad pitch": (0.5, 0.0, 0.0),
    "1 mrad pitch": (1.0, 0.0, 0.0),
    "0.5 mrad roll": (0.0, 0.0, 0.5),
    "1 mrad roll": (0.0, 0.0, 1.0),
    "0.5 mrad about all axes": (0.5, 0.5, 0.5),
    "4 mrad about all axes": (4.0, 4.0, 4.0),
}
_HEADER = (
    "family", "turn", "found / required", "refused as misaligned", "> 5 mm wrong", "depth differences mm",
    "positions mm", "d² < 7.81",
)  # fmt: skip


def main() -> None:
    """Print the table, or put it into a page."""
    options = scene_parser(__doc__, ["four_cylinders", "mixed_shapes", "light_differences"]).parse_args()
    jobs = [(family, seed) for family in options.family for seed in range(options.seeds)]
    scores = each(jobs, partial(turned_scores, options.cache), options.jobs)
    text = report(scores)
    if options.write:
        replace_generated(options.write, text)
    else:
        print(text)


def turned_scores(folder: Path | None, job: tuple[str, int]) -> dict[str, SceneScore]:
    """One scene after each of the turns."""
    family, seed = job
    rig_name, frame, truth = taken(family, seed, folder)
    return {name: score(family, seed, _pipeline(rig_name, turn), frame, truth) for name, turn in _TURNS.items()}


def report(scenes: Sequence[dict[str, SceneScore]]) -> str:
    """A row for each family and turn."""
    in_turn = zip(*(by_family([scene[name] for scene in scenes]) for name in _TURNS))
    rows = [(family, name, *_cells(scores)) for families in in_turn for name, (family, scores) in zip(_TURNS, families)]
    return markdown_table(_HEADER, rows)


def _cells(scores: Sequence[SceneScore]) -> tuple[str, ...]:
    required = sum(each.required for each in scores)
    squares = [square for each in scores for square in each.mahalanobis2]
    return (
        f"{required - sum(len(each.missed) for each in scores)} / {required}",
        str(sum("misaligned" in each.refused for each in scores)),
        str(sum(each.wrong for each in scores)),
        mean_and_max(1000 * depth for each in scores for depth in each.depths_m),
        mean_and_max(1000 * distance for each in scores for distance in each.distances_m),
        covered(squares) if squares else "–",
    )


def stale(rig: StereoRig, turn: Turn) -> StereoRig:
    """The rig as its calibration has it from before the right camera turned."""
    turned = Transform(rotation(np.divide(turn, 1000)), np.zeros(3)) @ rig.right_T_left
    return StereoRig.from_extrinsics(rig.left, rig.right, turned)


@cache
def _pipeline(rig_name: str, turn: Turn) -> Pipeline:
    return Pipeline(stale(BENCH_RIGS[rig_name], turn), Steps())


if __name__ == "__main__":
    main()
