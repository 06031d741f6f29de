"""Views of a board as a rig's cameras would show it, with a corner detector's noise: a calibration without cameras."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import islice

import numpy as np
from rendering.rigs import rotation

from stereo_pick.core.arrays import Floats
from stereo_pick.core.calibration.boards import Chessboard
from stereo_pick.core.calibration.views import BoardView
from stereo_pick.core.camera import Camera
from stereo_pick.core.rig import StereoRig

BOARD = Chessboard(9, 6, 0.029)
_TILT_RAD, _ROLL_RAD = np.deg2rad((45.0, 25.0))
_NEAR_AND_FAR = (0.75, 1.25)
_MARGIN_PX = 8.0  # a detector needs the rim around the corners


def board_views(rig: StereoRig, distance_m: float, count: int, noise_px: float, seed: int) -> list[BoardView]:
    """Views as docs/calibration.md asks for: tilted to all sides, near and far, and in all parts of the image.

    distance_m: of the work, from the left camera; noise_px: sigma of each coordinate of each corner.
    """
    random = np.random.default_rng(seed)
    seen = islice(_whole(rig, distance_m, random), count)
    return [
        BoardView(f"view{number}", *(pixels + random.normal(0, noise_px, pixels.shape) for pixels in pair))
        for number, pair in enumerate(seen)
    ]


def _whole(rig: StereoRig, distance_m: float, random: np.random.Generator) -> Iterator[tuple[Floats, Floats]]:
    """Exact corners (N, 2) in both raw images, of boards that both show whole."""
    flat = BOARD.object_points() - BOARD.object_points().mean(axis=0)
    while True:
        turn = rotation((*random.uniform(-_TILT_RAD, _TILT_RAD, 2), 0)) @ rotation(
            (0, 0, random.uniform(-_ROLL_RAD, _ROLL_RAD))
        )
        ray = np.append(rig.left.normalized(random.uniform((0, 0), rig.left.frame_size))[0], 1.0)
        centre = ray * distance_m * random.uniform(*_NEAR_AND_FAR)
        left_px, right_px = rig.project(flat @ turn.T + centre)
        if _shows(rig.left, left_px) and _shows(rig.right, right_px):
            yield left_px, right_px


def _shows(camera: Camera, corners_px: Floats) -> bool:
    return bool((corners_px > _MARGIN_PX).all() and (corners_px < np.array(camera.frame_size) - _MARGIN_PX).all())
