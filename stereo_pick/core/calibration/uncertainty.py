"""How sure a calibration is: of each of its numbers, and of the points that are triangulated with it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from stereo_pick.core.arrays import Floats, floats
from stereo_pick.core.calibration.parameters import COUNT, NAMES, cameras_of
from stereo_pick.core.camera import Camera
from stereo_pick.core.errors import CalibrationError
from stereo_pick.core.rays import closest_points

_STEP_SIGMAS = 0.1
_MAX_ASYMMETRY = 1e-6


@dataclass(frozen=True, eq=False)
class CalibrationUncertainty:
    """A calibration's parameters (24,) and their covariance (24, 24), in the order of `parameters.NAMES`.

    size_px: width and height of the images. A parameter that was not estimated has zero variance.
    Raises ArrayError on another shape, CalibrationError where the covariance is none.
    """

    size_px: tuple[int, int]
    parameters: Floats
    covariance: Floats

    def __post_init__(self) -> None:
        object.__setattr__(self, "parameters", floats("parameters", self.parameters, COUNT))
        covariance = floats("covariance", self.covariance, COUNT, COUNT)
        object.__setattr__(self, "covariance", covariance)
        sigma = np.sqrt(np.maximum(np.diag(covariance), 0))
        scale = np.outer(sigma, sigma)
        if (np.diag(covariance) < 0).any() or (np.abs(covariance) > scale * (1 + _MAX_ASYMMETRY)).any():
            raise CalibrationError("covariance is none: a variance is negative, or a correlation larger than one")
        if (np.abs(covariance - covariance.T) > _MAX_ASYMMETRY * scale).any():
            raise CalibrationError("covariance is not symmetric")

    @property
    def sigma(self) -> Floats:
        """Standard deviation (24,) of each parameter, in its unit."""
        return np.asarray(np.sqrt(np.diag(self.covariance)))

    @property
    def sigmas(self) -> Mapping[str, float]:
        """Standard deviation of each parameter by its name, like `left.fx`."""
        return dict(zip(NAMES, self.sigma.tolist()))

    def point_covariance(self, xyz: ArrayLike) -> Floats:
        """Covariance (N, 3, 3) [m²] that the calibration alone puts on triangulated points xyz (N, 3) [m].

        To first order, by differences: the pixels stay, the parameters move. Left optical frame. The errors of
        neighbouring points are almost the same: their distance is surer than their place.
        """
        jacobian = self.point_jacobian(xyz)
        return np.asarray(jacobian @ self.covariance @ jacobian.transpose(0, 2, 1))

    def point_jacobian(self, xyz: ArrayLike) -> Floats:
        """How triangulated points xyz (N, 3) [m] move with each parameter: (N, 3, 24)."""
        points = np.asarray(xyz, np.float64).reshape(-1, 3)
        left, right, right_T_left = cameras_of(self.parameters, self.size_px)
        left_px, right_px = left.project(points), right.project(right_T_left.apply(points))
        jacobian = np.zeros((len(points), 3, COUNT))
        for i in np.flatnonzero(self.sigma):
            step = np.zeros(COUNT)
            step[i] = _STEP_SIGMAS * self.sigma[i]
            ahead, behind = (self._triangulated(left_px, right_px, sign * step) for sign in (1, -1))
            jacobian[:, :, i] = (ahead - behind) / (2 * step[i])
        return jacobian

    def _triangulated(self, left_px: Floats, right_px: Floats, step: Floats) -> Floats:
        left, right, right_T_left = cameras_of(self.parameters + step, self.size_px)
        left_rays, right_rays = _rays(left, left_px), _rays(right, right_px)
        on_left, on_right = closest_points(left_rays, right_rays, right_T_left)
        return np.asarray((on_left + on_right) / 2)


def _rays(camera: Camera, raw_px: Floats) -> Floats:
    return np.asarray(np.c_[camera.normalized(raw_px), np.ones(len(raw_px))])
