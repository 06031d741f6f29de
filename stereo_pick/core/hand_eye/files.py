"""The hand-eye file: one transform between two named frames, with its covariance and what speaks for it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar

import yaml

from stereo_pick.core.arrays import floats
from stereo_pick.core.calibration.fingerprint import calibration_hash
from stereo_pick.core.drafts import drafted
from stereo_pick.core.errors import CalibrationError
from stereo_pick.core.hand_eye.reach import check_reach
from stereo_pick.core.hand_eye.recording import about, read_mapping, read_pose
from stereo_pick.core.hand_eye.result import Attempt, HandEye, Residual, UncertainTransform
from stereo_pick.core.hand_eye.rotations import to_quaternion
from stereo_pick.core.rig import StereoRig

Row = TypeVar("Row")

_NOTE = "covariance: 6 x 6, rotation vector [rad] before translation [m], both in the parent frame"


@dataclass(frozen=True)
class FramedHandEye:
    """A hand-eye calibration and the names of its frames (REP 105), such as base_link and left_camera_optical_frame.

    calibration_hash: of the rig it was made with; empty where that is unknown.
    Raises CalibrationError where a name is empty or both are the same, where it is not the camera that is placed, or
    where its place is in millimetres.
    """

    hand_eye: HandEye
    parent_frame: str
    child_frame: str
    calibration_hash: str = ""

    def __post_init__(self) -> None:
        if not self.parent_frame or not self.child_frame or self.parent_frame == self.child_frame:
            raise CalibrationError(f"frames {self.parent_frame!r} and {self.child_frame!r} must be two different names")
        if self.hand_eye.child != "camera":
            raise CalibrationError(
                f"name {self.hand_eye.name}: the pose must be the camera's, as base_T_camera or flange_T_camera have "
                "it (X_base = R X_camera + t): invert it if it is the other way round"
            )
        check_reach("pose: the camera", self.hand_eye.found.transform.translation, self.hand_eye.parent)

    def check(self, rig: StereoRig) -> None:
        """Raise CalibrationError where it was made with another calibration than this rig's."""
        if self.calibration_hash not in ("", calibration_hash(rig)):
            raise CalibrationError(
                f"the hand-eye file was made with another calibration ({self.calibration_hash}) than the one in use "
                f"({calibration_hash(rig)}): make it anew with `stereo-pick hand-eye`, or take the calibration before"
            )


def save_hand_eye(framed: FramedHandEye, path: Path) -> None:
    """Write the YAML file; raises CalibrationError, naming it, where it cannot be written."""
    content = yaml.safe_dump(_to_mapping(framed), sort_keys=False, default_flow_style=None, width=120)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with drafted(path) as draft:
            draft.write_text(f"# {_NOTE}\n{content}", encoding="utf-8")
    except OSError as error:
        raise CalibrationError(f"{path} cannot be written: {error.strerror}") from None


def load_hand_eye(path: Path) -> FramedHandEye:
    """Read what `save_hand_eye` wrote; raises CalibrationError naming the file and the field."""
    data = dict(read_mapping(path))

    def build() -> FramedHandEye:
        try:
            parent, _, child = str(data["name"]).partition("_T_")
            found = UncertainTransform(read_pose(data, "pose"), floats("covariance", data["covariance"], 6, 6))
            hand_eye = HandEye(
                parent,
                child,
                found,
                _rows(data, "residuals", Residual),
                str(data["method"]),
                _rows(data, "attempts", Attempt),
                tuple(data["warnings"]),
            )
            parent_frame, child_frame = (str(data[field] or "") for field in ("parent_frame", "child_frame"))
            return FramedHandEye(hand_eye, parent_frame, child_frame, str(data.get("calibration_hash") or ""))
        except KeyError as error:
            raise CalibrationError(f"field {error} is missing: is it a file of stereo-pick hand-eye?") from None

    return about(str(path), build)


def _rows(data: dict[str, Any], field: str, kind: Callable[..., Row]) -> tuple[Row, ...]:
    try:
        return tuple(kind(**each) for each in data[field])
    except TypeError:
        raise CalibrationError(f"field '{field}' is no list of what stereo-pick hand-eye writes there") from None


def _to_mapping(framed: FramedHandEye) -> dict[str, Any]:
    hand_eye = framed.hand_eye
    transform = hand_eye.found.transform
    return {
        "name": hand_eye.name,
        "parent_frame": framed.parent_frame,
        "child_frame": framed.child_frame,
        "calibration_hash": framed.calibration_hash,
        "pose": {
            "xyz_m": transform.translation.tolist(),
            "quaternion_xyzw": to_quaternion(transform.rotation).tolist(),
        },
        "covariance": hand_eye.found.covariance.tolist(),
        "method": hand_eye.method,
        "residuals": [_without_none(vars(each)) for each in hand_eye.residuals],
        "attempts": [vars(each) for each in hand_eye.attempts],
        "warnings": list(hand_eye.warnings),
    }


def _without_none(values: dict[str, Any]) -> dict[str, Any]:
    return {name: value for name, value in values.items() if value is not None}
