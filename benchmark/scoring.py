"""What a contender found in a scene, held against the truth."""

from __future__ import annotations

import statistics
import time
from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np
from rivals import Contender
from scenes import Scene, TrueObject

from stereo_pick.core.arrays import Floats
from stereo_pick.core.depth_report import DepthError
from stereo_pick.core.frames import StereoFrame
from stereo_pick.core.matches.assignment import assign
from stereo_pick.core.poses import ObjectPoses
from stereo_pick.core.refusal import count_reasons
from stereo_pick.core.rig import StereoRig

GATE_MM = 60.0  # farthest from the truth that an estimate counts as that object, as in bench_rig's own evaluate.py
ROUNDS = 5


@dataclass(frozen=True, eq=False)
class Hit:
    """A required object that was found.

    position_mm: (3,); meant_mm: (3,), where the point that the contender means is in truth, None where it takes
    the object to be where its left view shows none; sigma_z_mm: as the pose states it.
    """

    truth: TrueObject
    position_mm: Floats
    meant_mm: Floats | None
    sigma_z_mm: float

    @property
    def error_mm(self) -> float:
        """Distance from the centre of the volume."""
        return float(np.linalg.norm(self.position_mm - self.truth.centre_mm))


@dataclass(frozen=True, eq=False)
class Score:
    """One contender in one scene."""

    contender: Contender
    scene: Scene
    hits: tuple[Hit, ...]
    ghosts: int
    refused: Counter[str]
    seconds: float

    @property
    def required(self) -> int:
        return sum(item.required for item in self.scene.objects)

    @property
    def depths(self) -> list[DepthError]:
        """The depth between every two required objects that were found."""
        return [
            DepthError(
                name=f"{first.truth.name} – {second.truth.name}",
                actual_m=(second.truth.centre_mm[2] - first.truth.centre_mm[2]) / 1000,
                calculated_m=(second.position_mm[2] - first.position_mm[2]) / 1000,
            )
            for first, second in combinations(self.hits, 2)
        ]

    @property
    def placed(self) -> list[tuple[Floats, float]]:
        """Errors (3,) against the point that the contender means, and the sigma of Z stated with each [mm]."""
        return [(hit.position_mm - hit.meant_mm, hit.sigma_z_mm) for hit in self.hits if hit.meant_mm is not None]


def score_all(rig: StereoRig, scenes: Sequence[Scene], contenders: Sequence[Contender]) -> list[Score]:
    """Let every contender locate the objects of every scene; their times are taken in turn, scene by scene."""
    for contender in contenders:
        contender.locate(scenes[0].frame)  # the first call builds maps and caches
    scores = []
    for scene in scenes:
        poses, seconds = _timed([contender.locate for contender in contenders], scene.frame)
        scores += [_score(rig, scene, *row) for row in zip(contenders, poses, seconds)]
    return scores


def _timed(
    ways: Sequence[Callable[[StereoFrame], ObjectPoses]], frame: StereoFrame
) -> tuple[list[ObjectPoses], list[float]]:
    """What each way returns, and its median CPU time over some rounds in which each has its turn."""
    poses: list[ObjectPoses] = []
    seconds: list[list[float]] = [[] for _ in ways]
    for _ in range(ROUNDS):
        poses.clear()
        for way, taken in zip(ways, seconds):
            start = time.process_time()
            poses.append(way(frame))
            taken.append(time.process_time() - start)
    return poses, [statistics.median(taken) for taken in seconds]


def _score(rig: StereoRig, scene: Scene, contender: Contender, poses: ObjectPoses, seconds: float) -> Score:
    xyz_mm = poses.xyz * 1000
    pairs = one_to_one(scene.centres_mm, xyz_mm)
    hits = []
    for which, row in pairs:
        truth = scene.objects[which]
        if not truth.required:
            continue
        hits.append(
            Hit(
                truth=truth,
                position_mm=xyz_mm[row],
                meant_mm=_meant_mm(rig, scene, contender, truth, poses.left_px[row]),
                sigma_z_mm=float(np.sqrt(poses.covariance[row, 2, 2])) * 1000,
            )
        )
    reasons = Counter(count_reasons(poses.refused))
    return Score(contender, scene, tuple(hits), len(poses) - len(pairs), reasons, seconds)


def _meant_mm(rig: StereoRig, scene: Scene, contender: Contender, truth: TrueObject, left_px: Floats) -> Floats | None:
    if contender.meant == "centre of volume":
        return truth.centre_mm
    if contender.meant == "mean of visible surface":
        return truth.visible_mm
    return scene.surface_mm(rig.left, left_px)


def one_to_one(true_mm: Floats, found_mm: Floats) -> list[tuple[int, int]]:
    """(truth, estimate) pairs within GATE_MM, as many as possible, of least total distance."""
    distance_mm = np.linalg.norm(true_mm[:, None] - found_mm[None], axis=2)
    return sorted(assign(np.where(distance_mm <= GATE_MM, distance_mm, np.inf), unmatched_cost=100 * GATE_MM))


def of(scores: Iterable[Score], contender: str, group: str = "") -> list[Score]:
    """The scores of one contender, in one group or in all."""
    return [s for s in scores if s.contender.name == contender and group in ("", s.scene.group)]
