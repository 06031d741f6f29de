"""Results of Bouguet's Camera Calibration Toolbox for Matlab, the one that the thesis used (3.4.2)."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from stereo_pick.core.arrays import Floats, floats
from stereo_pick.core.calibration.parameters import transform
from stereo_pick.core.camera import MAX_SKEW_PX, Camera
from stereo_pick.core.errors import ArrayError, CalibrationError
from stereo_pick.core.rig import MAX_BASELINE_M, MIN_BASELINE_M, StereoRig

METRES_PER_UNIT = {"mm": 0.001, "cm": 0.01, "m": 1.0}
_SAME_RAD = 1e-6
_LEAST_M = 0.01  # of the baselines of rigs that see parts in space


def rig_from_bouguet(values: Mapping[str, Any], unit: str = "mm") -> StereoRig:
    """The rig of `Calib_Results_stereo.mat`, whose variables `values` holds.

    fc, cc, kc, alpha_c of left and right: focal lengths and principal point [px] (0, 0 in the middle of the first
    pixel), k1 k2 p1 p2 k3 and skew; om, T: rotation vector [rad] and translation [unit] of `X_right = R X_left + T`.
    Raises CalibrationError, naming the variable, where one is missing or wrong, where it is the result of one
    camera, and where a skew is not zero, which neither ROS nor OpenCV has.
    """
    if "fc_left" not in values and "fc" in values:
        raise CalibrationError("is the result of one camera, which says nothing of the other: take the stereo one")
    try:
        width, height = (int(_array(values, name, 1)[0]) for name in ("nx", "ny"))
        left, right = (_camera(values, side, width, height) for side in ("left", "right"))
        om, T = _array(values, "om", 3), _array(values, "T", 3)
        _check_radians(om)
        _check_unit(float(np.linalg.norm(T)), unit)
        return StereoRig.from_extrinsics(left, right, transform(om, T * METRES_PER_UNIT[unit]))
    except ArrayError as error:
        raise CalibrationError(f"variable {error}") from None


def _camera(values: Mapping[str, Any], side: str, width: int, height: int) -> Camera:
    (fx, fy), (cx, cy) = _array(values, f"fc_{side}", 2), _array(values, f"cc_{side}", 2)
    if f"alpha_c_{side}" in values:
        _check_skew(side, float(_array(values, f"alpha_c_{side}", 1)[0]), fx / fy, height)
    K = np.array([[fx, 0, cx], [0, fy, cy], [0, 0, 1]])
    return Camera(side, width, height, K, _array(values, f"kc_{side}", 5), np.eye(3), np.eye(3, 4))


def _check_skew(side: str, alpha: float, aspect: float, height: int) -> None:
    skew_px = abs(alpha) * aspect * height / 2
    if skew_px > MAX_SKEW_PX:
        raise CalibrationError(
            f"alpha_c_{side} = {alpha:g} skews the image by {skew_px:.2f} px at its edge, and camera_info has no skew: "
            "calibrate again with est_alpha = 0"
        )


def _check_radians(om: Floats) -> None:
    turn_rad = float(np.linalg.norm(om))
    if turn_rad > np.pi + _SAME_RAD:
        raise CalibrationError(
            f"om turns by {turn_rad:g}, more than half a turn: it is a rotation vector in radians, not in degrees"
        )


def _check_unit(length: float, unit: str) -> None:
    """Raise CalibrationError, naming the units that would do, where a T of this length is no baseline in this one."""
    baseline_m = length * METRES_PER_UNIT[unit]
    if MIN_BASELINE_M <= baseline_m <= MAX_BASELINE_M:
        return
    lengths_m = {other: length * metres for other, metres in METRES_PER_UNIT.items()}
    others = [
        f"--unit {other} ({each_m * 1000:.4g} mm)"
        for other, each_m in lengths_m.items()
        if _LEAST_M <= each_m <= MAX_BASELINE_M
    ]
    if not others:
        return
    fault = f"{baseline_m:.1f} m is longer than {MAX_BASELINE_M:g} m"
    if baseline_m < MIN_BASELINE_M:
        fault = f"{baseline_m * 1000:.3f} mm is zero"
    raise CalibrationError(
        f"baseline = {fault}: T, of length {length:.4g}, is not in {unit}: give {' or '.join(others)}"
    )


def _array(values: Mapping[str, Any], name: str, size: int) -> Floats:
    if name not in values:
        raise CalibrationError(f"variable {name!r} is missing: is it the toolbox's Calib_Results_stereo.mat?")
    if np.iscomplexobj(values[name]):
        raise CalibrationError(f"variable {name!r} holds complex numbers: calibrate again")
    try:
        return floats(name, np.ravel(values[name]).astype(np.float64), size)
    except ArrayError:
        raise
    except (TypeError, ValueError):
        raise CalibrationError(f"variable {name!r} holds no {size} numbers") from None
