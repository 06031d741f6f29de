"""Hand-eye calibration from points that the robot's tool touches and the cameras triangulate."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from stereo_pick.core.arrays import Floats, floats
from stereo_pick.core.errors import CalibrationError
from stereo_pick.core.hand_eye.reach import check_reach
from stereo_pick.core.hand_eye.result import HandEye, Residual, UncertainTransform, small_sample_factor
from stereo_pick.core.hand_eye.rotations import cross_matrix, nearest_rotation
from stereo_pick.core.transform import Transform

MIN_POINTS = 3
MIN_OFF_LINE = 0.03  # of the points' extent along their line
MAX_SCALE_ERROR = 0.1
MAX_MISFIT = 0.1  # of the points' extent
OUTLIER_MIN_POINTS = 5  # of four, any three fit well without the fourth
OUTLIER_TIMES = 3.0  # by how much the scatter falls without it: by chance once in some hundred sets of five
MIRRORED_TIMES = 3.0  # by how much worse a mirrored frame fits where points tell it from a right-handed one
EXACT_M = 1e-6  # hardly a miss


@dataclass(frozen=True, eq=False)
class TouchedPoint:
    """One point: where the tool's tip was, base_xyz (3,) [m], and where the cameras see it, camera_xyz (3,) [m]."""

    name: str
    base_xyz: Floats
    camera_xyz: Floats

    def __post_init__(self) -> None:
        for field in ("base_xyz", "camera_xyz"):
            object.__setattr__(self, field, floats(f"{self.name}: {field}", getattr(self, field), 3))


def solve_touched(points: Sequence[TouchedPoint]) -> HandEye:
    """Find `base_T_camera` by the rigid fit of three or more points (Kabsch 1976), all weighed alike.

    Raises CalibrationError, with the measured value, on fewer points, points on a line, in other units, of a
    left-handed frame, and on points that do not fit together.
    """
    base, camera = _checked(points)
    fitted = _fit(base, camera)
    misses = _misses_m(fitted, base, camera)
    extent_m, rms_m = _extent_m(base), _rms(misses)
    outliers, handed = _outliers(points, base, camera), _handed(fitted, rms_m, base, camera)
    if rms_m > MAX_MISFIT * extent_m:
        worst = points[int(misses.argmax())].name
        raise CalibrationError(
            f"the {len(points)} points do not fit together: rms {rms_m * 1000:.1f} mm on an extent of "
            f"{extent_m * 1000:.0f} mm; are they in the same order, is one frame left-handed? Worst: {worst}"
            + "".join(f"; {text}" for text in outliers)
        )
    return HandEye(
        parent="base",
        child="camera",
        found=UncertainTransform(fitted, _covariance(fitted, base, camera)),
        residuals=tuple(Residual(point.name, float(miss * 1000)) for point, miss in zip(points, misses)),
        method="touched-points, rigid fit",
        warnings=(*outliers, *handed),
    )


def _handed(fitted: Transform, rms_m: float, base: Floats, camera: Floats) -> tuple[str, ...]:
    """That a mirrored frame fits about as well, as text, as it does points in one plane; nothing if it does not.

    Raises CalibrationError where it fits clearly better.
    """
    mirrored = camera * (1, 1, -1)
    mirrored_m = _rms(_misses_m(_fit(base, mirrored), base, mirrored))
    if rms_m > MIRRORED_TIMES * max(mirrored_m, EXACT_M):
        raise CalibrationError(
            f"the points fit {rms_m * 1000:.1f} mm (rms), and {mirrored_m * 1000:.1f} mm with one frame mirrored: is "
            "one left-handed? Exchange its x and y, or change the sign of one of them"
        )
    if mirrored_m > MIRRORED_TIMES * max(rms_m, EXACT_M):
        return ()
    camera_mm, points_mm = 1000 * fitted.translation[2], 1000 * base[:, 2].mean()
    return (
        "the points lie in one plane, which fits a mirrored frame as well: by them the camera stands at z = "
        f"{camera_mm:.0f} mm of the base, and they at {points_mm:.0f} mm. If it does not, one frame is left-handed; a "
        "point touched well beside the plane would tell",
    )


def _checked(points: Sequence[TouchedPoint]) -> tuple[Floats, Floats]:
    if len(points) < MIN_POINTS:
        raise CalibrationError(f"{len(points)} touched points: at least {MIN_POINTS} are needed, 6 or more are good")
    base, camera = (np.array([getattr(point, name) for point in points]) for name in ("base_xyz", "camera_xyz"))
    ratio = _extent_m(camera) / max(_extent_m(base), 1e-12)
    if abs(ratio - 1) > MAX_SCALE_ERROR:
        raise CalibrationError(
            f"the cameras see the points {ratio:.4g} times as far apart as the robot touched them: "
            "are both in metres, and is the stereo calibration's scale right?"
        )
    for point in points:
        check_reach(f"{point.name}, as touched,", point.base_xyz, "base")
        check_reach(f"{point.name}, as seen,", point.camera_xyz, "camera")
    for who, xyz in (("touched", base), ("seen", camera)):
        along, across, _ = np.linalg.svd(xyz - xyz.mean(axis=0), compute_uv=False) / np.sqrt(len(xyz))
        if across < MIN_OFF_LINE * along:
            raise CalibrationError(
                f"the points, as {who}, lie on a line: {across * 1000:.2f} mm (rms) off it, {along * 1000:.1f} mm "
                f"along it; at least {MIN_OFF_LINE:.0%} are needed: touch a point well beside the line"
            )
    return base, camera


def _fit(base: Floats, camera: Floats) -> Transform:
    """`base_T_camera` that minimises the points' squared distances."""
    base_mean, camera_mean = base.mean(axis=0), camera.mean(axis=0)
    rotation = nearest_rotation((base - base_mean).T @ (camera - camera_mean))
    return Transform(rotation, base_mean - rotation @ camera_mean)


def _misses_m(fitted: Transform, base: Floats, camera: Floats) -> Floats:
    """How far (N,) [m] each point is from where it was touched."""
    return np.asarray(np.linalg.norm(fitted.apply(camera) - base, axis=1))


def _rms(misses_m: Floats) -> float:
    return float(np.sqrt((misses_m**2).mean()))


def _variance(fitted: Transform, base: Floats, camera: Floats) -> float:
    """Variance [m²] of one coordinate: 3 N equations less the 6 that were fitted."""
    return float(((fitted.apply(camera) - base) ** 2).sum() / (3 * len(base) - 6))


def _covariance(fitted: Transform, base: Floats, camera: Floats) -> Floats:
    jacobian = np.concatenate([np.c_[-cross_matrix(fitted.rotation @ point), np.eye(3)] for point in camera])
    variance = _variance(fitted, base, camera) * small_sample_factor(len(base))
    return np.asarray(np.linalg.inv(jacobian.T @ jacobian) * variance)


def _outliers(points: Sequence[TouchedPoint], base: Floats, camera: Floats) -> tuple[str, ...]:
    """The one point without which the others fit much better, as text; none among fewer than five."""
    if len(points) < OUTLIER_MIN_POINTS:
        return ()
    scatter_m = np.sqrt(_variance(_fit(base, camera), base, camera))
    others = [np.arange(len(points)) != i for i in range(len(points))]
    fits = [_fit(base[keep], camera[keep]) for keep in others]
    scatters_m = np.sqrt([_variance(fit, base[keep], camera[keep]) for fit, keep in zip(fits, others)])
    i = int(scatters_m.argmin())
    if scatter_m <= max(OUTLIER_TIMES * scatters_m[i], 1e-9):
        return ()
    miss_mm = float(np.linalg.norm(fits[i].apply(camera[i]) - base[i])) * 1000
    return (
        f"{points[i].name} is {miss_mm:.1f} mm from where the other points have it, which scatter by "
        f"{scatters_m[i] * 1000:.2f} mm: touch it again or leave it out",
    )


def _extent_m(xyz: Floats) -> float:
    """Rms distance [m] of the points from their centroid, both ways."""
    return float(2 * np.sqrt(((xyz - xyz.mean(axis=0)) ** 2).sum(axis=1).mean()))
