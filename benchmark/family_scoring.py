"""What the pipeline found in one scene of a family, held against the truth."""

from __future__ import annotations

import time
from collections import Counter
from dataclasses import dataclass
from itertools import combinations

import numpy as np
from mahalanobis import CHI2_3
from rendering import TrueObject, Truth

from stereo_pick.core.arrays import Floats
from stereo_pick.core.frames import StereoFrame
from stereo_pick.core.matches.assignment import assign
from stereo_pick.core.pipeline import Pipeline
from stereo_pick.core.poses import ObjectPoses
from stereo_pick.core.refusal import count_reasons

GATE_M = 0.010  # a pose counts as an object within this or half the object's size
WRONG_M = 0.005


@dataclass(frozen=True, eq=False)
class Found:
    """An object that a pose counts as, and its errors.

    position_m: (3,), against the centre of the volume, in the left frame; covariance: (3, 3) [m²], as stated;
    size_m: (3,) length, width, height, and yaw_rad: None where the poses do not carry them.
    """

    which: int
    truth: TrueObject
    position_m: Floats
    covariance: Floats
    size_m: Floats | None
    yaw_rad: float | None

    @property
    def distance_m(self) -> float:
        return float(np.linalg.norm(self.position_m))

    @property
    def mahalanobis2(self) -> float:
        return float(self.position_m @ np.linalg.solve(self.covariance, self.position_m))

    @property
    def shape(self) -> str:
        return f"lying {self.truth.shape}" if self.truth.lying else self.truth.shape


@dataclass(frozen=True, eq=False)
class SceneScore:
    """One scene; ghosts_m: (N, 3), poses that are no object's, with ghost_covariances (N, 3, 3); between: how many of
    them lie between two parts.
    """

    family: str
    seed: int
    objects: tuple[TrueObject, ...]
    found: tuple[Found, ...]
    ghosts_m: Floats
    ghost_covariances: Floats
    between: int
    refused: Counter[str]
    seconds: float

    @property
    def required(self) -> int:
        return sum(each.required for each in self.objects)

    @property
    def missed(self) -> list[int]:
        """The required objects that were not found."""
        found = {each.which for each in self.found}
        return [number for number, each in enumerate(self.objects) if each.required and number not in found]

    @property
    def published(self) -> int:
        return len(self.found) + len(self.ghosts_m)

    @property
    def depths_m(self) -> list[float]:
        """Error of the depth between every two required objects that were found."""
        required = [each.position_m[2] for each in self.found if each.truth.required]
        return [abs(float(second - first)) for first, second in combinations(required, 2)]

    @property
    def distances_m(self) -> list[float]:
        """Distance of every required object that was found from where it is."""
        return [each.distance_m for each in self.found if each.truth.required]

    @property
    def covariances(self) -> Floats:
        """Of every pose that was published: (N, 3, 3) [m²], ghosts last."""
        found = np.reshape([each.covariance for each in self.found], (-1, 3, 3))
        return np.concatenate([found, self.ghost_covariances])

    @property
    def off_m(self) -> Floats:
        """How far off every pose is that was published, (N,), ghosts last; infinite where it is no object's."""
        return np.array([each.distance_m for each in self.found] + [np.inf] * len(self.ghosts_m))

    @property
    def mahalanobis2(self) -> list[float]:
        """Of every pose that was published, however wrong; infinite where no object is near that it could be."""
        return [each.mahalanobis2 for each in self.found] + [np.inf] * len(self.ghosts_m)

    @property
    def wrong(self) -> int:
        """Published and off by more than WRONG_M, ghosts among them."""
        return sum(each.distance_m > WRONG_M for each in self.found) + len(self.ghosts_m)

    @property
    def unadmitted(self) -> int:
        """Of those that are wrong, how many their covariance does not admit with 95 %; ghosts among them."""
        return sum(each.distance_m > WRONG_M and each.mahalanobis2 > CHI2_3[95] for each in self.found) + len(
            self.ghosts_m
        )

    @property
    def right(self) -> bool:
        return not self.missed and not self.wrong


def score(family: str, seed: int, pipeline: Pipeline, frame: StereoFrame, truth: Truth) -> SceneScore:
    """Run the pipeline on a scene's raw pair."""
    begin = time.process_time()
    poses = pipeline.run(frame).poses
    return held_against(truth, poses, family, seed, time.process_time() - begin)


def held_against(truth: Truth, poses: ObjectPoses, family: str, seed: int, seconds: float = 0.0) -> SceneScore:
    """What these poses, in the left frame, are worth in a scene; seconds: what it took to find them."""
    pairs = _one_to_one(truth, poses.xyz)
    ghost = np.delete(np.arange(len(poses.xyz)), [row for _, row in pairs])
    ghosts_m = poses.xyz[ghost]
    return SceneScore(
        family=family,
        seed=seed,
        objects=truth.objects,
        found=tuple(_found(truth, which, poses, row) for which, row in pairs),
        ghosts_m=ghosts_m,
        ghost_covariances=poses.covariance[ghost],
        between=sum(_is_between(point_m, truth) for point_m in ghosts_m),
        refused=Counter(count_reasons(poses.refused)),
        seconds=seconds,
    )


def _one_to_one(truth: Truth, xyz: Floats) -> list[tuple[int, int]]:
    distance = np.linalg.norm(truth.centres_m[:, None] - xyz[None], axis=2)
    gates = np.array([max(GATE_M, max(each.extent_m) / 2) for each in truth.objects]).reshape(-1, 1)
    return sorted(assign(np.where(distance <= gates, distance, np.inf), unmatched_cost=1.0))


def _found(truth: Truth, which: int, poses: ObjectPoses, row: int) -> Found:
    item = truth.objects[which]
    return Found(
        which=which,
        truth=item,
        position_m=poses.xyz[row] - item.centre_m,
        covariance=poses.covariance[row],
        size_m=_size_error(item, poses, row),
        yaw_rad=_yaw_error(truth, item, poses, row),
    )


def _size_error(item: TrueObject, poses: ObjectPoses, row: int) -> Floats | None:
    """Of length, width and height; None where the poses carry no heights."""
    if poses.size_m.shape[1] != 3:
        return None
    length, width, height = item.extent_m
    true = np.array([max(length, width), min(length, width), height])
    return np.asarray(poses.size_m[row] - true)


def _yaw_error(truth: Truth, item: TrueObject, poses: ObjectPoses, row: int) -> float | None:
    """Of the pose's x axis about the table's normal; None where the part has no yaw, or where poses have no heights.

    Poses without heights are turned about the camera's axis, not about the table's normal.
    """
    if not item.yaw_period_rad or poses.size_m.shape[1] != 3:
        return None
    x, y, z, w = poses.quaternions()[row]
    x_axis = np.array([1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w)])
    on_table = x_axis @ truth.left_T_table.rotation
    length, width, _ = item.extent_m
    true = item.yaw_rad + (np.pi / 2 if width > length else 0)
    turn = np.arctan2(on_table[1], on_table[0]) - true
    period = item.yaw_period_rad
    return float((turn + period / 2) % period - period / 2)


def _is_between(ghost: Floats, truth: Truth) -> bool:
    for one, other in combinations(truth.objects, 2):
        way = other.centre_m - one.centre_m
        share = float((ghost - one.centre_m) @ way / (way @ way))
        aside = float(np.linalg.norm(ghost - one.centre_m - share * way))
        size = (max(one.extent_m) + max(other.extent_m)) / 2
        if 0.1 < share < 0.9 and aside < size / 2 and np.linalg.norm(way) < 2 * size:
            return True
    return False
