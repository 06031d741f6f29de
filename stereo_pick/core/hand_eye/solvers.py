"""OpenCV's closed-form solvers of `A X B = Y`: which of them does best depends on the pairs."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial
from typing import Any

import cv2
import numpy as np
from numpy.typing import ArrayLike

from stereo_pick.core.arrays import Floats, floats
from stereo_pick.core.errors import ArrayError
from stereo_pick.core.hand_eye.refinement import Poses
from stereo_pick.core.hand_eye.rotations import nearest_rotation
from stereo_pick.core.transform import Transform

Solver = Callable[[Poses, Poses], Transform | None]


def _hand_eye(method: int, A: Poses, B: Poses) -> Transform | None:
    """X by `A_i X B_i = A_j X B_j`; None where the method fails."""
    try:
        with _quiet():
            return _transform(*cv2.calibrateHandEye(*_parts(A), *_parts(B), method=method))
    except (cv2.error, ArrayError):
        return None


def _robot_world(method: int, A: Poses, B: Poses) -> Transform | None:
    """X by `A_i X B_i = Y`, X and Y together; None where the method fails."""
    inverse = [pose.inverse() for pose in A]
    try:
        _, _, rotation, translation = cv2.calibrateRobotWorldHandEye(*_parts(B), *_parts(inverse), method=method)
        return _transform(rotation, translation).inverse()
    except (cv2.error, ArrayError):
        return None


SOLVERS: dict[str, Solver] = {
    "Tsai": partial(_hand_eye, cv2.CALIB_HAND_EYE_TSAI),
    "Park": partial(_hand_eye, cv2.CALIB_HAND_EYE_PARK),
    "Horaud": partial(_hand_eye, cv2.CALIB_HAND_EYE_HORAUD),
    "Andreff": partial(_hand_eye, cv2.CALIB_HAND_EYE_ANDREFF),
    "Daniilidis": partial(_hand_eye, cv2.CALIB_HAND_EYE_DANIILIDIS),
    "Shah": partial(_robot_world, cv2.CALIB_ROBOT_WORLD_HAND_EYE_SHAH),
    "Li": partial(_robot_world, cv2.CALIB_ROBOT_WORLD_HAND_EYE_LI),
}


@contextmanager
def _quiet() -> Iterator[None]:
    """Keeps OpenCV's own log off the terminal: a solver that fails is only one of several."""
    log: Any = cv2 if hasattr(cv2, "setLogLevel") else cv2.utils.logging  # 4.6 and 4.14 have it in different places
    before = log.getLogLevel()
    log.setLogLevel(0)
    try:
        yield
    finally:
        log.setLogLevel(before)


def _parts(poses: Poses) -> tuple[list[Floats], list[Floats]]:
    return [np.array(pose.rotation) for pose in poses], [np.array(pose.translation) for pose in poses]


def _transform(rotation: ArrayLike, translation: ArrayLike) -> Transform:
    return Transform(
        nearest_rotation(floats("rotation", rotation, 3, 3)), floats("translation", np.ravel(translation), 3)
    )
