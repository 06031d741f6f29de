"""One camera from one view of a known 3-D target: the 11-parameter direct linear transformation (thesis 1.5).

The model is a pinhole's: it knows no distortion. Pixels are to be undistorted ones, or the distortion goes into the
residuals.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from stereo_pick.core.arrays import Floats, floats
from stereo_pick.core.calibration.least_squares import SOLVERS, condition
from stereo_pick.core.errors import ArrayError, CalibrationError, ParameterError
from stereo_pick.core.transform import Transform

MIN_POINTS = 6
# Measured with 0.1 px of noise on 30 points: the focal length scatters by 0.2 % at a condition of 4, by 7 % at 80, and
# at 600 nothing of it is left.
MAX_CONDITION = 500.0


@dataclass(frozen=True, eq=False)
class Pinhole:
    """What a projection says of its camera (1.5.1).

    K: (3, 3) [px], with skew in K[0, 1]: the intrinsic parameters, eq. 1.30 with f per axis;
    camera_T_world: [m], x right, y down, z forward: the extrinsic ones, eq. 1.31, where `R T` is its translation.
    """

    K: Floats
    camera_T_world: Transform

    def __post_init__(self) -> None:
        object.__setattr__(self, "K", floats("K", self.K, 3, 3))

    @property
    def centre(self) -> Floats:
        """The camera's centre of projection (3,) [m] in the target's frame; the thesis's T is its negative."""
        return self.camera_T_world.inverse().translation


@dataclass(frozen=True, eq=False)
class DirectLinear:
    """A projection from the target's frame to pixels, found from points that it was given.

    projection: (3, 4), scaled so that its third row gives depths [m] with the target in front; condition: of the
    linear system; residuals_px: (N, 2) [px], projected minus seen.
    """

    projection: Floats
    condition: float
    residuals_px: Floats

    def __post_init__(self) -> None:
        object.__setattr__(self, "projection", floats("projection", self.projection, 3, 4))
        object.__setattr__(self, "residuals_px", floats("residuals_px", self.residuals_px, None, 2))

    @property
    def rms_px(self) -> float:
        """Rms distance [px] between where the points were seen and where they project to."""
        return float(np.sqrt((self.residuals_px**2).sum(axis=1).mean()))

    @property
    def parameters(self) -> Floats:
        """The thesis's g (11,): G11 .. G14, G21 .. G24, G41 .. G43 with G44 = 1 (eq. 1.25).

        Raises CalibrationError where there is no such scale: the origin lies in the camera's own plane.
        """
        scale = self.projection[2, 3]
        if abs(scale) < 1e-9 * np.abs(self.projection[2]).max():
            raise CalibrationError(
                f"the target's origin lies {scale:.2g} m in front of the camera: G44 cannot be 1; take another origin"
            )
        return np.asarray((self.projection / scale).ravel()[:11])

    def project(self, xyz: ArrayLike) -> Floats:
        """Points (N, 3) [m] in the target's frame to pixels (N, 2): eq. 1.19 and 1.20."""
        return _project(self.projection, np.asarray(xyz, np.float64))

    def split(self) -> Pinhole:
        """Split into intrinsic and extrinsic parameters: `G = P L R T` (eq. 1.27 to 1.31).

        Raises CalibrationError where no camera sees so: the image, or the target's frame, is mirrored.
        """
        determinant = float(np.linalg.det(self.projection[:, :3]))
        if determinant <= 0:
            raise CalibrationError(
                f"the projection mirrors (determinant {determinant:.3g}, must be positive): is the image mirrored, "
                "or are the target's axes left-handed?"
            )
        K, R = _rq(self.projection[:, :3])
        return Pinhole(K / K[2, 2], Transform(R, floats("translation", np.linalg.solve(K, self.projection[:, 3]), 3)))


def direct_linear(xyz: ArrayLike, seen_px: ArrayLike, solver: str = "svd") -> DirectLinear:
    """Find the 11 parameters from a target's points (N, 3) [m] and where they were seen (N, 2) [px] (eq. 1.22 to 1.26).

    solver: "svd" (1.6) or "normal_equations" (1.6.1). Both sides are moved to their centroid and scaled first
    (Hartley 1997): that brings the condition down from about 1e6, and puts the origin, for which eq. 1.21 sets
    G44 = 1, in front of the camera. Raises CalibrationError, with the measured value, on fewer than six points, on
    points (nearly) in a plane, and where one solution would put points behind the camera.
    """
    if solver not in SOLVERS:
        raise ParameterError(f"solver = {solver!r} must be one of: {', '.join(SOLVERS)}")
    points, pixels = _checked(xyz, seen_px)
    world, image = _normalisation(points), _normalisation(pixels)
    A, b = _equations(_moved(world, points), _moved(image, pixels))
    found = condition(A)
    if not found <= MAX_CONDITION:
        raise CalibrationError(_degenerate(points, found))
    g = SOLVERS[solver](A, b)
    projection = np.linalg.inv(image) @ np.append(g, 1.0).reshape(3, 4) @ world
    projection /= np.linalg.norm(projection[2, :3])
    depths = points @ projection[2, :3] + projection[2, 3]
    if depths.min() <= 0:
        raise CalibrationError(
            f"{int((depths <= 0).sum())} of {len(points)} points come out behind the camera: "
            "do the pixels belong to these points, in this order?"
        )
    return DirectLinear(projection, found, _project(projection, points) - pixels)


def _checked(xyz: ArrayLike, seen_px: ArrayLike) -> tuple[Floats, Floats]:
    try:
        points, pixels = floats("target points", xyz, None, 3), floats("pixels", seen_px, None, 2)
    except ArrayError as error:
        raise CalibrationError(str(error)) from None
    if len(points) != len(pixels):
        raise CalibrationError(f"{len(points)} target points and {len(pixels)} pixels do not pair")
    if len(points) < MIN_POINTS:
        raise CalibrationError(
            f"{len(points)} points give {2 * len(points)} equations for 11 parameters: at least {MIN_POINTS} are needed"
        )
    return points, pixels


def _normalisation(points: Floats) -> Floats:
    """The similarity (d + 1, d + 1) that puts the points' (N, d) centroid at 0 and their rms coordinate at 1."""
    dimension = points.shape[1]
    centroid = points.mean(axis=0)
    scale = 1 / max(float(np.sqrt(((points - centroid) ** 2).mean())), 1e-300)
    similarity = np.diag([*[scale] * dimension, 1.0])
    similarity[:dimension, dimension] = -scale * centroid
    return similarity


def _moved(similarity: Floats, points: Floats) -> Floats:
    return np.asarray(points @ similarity[:-1, :-1].T + similarity[:-1, -1])


def _equations(points: Floats, pixels: Floats) -> tuple[Floats, Floats]:
    """`A g = xi` (eq. 1.24): A (2 N, 11) and xi (2 N,), an x and a y row a point (eq. 1.22 and 1.23)."""
    one, zero = np.c_[points, np.ones(len(points))], np.zeros((len(points), 4))
    rows_x = np.c_[one, zero, -pixels[:, :1] * points]
    rows_y = np.c_[zero, one, -pixels[:, 1:] * points]
    return np.stack([rows_x, rows_y], axis=1).reshape(-1, 11), pixels.ravel()


def _project(projection: Floats, points: Floats) -> Floats:
    homogeneous = points @ projection[:, :3].T + projection[:, 3]
    return np.asarray(homogeneous[:, :2] / homogeneous[:, 2:])


def _rq(M: Floats) -> tuple[Floats, Floats]:
    """`M = K R` with K upper triangular, its diagonal positive, and R orthonormal."""
    q, r = np.linalg.qr(M[::-1].T)
    K, R = r.T[::-1, ::-1], q.T[::-1]
    signs = np.sign(np.diag(K))
    return K * signs, signs[:, None] * R


def _degenerate(points: Floats, found: float) -> str:
    flatness_m = float(np.linalg.svd(points - points.mean(axis=0), compute_uv=False)[-1] / np.sqrt(len(points)))
    return (
        f"the {len(points)} points do not determine 11 parameters: condition {found:.2g}, at most {MAX_CONDITION:g}; "
        f"they stand {flatness_m * 1000:.3g} mm (rms) off their common plane; take points at several depths"
    )
