"""Rigid transforms between frames."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from stereo_pick.core.arrays import Floats, floats
from stereo_pick.core.errors import ArrayError

_MOST_SKEW = 0.001  # files hold rounded numbers


@dataclass(frozen=True, eq=False)
class Transform:
    """`a_T_b`: takes points from frame b to frame a, `X_a = rotation @ X_b + translation`.

    rotation: (3, 3), orthonormal with determinant +1; translation: (3,) [m].
    Raises ArrayError where the rotation is none.
    """

    rotation: Floats
    translation: Floats

    def __post_init__(self) -> None:
        rotation = floats("rotation", self.rotation, 3, 3)
        check_rotation("rotation", rotation)
        object.__setattr__(self, "rotation", rotation)
        object.__setattr__(self, "translation", floats("translation", self.translation, 3))

    @staticmethod
    def identity() -> Transform:
        """The transform that changes nothing."""
        return Transform(np.eye(3), np.zeros(3))

    def __matmul__(self, other: Transform) -> Transform:
        """`a_T_b @ b_T_c` is `a_T_c`."""
        return Transform(self.rotation @ other.rotation, self.rotation @ other.translation + self.translation)

    def inverse(self) -> Transform:
        """`b_T_a` of `a_T_b`."""
        return Transform(self.rotation.T, -self.rotation.T @ self.translation)

    def apply(self, xyz: ArrayLike) -> Floats:
        """Take points (..., 3) [m] from frame b to frame a."""
        moved: Floats = np.asarray(xyz, np.float64) @ self.rotation.T + self.translation
        return moved


def check_rotation(name: str, matrix: Floats) -> None:
    """Raise ArrayError, naming the matrix (3, 3) and by how much it fails, for one that is no rotation."""
    skew, det = float(np.abs(matrix @ matrix.T - np.eye(3)).max()), float(np.linalg.det(matrix))
    if skew > _MOST_SKEW or det < 0:
        raise ArrayError(
            f"{name} is not a rotation matrix: |R R' - I| = {skew:.3g}, must be at most {_MOST_SKEW}; "
            f"det = {det:.3g}, must be 1"
        )
