"""Calibration files: ROS camera_info YAML (one a camera) and OpenCV stereo YAML (`opencv_file.py`).

`left.yaml` and `right.yaml` are what camera_info_manager reads and writes; `stereo.yaml` is OpenCV's.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from stereo_pick.core.arrays import Floats, floats
from stereo_pick.core.calibration.opencv_file import load_opencv, save_opencv
from stereo_pick.core.calibration.yaml_file import about, read_yaml
from stereo_pick.core.camera import Camera
from stereo_pick.core.drafts import renewed
from stereo_pick.core.errors import ArrayError, CalibrationError
from stereo_pick.core.rig import StereoRig

_OPENCV_NAMES = ("stereo.yaml", "stereo.yml", "opencv.yaml", "opencv.yml")


def load_rig(path: Path) -> StereoRig:
    """Read a rig from a folder (left.yaml and right.yaml, or stereo.yaml) or from an OpenCV YAML file.

    Raises CalibrationError, naming the file and the value, on anything that is missing or wrong.
    """
    files = rig_files(path)
    if len(files) == 1:
        return load_opencv(files[0])
    cameras = tuple(map(load_camera_info, files))
    return about(path, lambda: StereoRig.from_cameras(*cameras))


def rig_files(path: Path) -> list[Path]:
    """The files of a rig: left.yaml and right.yaml, or an OpenCV one; raises CalibrationError where there are none."""
    if path.is_file():
        return [path]
    if not path.is_dir():
        raise CalibrationError(f"{path}: no such calibration folder or file")
    sides = [path / "left.yaml", path / "right.yaml"]
    if all(side.is_file() for side in sides):
        return sides
    for name in _OPENCV_NAMES:
        if (path / name).is_file():
            return [path / name]
    have = ", ".join(sorted(file.name for file in path.iterdir()))
    raise CalibrationError(
        f"{path} holds neither left.yaml and right.yaml nor stereo.yaml, " + (f"but {have}" if have else "it is empty")
    )


def load_cameras(path: Path) -> tuple[Camera, Camera]:
    """The two cameras of what `load_rig` reads, with R and P as they stand in left.yaml and right.yaml."""
    rig, files = load_rig(path), rig_files(path)
    if len(files) == 1:
        return rig.left, rig.right
    return load_camera_info(files[0]), load_camera_info(files[1])


def load_camera_info(path: Path) -> Camera:
    """Read one camera from a camera_info YAML; raises CalibrationError naming the file and the field."""
    data = read_yaml(path)
    if not isinstance(data, Mapping):
        raise CalibrationError(f"{path}: is no camera_info YAML")
    return about(path, lambda: camera_from_mapping(data))


def camera_from_mapping(data: Mapping[str, Any]) -> Camera:
    """A camera from the content of a camera_info YAML."""

    def entry(name: str) -> Any:
        if name not in data:
            raise CalibrationError(f"field {name!r} is missing")
        return data[name]

    def matrix(name: str, rows: int, cols: int | None) -> Floats:
        value = entry(name)
        if not isinstance(value, Mapping) or "data" not in value:
            raise CalibrationError(f"field {name!r} has no 'data'")
        try:
            flat = np.asarray(value["data"], np.float64).ravel()
            return floats(name, flat.reshape(rows, cols or -1), rows, cols)
        except ArrayError:
            raise
        except (TypeError, ValueError):
            raise CalibrationError(
                f"field {name!r} must hold {rows} x {cols or 'n'} numbers, holds {value['data']}"
            ) from None

    if data.get("unit", "m") != "m":
        raise CalibrationError(
            f"unit {data['unit']!r}: a camera_info counts in metres (REP 104): make the right camera's P[0,3] -fx "
            "times the baseline in metres, and leave the unit out"
        )
    try:
        width, height = int(entry("image_width")), int(entry("image_height"))
    except (TypeError, ValueError, OverflowError):
        raise CalibrationError("image_width and image_height must be whole numbers") from None
    return Camera(
        name=str(data.get("camera_name", "camera")),
        width_px=width,
        height_px=height,
        K=matrix("camera_matrix", 3, 3),
        D=matrix("distortion_coefficients", 1, None)[0],
        R=matrix("rectification_matrix", 3, 3),
        P=matrix("projection_matrix", 3, 4),
        distortion_model=str(data.get("distortion_model", "plumb_bob")),
    )


def camera_to_mapping(camera: Camera) -> dict[str, Any]:
    """The content of a camera_info YAML, in camera_info_manager's order."""

    def matrix(value: Floats) -> dict[str, Any]:
        rows, cols = np.atleast_2d(value).shape
        return {"rows": rows, "cols": cols, "data": [float(v) for v in value.ravel()]}

    return {
        "image_width": camera.width_px,
        "image_height": camera.height_px,
        "camera_name": camera.name,
        "camera_matrix": matrix(camera.K),
        "distortion_model": camera.distortion_model,
        "distortion_coefficients": matrix(camera.D),
        "rectification_matrix": matrix(camera.R),
        "projection_matrix": matrix(camera.P),
    }


def save_rig(rig: StereoRig, folder: Path) -> list[Path]:
    """Write left.yaml, right.yaml (camera_info) and stereo.yaml (OpenCV, metres) into `folder`."""
    folder.mkdir(parents=True, exist_ok=True)
    paths = []
    for side, camera in (("left", rig.left), ("right", rig.right)):
        path = folder / f"{side}.yaml"
        path.write_text(_camera_info_text(camera))
        paths.append(path)
    paths.append(folder / "stereo.yaml")
    save_opencv(rig, paths[-1])
    return paths


def save_cameras(pair: Mapping[str, Camera], folder: Path, sides: Iterable[str] = ("left", "right")) -> None:
    """Write `left.yaml` and `right.yaml` (those of `sides`) as the cameras are, and a stereo.yaml that is there anew.

    Each file is the old one or the new one at any moment. Raises CalibrationError where they cannot be written.
    """
    try:
        with renewed(folder) as draft:
            for side in sides:
                (draft / f"{side}.yaml").write_text(_camera_info_text(pair[side]))
            if (folder / "stereo.yaml").is_file():
                save_opencv(StereoRig.from_cameras(pair["left"], pair["right"]), draft / "stereo.yaml")
    except OSError as error:
        raise CalibrationError(f"{folder} cannot be written: {error.strerror}") from None


def _camera_info_text(camera: Camera) -> str:
    return yaml.safe_dump(camera_to_mapping(camera), sort_keys=False, default_flow_style=None, width=200)
