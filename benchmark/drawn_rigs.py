"""Rigs drawn at random, as integrators build them: any cameras, more or less level, more or less verged."""

from __future__ import annotations

import zlib
from dataclasses import dataclass

import numpy as np
from rendering.rigs import camera, looking_at

from stereo_pick.core.camera import Camera
from stereo_pick.core.rig import StereoRig

_SIZES_PX = ((480, 360), (640, 480), (752, 480), (1280, 720), (1280, 960), (1600, 1200), (1920, 1080), (2048, 1536))
_LENSES = ((0.0,) * 5, (-0.1, 0.05, 0.0005, -0.0003, 0.0), (-0.3, 0.12, 0.0006, -0.0004, 0.0))  # D
_DISTANCES_M = (0.45, 1.4)  # of the table
_COVERS_M = (0.55, 1.0)  # what an image is wide of it
_BASELINES = (0.07, 0.4)  # by the distance


@dataclass(frozen=True, eq=False)
class DrawnRig:
    """distances_m: the least and the greatest of the table's origin from the left camera."""

    rig: StereoRig
    distances_m: tuple[float, float]

    @property
    def width_px(self) -> int:
        return self.rig.left.width_px


def drawn_rig(family: str, seed: int) -> DrawnRig:
    """Two cameras of one make, from parallel to looking at one place, focal lengths up to 3 % apart; the right one is
    rolled, raised and put forward or back a little."""
    random = np.random.default_rng([zlib.crc32(family.encode()), seed, 1])
    size_px, D = _SIZES_PX[random.integers(len(_SIZES_PX))], _LENSES[random.integers(len(_LENSES))]
    distance_m = float(random.uniform(*_DISTANCES_M))
    focal_px = size_px[0] * distance_m / random.uniform(*_COVERS_M)
    left = _camera("left", focal_px, size_px, D, random)
    right = _camera("right", focal_px * random.uniform(0.97, 1.03), size_px, D, random)
    baseline_m = distance_m * random.uniform(*_BASELINES)
    verged = random.uniform(0, 1)
    target_m = (baseline_m * (1 - verged / 2), random.uniform(-0.01, 0.01), distance_m)
    centre_m = (baseline_m, baseline_m * random.uniform(-0.02, 0.02), baseline_m * random.uniform(-0.1, 0.1))
    right_T_left = looking_at(centre_m, target_m, random.uniform(-3, 3))
    return DrawnRig(StereoRig.from_extrinsics(left, right, right_T_left), (0.97 * distance_m, 1.03 * distance_m))


def _camera(
    name: str, focal_px: float, size_px: tuple[int, int], D: tuple[float, ...], random: np.random.Generator
) -> Camera:
    width, height = size_px
    centre_px = (
        width / 2 - 0.5 + 0.02 * width * random.uniform(-1, 1),
        height / 2 - 0.5 + 0.02 * width * random.uniform(-1, 1),
    )
    return camera(name, (focal_px, focal_px * random.uniform(0.998, 1.002)), centre_px, D, size_px=size_px)
