"""calibration.yaml and hand-eye files with a given content, for tests of what reads them."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np
import yaml
from simulated_views import BOARD, SIZE_PX, make_views

from stereo_pick.core.calibration.fingerprint import calibration_hash
from stereo_pick.core.calibration.parameters import NAMES, UNITS, rig_vector
from stereo_pick.core.calibration.record import _hash, save_record
from stereo_pick.core.calibration.result import CalibrationResult
from stereo_pick.core.calibration.solving import calibrate
from stereo_pick.core.hand_eye.files import FramedHandEye, save_hand_eye
from stereo_pick.core.hand_eye.result import HandEye, UncertainTransform
from stereo_pick.core.rig import StereoRig
from stereo_pick.core.transform import Transform


@cache
def any_result() -> CalibrationResult:
    return calibrate(make_views(6, noise_px=0.1), SIZE_PX, BOARD)


def write_record(rig: StereoRig, folder: Path, focal_sigma_px: float = 1.0) -> Path:
    """A calibration.yaml of this rig, of which all is sure but the left fx."""
    path = save_record(any_result(), folder)
    data = yaml.safe_load(path.read_text())
    vector = rig_vector(rig.left, rig.right, rig.right_T_left)
    covariance = np.zeros((24, 24))
    covariance[0, 0] = focal_sigma_px**2
    sigmas = np.sqrt(np.diag(covariance)).tolist()
    data["parameters"] = {
        name: {"value": value, "sigma": sigma, "unit": unit}
        for name, value, sigma, unit in zip(NAMES, vector.tolist(), sigmas, UNITS)
    }
    data |= {"image_width": rig.left.width_px, "image_height": rig.left.height_px}
    data |= {"covariance": covariance.tolist(), "calibration_hash": calibration_hash(rig)}
    del data["hash"]
    path.write_text(yaml.safe_dump({**data, "hash": _hash(data)}))
    return path


def framed(
    base_T_camera: Transform,
    sigma_m: float = 1e-3,
    child_frame: str = "left_eye",
    calibration_hash: str = "",
    parent: str = "base",
) -> FramedHandEye:
    """A hand-eye calibration of this transform, whose translation alone is uncertain."""
    found = UncertainTransform(base_T_camera, np.diag([0, 0, 0, *[sigma_m**2] * 3]))
    hand_eye = HandEye(parent, "camera", found, (), "made for a test")
    frame = {"base": "base_link", "flange": "flange"}[parent]
    return FramedHandEye(hand_eye, frame, child_frame, calibration_hash)


def write_hand_eye(path: Path, *args: object, **values: object) -> Path:
    save_hand_eye(framed(*args, **values), path)  # type: ignore[arg-type]
    return path
