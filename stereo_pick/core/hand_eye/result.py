"""What a hand-eye calibration found, and how far it is to be trusted."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from stereo_pick.core.arrays import Floats, floats
from stereo_pick.core.errors import ArrayError
from stereo_pick.core.hand_eye.rotations import cross_matrix
from stereo_pick.core.transform import Transform

_ROUNDED = 1e-4  # of correlations: files may hold few digits


@dataclass(frozen=True, eq=False)
class UncertainTransform:
    """`a_T_b` and its covariance (6, 6): rotation vector [rad], then translation [m].

    The true rotation is `exp(w) R` and the true translation `t + d` with (w, d) so distributed, both in frame a.
    Raises ArrayError where the matrix is no covariance.
    """

    transform: Transform
    covariance: Floats

    def __post_init__(self) -> None:
        covariance = floats("covariance", self.covariance, 6, 6)
        scale = float(np.abs(covariance).max())
        if np.abs(covariance - covariance.T).max() > 1e-6 * scale:
            raise ArrayError("covariance is not symmetric")
        if np.diag(covariance).min() < 0:
            raise ArrayError(f"covariance has the negative variance {np.diag(covariance).min():.3g}")
        if _least_eigenvalue(covariance) < -_ROUNDED:
            raise ArrayError("covariance is none: its covariances are larger than its variances allow")
        object.__setattr__(self, "covariance", covariance)

    @property
    def sigma_deg(self) -> Floats:
        """Standard deviations (3,) [deg] of the rotation about the axes of frame a."""
        return np.degrees(np.sqrt(np.diag(self.covariance)[:3]))

    @property
    def sigma_mm(self) -> Floats:
        """Standard deviations (3,) [mm] of the translation along the axes of frame a."""
        return np.asarray(np.sqrt(np.diag(self.covariance)[3:]) * 1000)

    def point_covariance(self, xyz: ArrayLike) -> Floats:
        """Covariance (N, 3, 3) [m²] in frame a that the transform adds to points (N, 3) [m] of frame b."""
        arms = np.asarray(xyz, np.float64) @ self.transform.rotation.T
        jacobian = np.array([np.c_[-cross_matrix(arm), np.eye(3)] for arm in arms]).reshape(-1, 3, 6)
        return np.asarray(jacobian @ self.covariance @ jacobian.transpose(0, 2, 1))


def _least_eigenvalue(covariance: Floats) -> float:
    """Of the correlations (6, 6): variances of angles and of places are of different sizes."""
    variance = np.diag(covariance)
    sigma = np.sqrt(np.where(variance > 0, variance, 1.0))
    return float(np.linalg.eigvalsh(covariance / np.outer(sigma, sigma)).min())


def small_sample_factor(count: int) -> float:
    """By how much a covariance grows for a scatter that was itself estimated, from `count` pairs or points.

    The truth is then spread as Student's t is: the variance of 3 N - 6 degrees of freedom, f / (f - 2).
    """
    freedom = 3 * count - 6
    return freedom / (freedom - 2)


@dataclass(frozen=True)
class Residual:
    """By how much one pair or one touched point misses the result; a point has no rotation."""

    name: str
    translation_mm: float
    rotation_deg: float | None = None


@dataclass(frozen=True)
class Attempt:
    """What one solver reached: rms residuals over all pairs."""

    solver: str
    translation_mm: float
    rotation_deg: float

    def __str__(self) -> str:
        return f"{self.solver} {self.translation_mm:.3f} mm {self.rotation_deg:.4f} deg"


@dataclass(frozen=True)
class HandEye:
    """`parent_T_child` with its uncertainty, and what speaks for it.

    attempts: the solvers that were compared, the best first; warnings: what to measure again, or more of, and why.
    """

    parent: str
    child: str
    found: UncertainTransform
    residuals: tuple[Residual, ...]
    method: str
    attempts: tuple[Attempt, ...] = ()
    warnings: tuple[str, ...] = ()

    @property
    def name(self) -> str:
        """Such as base_T_camera."""
        return f"{self.parent}_T_{self.child}"

    @property
    def rms_mm(self) -> float:
        """Rms of the residuals [mm]."""
        return math.sqrt(sum(residual.translation_mm**2 for residual in self.residuals) / len(self.residuals))

    @property
    def rms_deg(self) -> float | None:
        """Rms of the rotations' residuals [deg]; None where points alone were given."""
        angles = [residual.rotation_deg for residual in self.residuals if residual.rotation_deg is not None]
        return math.sqrt(sum(angle**2 for angle in angles) / len(angles)) if angles else None
