"""A short hash of a rig, by which nodes and files tell whether they speak of the same calibration."""

from __future__ import annotations

import hashlib
import math
from functools import lru_cache

import numpy as np

from stereo_pick.core.camera import Camera
from stereo_pick.core.rig import StereoRig

_DIGITS = 12
_GRID = 1e-7 * math.sqrt(2)  # an irrational grid: no number that a person writes lies between two of its cells


@lru_cache(maxsize=8)
def calibration_hash(rig: StereoRig) -> str:
    """SHA-256 of the raw cameras and of how they stand, its first 12 hexadecimal digits.

    R and P are not in it: camera_info and camera_info_rect of one rig differ in them, and have one hash.
    """
    pose = rig.right_T_left
    stands = np.round(np.append(pose.rotation, pose.translation) / _GRID).astype(np.int64).tolist()
    text = repr((_raw(rig.left), _raw(rig.right), stands))
    return hashlib.sha256(text.encode()).hexdigest()[:_DIGITS]


def _raw(camera: Camera) -> tuple[object, ...]:
    """A camera without its rectification; coefficients of zero at the end say nothing."""
    D = np.trim_zeros(camera.D, "b")
    return (camera.frame_size, camera.distortion_model, (camera.K + 0.0).tolist(), (D + 0.0).tolist())
