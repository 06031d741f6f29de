"""Rigid transforms between frames."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from stereo_pick.core.arrays import Floats, floats
from stereo_pick.core.errors import ArrayError


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
        error = float(np.abs(rotation @ rotation.T - np.eye(3)).max())
        if error > 1e-3 or np.linalg.det(rotation) < 0:
            raise ArrayError(
                f"rotation is not a rotation matrix: |R R' - I| = {error:.2g}, det = {np.linalg.det(rotation):.3f}"
            )
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
