"""OpenCV's stereo YAML: K1 D1 K2 D2 R T, with `X_right = R X_left + T`.

OpenCV writes no distortion model. The number of coefficients tells it, but for the four of `cv2.fisheye`, which may be
those of plumb_bob: `distortion_model1` and `distortion_model2` say it of such lenses.
"""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np

from stereo_pick.core.arrays import Floats, floats
from stereo_pick.core.calibration.yaml_file import about
from stereo_pick.core.camera import Camera
from stereo_pick.core.errors import CalibrationError
from stereo_pick.core.rig import StereoRig
from stereo_pick.core.transform import Transform

_METRES_PER_UNIT = {"m": 1.0, "mm": 0.001, "cm": 0.01}
_FISHEYE = "equidistant"
_RATIONAL_LENGTHS = (8, 12, 14)


def load_opencv(path: Path) -> StereoRig:
    """Read an OpenCV stereo YAML: K1 D1 K2 D2 R T, image_width, image_height, and `unit` (m unless given).

    `distortion_model1` and `distortion_model2` (those of camera_info) are told by D1 and D2 unless given.

    Raises CalibrationError naming the file and the field.
    """
    try:  # here, because OpenCV dies of a path that is not UTF-8
        text = path.read_bytes().decode("utf-8", errors="replace")
    except OSError as error:
        raise CalibrationError(f"{path}: cannot be read: {error.strerror}") from None
    try:
        storage = cv2.FileStorage(text, cv2.FILE_STORAGE_READ | cv2.FILE_STORAGE_MEMORY)
        opened = storage.isOpened()
    except (cv2.error, SystemError):
        opened = False
    if not opened:
        raise CalibrationError(
            f"{path}: is no OpenCV YAML (which starts with %YAML:1.0); for left.yaml and right.yaml give their folder"
        )
    try:
        return about(path, lambda: _rig_from_storage(storage))
    except cv2.error as error:  # what it means stands in no message of OpenCV
        raise CalibrationError(f"{path}: is damaged or cut short: copy it again, or calibrate again") from error
    finally:
        storage.release()


def save_opencv(rig: StereoRig, path: Path) -> None:
    """Write a rig, in metres; raises OSError, which OpenCV would not where the disk is full."""
    storage = cv2.FileStorage(".yaml", cv2.FILE_STORAGE_WRITE | cv2.FILE_STORAGE_MEMORY)
    storage.write("image_width", rig.left.width_px)
    storage.write("image_height", rig.left.height_px)
    storage.write("unit", "m")
    right_T_left = rig.right_T_left
    for name, value in (
        ("K1", rig.left.K),
        ("D1", rig.left.D.reshape(1, -1)),
        ("K2", rig.right.K),
        ("D2", rig.right.D.reshape(1, -1)),
        ("R", right_T_left.rotation),
        ("T", right_T_left.translation.reshape(3, 1)),
    ):
        storage.write(name, np.array(value))
    for number, camera in enumerate((rig.left, rig.right), 1):
        if camera.distortion_model == _FISHEYE:
            storage.write(f"distortion_model{number}", _FISHEYE)
    path.write_text(storage.releaseAndGetString(), encoding="utf-8")


def _rig_from_storage(storage: cv2.FileStorage) -> StereoRig:
    def matrix(name: str, *shape: int | None) -> Floats:
        node = storage.getNode(name)
        value = None if node.empty() else node.mat()
        if value is None:
            raise CalibrationError(f"matrix {name!r} is missing; needed are K1 D1 K2 D2 R T")
        if shape == (None,):
            value = value.ravel()
        return floats(name, value, *shape)

    def camera(name: str, number: int) -> Camera:
        K, D = matrix(f"K{number}", 3, 3), matrix(f"D{number}", None)
        return Camera(name, width, height, K, D, np.eye(3), np.eye(3, 4), _model(storage, number, len(D)))

    width, height = (_side_px(storage, name) for name in ("image_width", "image_height"))
    unit = _unit(storage.getNode("unit"))
    left, right = camera("left", 1), camera("right", 2)
    T = matrix("T", None) * _METRES_PER_UNIT[unit]
    return StereoRig.from_extrinsics(left, right, Transform(matrix("R", 3, 3), floats("T", T, 3)))


def _side_px(storage: cv2.FileStorage, name: str) -> int:
    node = storage.getNode(name)
    if node.empty():
        raise CalibrationError(
            f"{name} is missing: add a line '{name}: N', N being that of the images it was calibrated from, in pixels"
        )
    value = _content(node)
    if isinstance(value, str) or not value.is_integer():
        raise CalibrationError(f"{name} {value!r} must be a whole number of pixels")
    return int(value)


def _model(storage: cv2.FileStorage, number: int, coefficients: int) -> str:
    node = storage.getNode(f"distortion_model{number}")
    if not node.empty():
        return str(_content(node))
    return "rational_polynomial" if coefficients in _RATIONAL_LENGTHS else "plumb_bob"


def _content(node: cv2.FileNode) -> str | float:
    return node.real() if node.isInt() or node.isReal() else node.string()


def _unit(node: cv2.FileNode) -> str:
    if node.empty():
        return "m"
    unit = _content(node)
    if unit not in _METRES_PER_UNIT:
        raise CalibrationError(
            f"unit {unit!r} must be one of {', '.join(_METRES_PER_UNIT)}: the unit of T; without it T is in metres"
        )
    return str(unit)
