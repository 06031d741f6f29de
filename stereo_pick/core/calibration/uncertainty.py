"""How sure a calibration is: of each of its numbers, and of the points that are triangulated with it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import cv2
import numpy as np
from numpy.typing import ArrayLike

from stereo_pick.core.arrays import Floats, floats
from stereo_pick.core.calibration.parameters import (
    CAMERA_COUNT,
    COUNT,
    EXTRINSICS,
    LEFT,
    NAMES,
    RIGHT,
    cameras_of,
    transform,
)
from stereo_pick.core.camera import Camera
from stereo_pick.core.errors import CalibrationError
from stereo_pick.core.rays import closest_points
from stereo_pick.core.transform import Transform

_STEP = 1e-6  # of a ray's direction, of an angle [rad] and of a length [m]
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

    @cached_property
    def cameras(self) -> tuple[Camera, Camera, Transform]:
        """Left, right (not rectified) and right_T_left."""
        return cameras_of(self.parameters, self.size_px)

    def point_covariance(self, xyz: ArrayLike) -> Floats:
        """Covariance (N, 3, 3) [m²] that the calibration alone puts on triangulated points xyz (N, 3) [m].

        To first order: the pixels stay, the parameters move. Left optical frame. The errors of neighbouring
        points are almost the same: their distance is surer than their place.
        """
        jacobian = self.point_jacobian(xyz)
        return np.asarray(jacobian @ self.covariance @ jacobian.transpose(0, 2, 1))

    def point_jacobian(self, xyz: ArrayLike) -> Floats:
        """How triangulated points xyz (N, 3) [m] move with each parameter: (N, 3, 24)."""
        points = np.asarray(xyz, np.float64).reshape(-1, 3)
        jacobian = np.zeros((len(points), 3, COUNT))
        if len(points) == 0:
            return jacobian
        left, right, right_T_left = self.cameras
        rays = _rays(points), _rays(right_T_left.apply(points))
        for side, camera, of in ((0, left, LEFT), (1, right, RIGHT)):
            by_ray = np.stack([_moved(rays, right_T_left, side, axis) for axis in (0, 1)], axis=-1)
            jacobian[:, :, of] = by_ray @ _ray_jacobian(camera, rays[side])
        pose = self.parameters[EXTRINSICS]
        for i, step in enumerate(np.eye(6) * _STEP):
            ahead, behind = (_middle(rays, transform(*np.split(pose + sign * step, 2))) for sign in (1, -1))
            jacobian[:, :, EXTRINSICS.start + i] = (ahead - behind) / (2 * _STEP)
        return jacobian


Rays = tuple[Floats, Floats]


def _rays(points: Floats) -> Floats:
    return np.asarray(points / points[:, 2:])


def _ray_jacobian(camera: Camera, rays: Floats) -> Floats:
    """How the ray (x, y, 1) of an image point that stays moves with the camera's parameters: (N, 2, 9)."""
    zero = np.zeros(3)
    _, by_all = cv2.projectPoints(rays.reshape(-1, 1, 3), zero, zero, camera.K, camera.D)
    of_pixel = by_all.reshape(len(rays), 2, -1)  # by rotation, translation, fx fy, cx cy, coefficients
    by_ray, by_camera = of_pixel[:, :, 3:5], of_pixel[:, :, 6 : 6 + CAMERA_COUNT]
    return np.asarray(-np.linalg.solve(by_ray, by_camera))


def _moved(rays: Rays, right_T_left: Transform, side: int, axis: int) -> Floats:
    """How the triangulated points (N, 3) move with one coordinate of one camera's rays."""
    step = np.zeros(3)
    step[axis] = _STEP
    ahead, behind = (
        _middle((rays[0] + sign * step, rays[1]) if side == 0 else (rays[0], rays[1] + sign * step), right_T_left)
        for sign in (1, -1)
    )
    return np.asarray((ahead - behind) / (2 * _STEP))


def _middle(rays: Rays, right_T_left: Transform) -> Floats:
    on_left, on_right = closest_points(*rays, right_T_left)
    return np.asarray((on_left + on_right) / 2)
