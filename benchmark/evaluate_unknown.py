"""Prints what the package makes of parts of shapes that it does not know, in scenes with exact truth, as Markdown.

python benchmark/evaluate_unknown.py [--family NAME ...] [--parts bright dark alone] [--seeds N] [--jobs N]
python benchmark/evaluate_unknown.py --write docs/unknown_shapes.md
"""

from __future__ import annotations

import argparse
import zlib
from collections.abc import Sequence
from dataclasses import dataclass
from statistics import median
from typing import NamedTuple

import cv2
import numpy as np
from accuracy import replace_generated
from composites import COMPOSITES
from families import Random
from family_scoring import WRONG_M
from formatting import decimals, markdown_table
from mahalanobis import CHI2_3
from odd_parts import ODD_PARTS
from parts import MIXED
from placing import NoRoomError
from processes import each, scene_parser
from staging import BRIGHT, Staged, table_of, workshop

from stereo_pick.core.arrays import Floats
from stereo_pick.core.configuration import steps
from stereo_pick.core.pipeline import Pipeline
from stereo_pick.core.poses import ObjectPoses

_SHAPES = COMPOSITES | ODD_PARTS
_GAP_PX = 10.0
_NEAR_M = 0.005  # beyond a part, within which a pose is taken to be one of it
_SCENE_TRIES = 60
_SURE = 0.99  # confidence
Job = tuple[str, str, int]
_PAPER = (0.65, 0.85)  # of what dark parts lie on
_TITLES = {
    "bright": "Bright parts on a darker table:",
    "dark": "Dark parts on light paper:",
    "alone": "Bright parts with nothing beside them, so that no table is known:",
}


class Parts(NamedTuple):
    """Their albedos, and how many of known shapes are in each scene."""

    albedo: tuple[float, float]
    known: int


_PARTS = {"bright": Parts(BRIGHT, 2), "dark": Parts((0.05, 0.25), 2), "alone": Parts(BRIGHT, 0)}


@dataclass(frozen=True)
class Scored:
    """off_m, mahalanobis2: of each pose within the part, against the centre of its volume; confidence: of each; known,
    found: how many parts of known shapes there are beside it, and are within WRONG_M of where they are."""

    shape: str
    off_m: tuple[float, ...]
    mahalanobis2: tuple[float, ...]
    confidence: tuple[float, ...]
    known: int
    found: int


def main() -> None:
    """Print the table, or put it into a page."""
    options = _options()
    jobs = [(light, shape, i) for light in options.parts for shape in options.family for i in range(options.seeds)]
    text = _report(jobs, each(jobs, scored, options.jobs))
    if options.write:
        replace_generated(options.write, text)
    else:
        print(text)


def scored(job: Job) -> Scored:
    """What is found in one scene."""
    light, shape, seed = job
    random = np.random.default_rng([zlib.crc32(f"unknown {shape}".encode()), seed])
    for _ in range(_SCENE_TRIES):
        try:
            scene, centre_m, reach_m = _staged(random, shape, light)
            break
        except NoRoomError:
            continue
    else:
        raise RuntimeError(f"{shape} {seed}: the parts find no room")
    frame, truth = scene.taken()
    poses = Pipeline(scene.rig, steps({})).run(frame).poses
    of_part = _held_against(poses, centre_m, reach_m)
    known_m = truth.centres_m[len(truth.centres_m) - _PARTS[light].known :]
    apart_m = np.linalg.norm(poses.xyz[:, None] - known_m, axis=2)
    found = int((apart_m.min(axis=0, initial=np.inf) < WRONG_M).sum())
    return Scored(shape, *of_part, len(known_m), found)


def _staged(random: Random, shape: str, light: str) -> tuple[Staged, Floats, float]:
    """A scene, and where in the left frame the part of that shape is, and how far it reaches from there."""
    albedo, known = _PARTS[light]
    rig_name, table = table_of(random, (32, 85))
    part = _SHAPES[shape](random, float(random.uniform(*albedo)))
    bound = table.add(part.bound, _GAP_PX)
    for kind in random.permutation(np.arange(len(MIXED)))[:known]:
        table.add(MIXED[kind](random, float(random.uniform(*albedo))), _GAP_PX)
    table.parts[:1] = part.placed(bound.x_m, bound.y_m)
    centre_m = table.left_T_table.apply(part.centre_m + (bound.x_m, bound.y_m, 0.0))
    of_scene = {"table_albedo": float(random.uniform(*_PAPER))} if light == "dark" else {}
    return (
        workshop(random, rig_name, table, **of_scene),
        centre_m,
        float(np.hypot(bound.size_m[0], bound.size_m[2])) / 2,
    )


def _held_against(poses: ObjectPoses, centre_m: Floats, reach_m: float) -> tuple[tuple[float, ...], ...]:
    off = poses.xyz - centre_m
    away_m = np.linalg.norm(off, axis=1)
    near = away_m < reach_m + _NEAR_M
    surprise = [each @ np.linalg.solve(spread, each) for each, spread in zip(off[near], poses.covariance[near])]
    return tuple(away_m[near].tolist()), tuple(float(one) for one in surprise), tuple(poses.confidence[near].tolist())


def _report(jobs: Sequence[Job], scores: Sequence[Scored]) -> str:
    shapes = list(dict.fromkeys(one.shape for one in scores))
    described = [(shape, (_SHAPES[shape].__doc__ or "").strip()) for shape in shapes]
    tables = [markdown_table(("shape", "what it is"), described, words=True)]
    for light in dict.fromkeys(light for light, _, _ in jobs):
        of_light = [one for job, one in zip(jobs, scores) if job[0] == light]
        tables += [_TITLES[light], _table(of_light, shapes)]
    return "\n\n".join([*tables, f"OpenCV {cv2.__version__}, NumPy {np.__version__}."])


def _table(scores: Sequence[Scored], shapes: Sequence[str]) -> str:
    rows = [_row(shape, [one for one in scores if one.shape == shape]) for shape in shapes]
    header = (
        "shape", "scenes", "refused", "poses", "off, median [mm]", "not admitted", "over 5 mm", "not admitted of these",
        "sure poses", "over 5 mm of these", "known parts found beside",
    )  # fmt: skip
    return markdown_table(header, [*rows, _row("all", scores)])


def _row(name: str, scores: Sequence[Scored]) -> list[str]:
    off_m = [off for one in scores for off in one.off_m]
    surprises = [surprise for one in scores for surprise in one.mahalanobis2]
    wrong = [surprise for off, surprise in zip(off_m, surprises) if off > WRONG_M]
    sure_m = [off for one in scores for off, confidence in zip(one.off_m, one.confidence) if confidence >= _SURE]
    return [
        name,
        str(len(scores)),
        str(sum(not one.off_m for one in scores)),
        str(len(off_m)),
        decimals(1000 * median(off_m), 1) if off_m else "–",
        *(str(count) for count in (_not_admitted(surprises), len(wrong), _not_admitted(wrong), len(sure_m))),
        str(sum(off > WRONG_M for off in sure_m)),
        f"{sum(one.found for one in scores)} of {sum(one.known for one in scores)}",
    ]


def _not_admitted(surprises: Sequence[float]) -> int:
    return sum(surprise > CHI2_3[95] for surprise in surprises)


def _options() -> argparse.Namespace:
    parser = scene_parser(__doc__, default=list(_SHAPES), families=_SHAPES)
    parser.add_argument("--parts", nargs="+", choices=list(_PARTS), default=list(_PARTS))
    return parser.parse_args()


if __name__ == "__main__":
    main()
