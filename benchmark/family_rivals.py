"""The thesis's methods and OpenCV's dense stereo beside the package, on scenes of the thesis's rig."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from itertools import combinations
from pathlib import Path

import numpy as np
from family_cache import taken
from formatting import Row, markdown_table, mean_and_max
from rendering import TrueObject, Truth
from rendering.rigs import BENCH_RIGS
from rivals import SSD, Contender, contenders
from scoring import one_to_one

from stereo_pick.core.arrays import Floats
from stereo_pick.core.poses import ObjectPoses

RIG = "thesis"
FAMILIES_SHARED = ("two_cylinders", "four_cylinders", "mixed_shapes", "light_differences", "low_contrast", "touching")


@dataclass(frozen=True, eq=False)
class RivalScore:
    """What one contender found in one scene [m]: depths between required objects, and positions of them, are off by."""

    family: str
    contender: str
    required: int
    depths_m: tuple[float, ...]
    distances_m: tuple[float, ...]
    ghosts: int
    refused: int


def rival_scores(family: str, seed: int, folder: Path | None) -> list[RivalScore]:
    """All contenders in a scene; none where the scene is of another rig."""
    if family not in FAMILIES_SHARED:
        return []
    rig_name, frame, truth = taken(family, seed, folder)
    return (
        [held_to_its_point(family, each, each.locate(frame), truth) for each in _contenders()]
        if rig_name == RIG
        else []
    )


@cache
def _contenders() -> list[Contender]:
    return [each for each in contenders(BENCH_RIGS[RIG]) if each.name != SSD]


def held_to_its_point(family: str, contender: Contender, poses: ObjectPoses, truth: Truth) -> RivalScore:
    """What these poses [m] are worth, each against the point of its part that the contender means."""
    pairs = one_to_one(truth.centres_m * 1000, poses.xyz * 1000)
    hits = [(truth.objects[which], poses.xyz[row]) for which, row in pairs if truth.objects[which].required]
    errors_m = [xyz - _meant_m(contender, item) for item, xyz in hits]
    return RivalScore(
        family=family,
        contender=contender.name,
        required=sum(each.required for each in truth.objects),
        depths_m=tuple(abs(float(second[2] - first[2])) for first, second in combinations(errors_m, 2)),
        distances_m=tuple(float(np.linalg.norm(error)) for error in errors_m),
        ghosts=len(poses.xyz) - len(pairs),
        refused=len(poses.refused),
    )


def _meant_m(contender: Contender, item: TrueObject) -> Floats:
    """Where in truth the point is that the contender gives: of the surface, its mean stands for all of its points."""
    if contender.meant == "centre of volume" or item.visible_m is None:
        return item.centre_m
    return item.visible_m


def rivals_table(scores: Sequence[RivalScore]) -> str:
    """A row for every method in every family."""
    header = ("family", "method", "found / required", "ghosts", "refused", "depth differences", "positions")
    names = dict.fromkeys((each.family, each.contender) for each in scores)
    return markdown_table(
        header,
        [
            (family, name, *_row([each for each in scores if (each.family, each.contender) == (family, name)]))
            for family, name in names
        ],
    )


def _row(scores: Sequence[RivalScore]) -> Row:
    return (
        f"{sum(len(each.distances_m) for each in scores)} / {sum(each.required for each in scores)}",
        str(sum(each.ghosts for each in scores)),
        str(sum(each.refused for each in scores)),
        mean_and_max(1000 * depth for each in scores for depth in each.depths_m),
        mean_and_max(1000 * distance for each in scores for distance in each.distances_m),
    )
