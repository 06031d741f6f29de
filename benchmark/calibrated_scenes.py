"""Scenes of the true rig, located with calibrations of it that were made from simulated views of a board."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import NamedTuple

import numpy as np
from board_views import BOARD, board_views
from family_cache import taken
from family_scoring import SceneScore, held_against
from rendering.rigs import BENCH_RIGS, DISTANCES_M

from stereo_pick.core.calibration.record import CalibrationRecord
from stereo_pick.core.calibration.result import CalibrationResult
from stereo_pick.core.calibration.solving import calibrate
from stereo_pick.core.calibration.verdict import judge
from stereo_pick.core.pipeline import Pipeline, Steps
from stereo_pick.core.positioning import Positioning

VIEWS, NOISE_PX = 16, 0.1


class Outcome(NamedTuple):
    """One scene with one calibration: with the covariance of the image alone, and with the calibration's added."""

    rig_name: str
    calibration: int | None
    image: SceneScore
    whole: SceneScore

    @property
    def result(self) -> CalibrationResult:
        """Of a calibration of its own."""
        return own(self.rig_name, self.calibration or 0)


def outcome(family: str, seed: int, folder: Path | None, calibration: int | None) -> Outcome:
    """What becomes of a scene of the true rig; calibration: the number of the one in use, None for the true one."""
    rig_name, frame, truth = _taken(family, seed, folder)
    pipeline, positioning = _pipeline(rig_name, calibration)
    poses = pipeline.run(frame).poses
    image, whole = (held_against(truth, each, family, seed) for each in (poses, positioning.place(poses, pipeline.rig)))
    return Outcome(rig_name, calibration, image, whole)


_taken = cache(taken)


@cache
def own(rig_name: str, number: int) -> CalibrationResult:
    """One calibration of a rig, as `stereo-pick calibrate` makes it of these corners."""
    rig = BENCH_RIGS[rig_name]
    views = board_views(rig, float(np.mean(DISTANCES_M[rig_name])), VIEWS, NOISE_PX, number)
    return calibrate(views, rig.left.frame_size, BOARD)


@cache
def _pipeline(rig_name: str, number: int | None) -> tuple[Pipeline, Positioning]:
    if number is None:
        return Pipeline(BENCH_RIGS[rig_name], Steps()), Positioning()
    result = own(rig_name, number)
    return Pipeline(result.rig, Steps()), Positioning(CalibrationRecord(result.uncertainty, judge(result), ""))
