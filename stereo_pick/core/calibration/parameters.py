"""The numbers that a stereo calibration estimates, as one vector: their order, names and units."""

from __future__ import annotations

from enum import Enum

import cv2
import numpy as np
from numpy.typing import ArrayLike

from stereo_pick.core.arrays import Bools, Floats, floats
from stereo_pick.core.camera import Camera
from stereo_pick.core.transform import Transform

# fx fy cx cy k1 k2 p1 p2 k3 of left and of right, then rvec and tvec of right_T_left.
CAMERA_COUNT, COUNT = 9, 24
LEFT, RIGHT, EXTRINSICS = slice(0, 9), slice(9, 18), slice(18, 24)
ROTATION, TRANSLATION = slice(18, 21), slice(21, 24)

_OF_CAMERA = ("fx", "fy", "cx", "cy", "k1", "k2", "p1", "p2", "k3")
_AXES = ("x", "y", "z")

NAMES: tuple[str, ...] = (
    *(f"{side}.{name}" for side in ("left", "right") for name in _OF_CAMERA),
    *(f"{part}.{axis}" for part in ("rotation", "translation") for axis in _AXES),
)
UNITS: tuple[str, ...] = (*(("px",) * 4 + ("1",) * 5) * 2, *("rad",) * 3, *("m",) * 3)


class DistortionModel(Enum):
    """The distortion coefficients that are estimated (thesis eq. 3.2 and 3.3); the others are zero.

    Each model holds the one before it.
    """

    K1_K2_P1_P2 = "k1 k2 p1 p2"
    K1_K2_P1_P2_K3 = "k1 k2 p1 p2 k3"

    @property
    def coefficients(self) -> int:
        """How many coefficients a camera has."""
        return len(self.value.split())

    @property
    def free(self) -> Bools:
        """Which of the COUNT parameters are estimated: (24,)."""
        of_camera = np.arange(CAMERA_COUNT) < 4 + self.coefficients
        return np.concatenate([of_camera, of_camera, np.ones(6, np.bool_)])


USUAL, RICH = DistortionModel.K1_K2_P1_P2, DistortionModel.K1_K2_P1_P2_K3


def camera_vector(camera: Camera) -> Floats:
    """A camera's parameters (9,)."""
    return np.concatenate([camera.K[[0, 1, 0, 1], [0, 1, 2, 2]], np.resize(np.append(camera.D, np.zeros(5)), 5)])


def pose_vector(pose: Transform) -> Floats:
    """Rotation vector and translation (6,)."""
    return np.concatenate([cv2.Rodrigues(pose.rotation)[0].ravel(), pose.translation])


def rig_vector(left: Camera, right: Camera, right_T_left: Transform) -> Floats:
    """All parameters (24,)."""
    return np.concatenate([camera_vector(left), camera_vector(right), pose_vector(right_T_left)])


def camera_matrix(vector: Floats) -> Floats:
    """K (3, 3) [px] of a camera's parameters (9,)."""
    fx, fy, cx, cy = vector[:4]
    return np.array([[fx, 0, cx], [0, fy, cy], [0, 0, 1]])


def camera_of(name: str, size_px: tuple[int, int], vector: Floats) -> Camera:
    """The camera, not rectified, of its parameters (9,)."""
    return Camera(name, *size_px, camera_matrix(vector), vector[4:], np.eye(3), np.eye(3, 4))


def cameras_of(vector: Floats, size_px: tuple[int, int]) -> tuple[Camera, Camera, Transform]:
    """Left, right (not rectified) and right_T_left of all parameters (24,)."""
    pose = vector[EXTRINSICS]
    left, right = (camera_of(side, size_px, vector[of]) for side, of in (("left", LEFT), ("right", RIGHT)))
    return left, right, transform(pose[:3], pose[3:])


def transform(rvec: ArrayLike, tvec: ArrayLike) -> Transform:
    """The transform of OpenCV's rotation vector and translation."""
    rotation, _ = cv2.Rodrigues(np.asarray(rvec, np.float64))
    return Transform(floats("rotation", rotation, 3, 3), floats("translation", np.ravel(tvec), 3))
