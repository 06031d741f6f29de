"""By how much a board is larger, beside the robot's own ways, than its square size has it."""

from __future__ import annotations

import numpy as np

from stereo_pick.core.arrays import Floats
from stereo_pick.core.hand_eye.refinement import Poses
from stereo_pick.core.transform import Transform


def scale_of(A: Poses, B: Poses, X: Transform) -> tuple[float, float]:
    """The factor on all translations of B with which `A X B = Y` fits best, X's rotation as it is, and its sigma, from
    what is left of the residuals then (the translations of X and Y are free).

    A wrong square size, or a robot that is out of calibration, hardly shows in the residuals, but moves X.
    """
    rotations = np.array([pose.rotation for pose in A])
    shifts_m = np.array([pose.translation for pose in B]) @ X.rotation.T
    terms = np.zeros((len(A), 3, 7))
    terms[:, :, 0] = np.einsum("nij,nj->ni", rotations, shifts_m)
    terms[:, :, 1:4] = rotations
    terms[:, :, 4:] = -np.eye(3)
    rows: Floats = terms.reshape(-1, 7)
    wanted_m = -np.concatenate([pose.translation for pose in A])
    found = np.linalg.lstsq(rows, wanted_m, rcond=None)[0]
    left_m = wanted_m - rows @ found
    variance_m2 = float(left_m @ left_m) / (len(rows) - rows.shape[1])
    return float(found[0]), float(np.sqrt(variance_m2 * np.linalg.pinv(rows.T @ rows)[0, 0]))
