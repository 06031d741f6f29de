"""The file of pairs or touched points that a hand-eye calibration starts from: YAML, and so JSON too."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar

from stereo_pick.core.arrays import floats
from stereo_pick.core.calibration.yaml_file import read_yaml
from stereo_pick.core.errors import ArrayError, CalibrationError
from stereo_pick.core.hand_eye.pairs import Mount
from stereo_pick.core.hand_eye.rotations import from_quaternion
from stereo_pick.core.hand_eye.touched import TouchedPoint
from stereo_pick.core.transform import Transform

Read = TypeVar("Read")


@dataclass(frozen=True)
class RecordedPair:
    """A robot pose with an image of the board, or with the board's pose: one of the two is None."""

    name: str
    base_T_flange: Transform
    image: Path | None
    camera_T_board: Transform | None


@dataclass(frozen=True)
class RecordedPairs:
    """All pairs of one recording."""

    mount: Mount
    pairs: tuple[RecordedPair, ...]


def read_recording(path: Path) -> RecordedPairs | tuple[TouchedPoint, ...]:
    """Read pairs (`mount` and `pairs`) or touched points (`points`).

    Raises CalibrationError, naming the file and the entry, on anything that is missing, unknown or wrong.
    """
    data = read_mapping(path)

    def build() -> RecordedPairs | tuple[TouchedPoint, ...]:
        if "points" in data:
            _only(data, "points")
            return tuple(_entries(data, "points", _point))
        _only(data, "mount", "pairs")
        mounts = {mount.value: mount for mount in Mount}
        mount = _field(data, "mount")
        if mount not in mounts:
            raise CalibrationError(f"mount {mount!r} must be one of: {', '.join(mounts)}")
        return RecordedPairs(mounts[mount], tuple(_entries(data, "pairs", lambda each, name: _pair(each, name, path))))

    return about(str(path), build)


def read_mapping(path: Path) -> Mapping[str, Any]:
    """The content of a YAML file that holds names and values; raises CalibrationError naming the file."""
    data = read_yaml(path)
    if not isinstance(data, Mapping):
        raise CalibrationError(f"{path}: holds no names with values")
    return data


def read_pose(data: Mapping[str, Any], name: str) -> Transform:
    """The field `name` with its `xyz_m` and `quaternion_xyzw`."""
    pose = _field(data, name)
    if not isinstance(pose, Mapping):
        raise CalibrationError(f"{name} must hold xyz_m and quaternion_xyzw, holds {pose!r}")

    def build() -> Transform:
        _only(pose, "xyz_m", "quaternion_xyzw")
        return from_quaternion(_field(pose, "xyz_m"), _field(pose, "quaternion_xyzw"))

    return about(name, build)


def about(what: str, build: Callable[[], Read]) -> Read:
    """Call `build`, and put `what` before the message of what it raises."""
    try:
        return build()
    except (CalibrationError, ArrayError) as error:
        raise CalibrationError(f"{what}: {error}") from None
    except (TypeError, ValueError) as error:
        raise CalibrationError(f"{what}: holds something other than numbers: {error}") from None


def _pair(data: Mapping[str, Any], name: str, path: Path) -> RecordedPair:
    _only(data, "base_T_flange", "image", "camera_T_board")
    if ("image" in data) == ("camera_T_board" in data):
        raise CalibrationError("needs either image or camera_T_board")
    base_T_flange = read_pose(data, "base_T_flange")
    if "image" in data:
        return RecordedPair(str(data["image"]), base_T_flange, path.parent / str(data["image"]), None)
    return RecordedPair(name, base_T_flange, None, read_pose(data, "camera_T_board"))


def _point(data: Mapping[str, Any], name: str) -> TouchedPoint:
    _only(data, "name", "base_xyz_m", "camera_xyz_m")
    base, camera = (floats(field, _field(data, field), 3) for field in ("base_xyz_m", "camera_xyz_m"))
    return TouchedPoint(str(data.get("name", name)), base, camera)


def _entries(data: Mapping[str, Any], name: str, read: Callable[[Mapping[str, Any], str], Read]) -> Sequence[Read]:
    entries = _field(data, name)
    if not isinstance(entries, list):
        raise CalibrationError(f"{name} must be a list")
    return [_entry(each, f"{name}[{number}]", read) for number, each in enumerate(entries)]


def _entry(data: Any, name: str, read: Callable[[Mapping[str, Any], str], Read]) -> Read:
    if not isinstance(data, Mapping):
        raise CalibrationError(f"{name}: must hold names with values, holds {data!r}")
    return about(name, lambda: read(data, name))


def _field(data: Mapping[str, Any], name: str) -> Any:
    if name not in data:
        raise CalibrationError(f"{name!r} is missing; there is: {', '.join(map(str, data)) or 'nothing'}")
    return data[name]


def _only(data: Mapping[str, Any], *known: str) -> None:
    for name in data:
        if name not in known:
            raise CalibrationError(f"{name!r} is unknown; known are: {', '.join(known)}")
