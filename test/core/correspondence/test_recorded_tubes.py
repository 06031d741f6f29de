"""A real recording: a student lab's black tubes, taped and open, on white paper, from two cameras 26 cm apart."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from stereo_pick.core.calibration.boards import Chessboard
from stereo_pick.core.frames import StereoFrame
from stereo_pick.core.images import read_image
from stereo_pick.core.pipeline import Pipeline, Steps
from stereo_pick.core.poses import ObjectPoses

FLAT_M = 1.5e-3  # of the paper, and of the tubes' radii
REPEAT_M = 1.0e-3
SHORT_M, LONG_M, NEAR_M = 0.064, 0.070, 2e-3  # about, by other hands, and by the scale of another calibration


@pytest.fixture(scope="module")
def found(calibrated, once, shared_data: Path) -> list[ObjectPoses]:
    def poses() -> list[ObjectPoses]:
        rig = calibrated("vigir2023_puma/calib/left*", "vigir2023_puma/calib/right*", Chessboard(8, 6, 0.025)).rig
        folder = shared_data / "vigir2023_puma" / "scenes"
        scenes = [[read_image(folder / f"{side}_obj{n:02}.png") for side in ("left", "right")] for n in (1, 2, 3)]
        return [Pipeline(rig, Steps()).run(StereoFrame(*pair)).poses for pair in scenes]

    return once("recorded_tubes", poses)


def test_all_are_found(found: list[ObjectPoses]) -> None:
    assert [len(poses) for poses in found] == [4, 4, 4]


def test_they_are_cylinders_that_lie_on_one_plane(found: list[ObjectPoses]) -> None:
    """By their outlines alone they were 2.4 mm off a plane; one that touches another was seen as no solid, since its
    outline is cut off there, and soft along one side."""
    known = np.concatenate([poses.xyz[np.array(poses.kinds) == "cylinder"] for poses in found])
    assert len(known) == 12
    normal = np.linalg.svd(known - known.mean(axis=0))[2][2]
    assert ((known - known.mean(axis=0)) @ normal).std() < FLAT_M


def test_they_are_as_long_each_time(found: list[ObjectPoses]) -> None:
    lengths_m = np.concatenate([poses.size_m[np.array(poses.kinds) == "cylinder", 0] for poses in found])
    short, long = lengths_m[lengths_m < 0.065], lengths_m[lengths_m > 0.065]
    assert (len(short), len(long)) == (6, 6)
    assert np.ptp(short) < REPEAT_M and np.ptp(long) < REPEAT_M
    assert abs(short.mean() - SHORT_M) < NEAR_M and abs(long.mean() - LONG_M) < NEAR_M
