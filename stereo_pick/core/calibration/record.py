"""One file with everything that a calibration says: `calibration.yaml`.

It stands beside left.yaml and right.yaml, which hold what every ROS node reads; this one holds in addition how sure
each number is, on what evidence, and a hash of its content by which a result can be traced to its calibration.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from stereo_pick.core.calibration.fingerprint import calibration_hash
from stereo_pick.core.calibration.parameters import NAMES, UNITS
from stereo_pick.core.calibration.result import CalibrationResult
from stereo_pick.core.calibration.uncertainty import CalibrationUncertainty
from stereo_pick.core.calibration.verdict import Verdict, Word, judge
from stereo_pick.core.calibration.yaml_file import read_yaml
from stereo_pick.core.errors import ArrayError, CalibrationError
from stereo_pick.core.rig import StereoRig

FILE_NAME = "calibration.yaml"
_FORMAT = "stereo_pick calibration 1"


@dataclass(frozen=True, eq=False)
class CalibrationRecord:
    """What a node needs of a calibration.yaml: the uncertainty, the verdict and the content's hash (SHA-256, hex)."""

    uncertainty: CalibrationUncertainty
    verdict: Verdict
    hash: str

    @cached_property
    def calibration_hash(self) -> str:
        """The hash of the rig: that of the camera_info which were written beside this file."""
        return calibration_hash(StereoRig.from_extrinsics(*self.uncertainty.cameras))

    def check(self, rig: StereoRig, path: Path) -> None:
        """Raise CalibrationError, naming the file at `path`, where this is the record of another calibration."""
        if self.calibration_hash != calibration_hash(rig):
            raise CalibrationError(
                f"{path} is of another calibration ({self.calibration_hash}) than the camera_info in use "
                f"({calibration_hash(rig)}): take both from one `stereo-pick calibrate`"
            )


def save_record(result: CalibrationResult, folder: Path) -> Path:
    """Write calibration.yaml into `folder`; returns its path."""
    content = _content(result)
    path = folder / FILE_NAME
    text = yaml.safe_dump({**content, "hash": _hash(content)}, sort_keys=False, default_flow_style=None, width=200)
    path.write_text(text, encoding="utf-8")
    return path


def load_record(path: Path) -> CalibrationRecord:
    """Read a calibration.yaml, or that of a folder.

    Raises CalibrationError, naming the file, where it is missing, incomplete or was changed after it was written.
    """
    path = path / FILE_NAME if path.is_dir() else path
    data = read_yaml(path)
    if not isinstance(data, dict) or data.get("format") != _FORMAT:
        raise CalibrationError(f"{path}: is no {_FORMAT!r}; write one with `stereo-pick calibrate`")
    stated = data.pop("hash", None)
    if stated != _hash(data):
        raise CalibrationError(f"{path}: was changed after it was written: its hash does not fit; calibrate again")
    try:
        return CalibrationRecord(_uncertainty(data), _verdict(data), stated)
    except (ArrayError, CalibrationError) as error:
        raise CalibrationError(f"{path}: {error}") from None
    except (KeyError, TypeError, ValueError) as error:
        raise CalibrationError(f"{path}: is incomplete: {error}") from None


def record_of(path: Path, rig: StereoRig) -> CalibrationRecord:
    """Read the calibration.yaml that belongs to a rig.

    Raises CalibrationError as `load_record` does, and where the file is of another calibration.
    """
    record = load_record(path)
    record.check(rig, path)
    return record


def _content(result: CalibrationResult) -> dict[str, Any]:
    uncertainty, verdict, board = result.uncertainty, judge(result), result.board
    values = zip(NAMES, uncertainty.parameters.tolist(), uncertainty.sigma.tolist(), UNITS)
    return {
        "format": _FORMAT,
        "calibration_hash": calibration_hash(result.rig),
        "image_width": uncertainty.size_px[0],
        "image_height": uncertainty.size_px[1],
        "board": {"name": str(board), "square_m": board.square_m},
        "detector": result.detector,
        "distortion": result.solution.model.value,
        "parameters": {name: {"value": value, "sigma": sigma, "unit": unit} for name, value, sigma, unit in values},
        "covariance": uncertainty.covariance.tolist(),
        "verdict": {"word": verdict.word.value, "reasons": list(verdict.reasons)},
        "quality": _quality(result),
        "views": {
            "used": [asdict(view) for view in result.used],
            "rejected": [asdict(view) for view in result.rejected],
            "rejected_corners": [asdict(corner) for corner in result.rejected_corners],
        },
    }


def _quality(result: CalibrationResult) -> dict[str, Any]:
    held_out, covered = result.held_out, result.coverage
    return {
        "rms_px": result.rms_px,
        "corner_sigma_px": result.solution.sigma_px,
        "residuals": dict(zip(("left", "right"), map(asdict, result.residuals))),
        "baseline_sigma_m": result.baseline_sigma_m,
        "held_out_epipolar_px": held_out.epipolar_rms_px if held_out else None,
        "held_out_length_m": held_out.length_rms_m if held_out else None,
        "point_sigmas": [asdict(row) for row in result.point_sigmas],
        "coverage": {**asdict(covered), "depth_m": list(covered.depth_m)},
    }


def _hash(content: Mapping[str, Any]) -> str:
    """SHA-256 of the content, whatever the YAML's layout."""
    return hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()


def _uncertainty(data: Mapping[str, Any]) -> CalibrationUncertainty:
    size_px = int(data["image_width"]), int(data["image_height"])
    values = np.array([data["parameters"][name]["value"] for name in NAMES], np.float64)
    return CalibrationUncertainty(size_px, values, np.array(data["covariance"], np.float64))


def _verdict(data: Mapping[str, Any]) -> Verdict:
    return Verdict(Word(data["verdict"]["word"]), tuple(data["verdict"]["reasons"]))
