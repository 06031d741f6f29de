"""`A X B = Y` over all pairs by least squares, with the weights and the covariance that the residuals themselves give.

A is the robot's pose (`stand_T_parent`), B the board's (`camera_T_board`); X (`parent_T_camera`) is wanted, Y
(`stand_T_board`) comes along.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from stereo_pick.core.arrays import Floats
from stereo_pick.core.errors import CalibrationError
from stereo_pick.core.hand_eye.rotations import cross_matrix, nearest_rotation, rotation_matrix, rotation_vector
from stereo_pick.core.transform import Transform

Poses = Sequence[Transform]
_MAX_STEPS = 50
_STEP = 1e-11  # rad and m: what is smaller is rounding
_FLOOR = 1e-9  # rad and m: weights of pairs without noise


@dataclass(frozen=True, eq=False)
class Refined:
    """X and Y where the weighted squares are least.

    covariance: (12, 12) of X's and of Y's rotation vector [rad] and translation [m]; residuals: (N, 6), rotation
    vector [rad] and translation [m] of `A X B` against Y, in A's first frame.
    """

    X: Transform
    Y: Transform
    covariance: Floats
    residuals: Floats


def refine(A: Poses, B: Poses, X: Transform, Y: Transform) -> Refined:
    """Refine X and Y by Gauss and Newton's steps; rotations and translations are weighed by their own variances.

    The two variances are estimated along with the parameters, each from its residuals and its share of the freedom
    (Helmert's variance components). Raises CalibrationError where the pairs leave a parameter open.
    """
    sigmas = np.maximum(np.sqrt((_residuals(A, B, X, Y).reshape(-1, 2, 3) ** 2).mean(axis=(0, 2))), _FLOOR)
    for _ in range(_MAX_STEPS):
        residuals, jacobian = _residuals(A, B, X, Y), _jacobian(A, B, X)
        weighted = jacobian / np.repeat(sigmas, 3)[:, None]
        normal = np.einsum("nij,nik->jk", weighted, weighted)
        try:
            covariance = np.linalg.inv(normal)
        except np.linalg.LinAlgError:
            raise CalibrationError("the pairs leave the camera's place open: turn the flange about two axes") from None
        step = -covariance @ np.einsum("nij,ni->j", weighted, residuals / np.repeat(sigmas, 3))
        X, Y = _moved(X, step[:6]), _moved(Y, step[6:])
        new = _sigmas(_residuals(A, B, X, Y), weighted, covariance)
        settled = np.allclose(new, sigmas, rtol=1e-6)
        sigmas = new
        if settled and np.abs(step).max() < _STEP:
            break
    return Refined(X, Y, covariance, _residuals(A, B, X, Y))


def mean_stand_T_board(A: Poses, B: Poses, X: Transform) -> Transform:
    """The Y that suits X: the mean of all `A X B`."""
    rotations, shifts = _boards(A, B, X)
    return Transform(nearest_rotation(rotations.mean(axis=0)), shifts.mean(axis=0))


def residual_norms(A: Poses, B: Poses, X: Transform, Y: Transform) -> Floats:
    """Angle [rad] and distance [m] (N, 2) of each `A X B` from Y."""
    return np.asarray(np.linalg.norm(_residuals(A, B, X, Y).reshape(-1, 2, 3), axis=2))


def _residuals(A: Poses, B: Poses, X: Transform, Y: Transform) -> Floats:
    rotations, shifts = _boards(A, B, X)
    return np.hstack([rotation_vector(rotations @ Y.rotation.T), shifts - Y.translation])


def _boards(A: Poses, B: Poses, X: Transform) -> tuple[Floats, Floats]:
    """Rotations (N, 3, 3) and translations (N, 3) of all `A X B`."""
    (rotation_A, shift_A), (rotation_B, shift_B) = _stacked(A), _stacked(B)
    shifts = np.einsum("nij,nj->ni", rotation_A, shift_B @ X.rotation.T + X.translation) + shift_A
    return rotation_A @ X.rotation @ rotation_B, shifts


def _stacked(poses: Poses) -> tuple[Floats, Floats]:
    return np.array([pose.rotation for pose in poses]), np.array([pose.translation for pose in poses])


def _jacobian(A: Poses, B: Poses, X: Transform) -> Floats:
    """Derivatives (N, 6, 12) of the residuals by turns and shifts of X and Y, each in its own first frame."""
    jacobian = np.zeros((len(A), 6, 12))
    for each, a, b in zip(jacobian, A, B):
        each[:3, :3] = each[3:, 3:6] = a.rotation
        each[3:, :3] = -a.rotation @ cross_matrix(X.rotation @ b.translation)
        each[:, 6:] = -np.eye(6)
    return jacobian


def _sigmas(residuals: Floats, weighted: Floats, covariance: Floats) -> Floats:
    """Standard deviations (2,) of the rotations [rad] and of the translations [m], from what was not fitted away."""
    fitted = np.einsum("nij,jk,nik->ni", weighted, covariance, weighted)
    freedom = (1 - fitted).reshape(-1, 2, 3).sum(axis=(0, 2))
    squares = (residuals.reshape(-1, 2, 3) ** 2).sum(axis=(0, 2))
    return np.asarray(np.maximum(np.sqrt(squares / np.maximum(freedom, 1e-3)), _FLOOR))


def _moved(pose: Transform, step: Floats) -> Transform:
    return Transform(nearest_rotation(rotation_matrix(step[:3]) @ pose.rotation), pose.translation + step[3:])
