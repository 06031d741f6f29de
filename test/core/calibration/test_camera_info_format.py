"""camera_info YAML as other programs read and write it: a reader as strict as camera_calibration_parsers' own."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from rigs import RIGS, camera, looking_at

from stereo_pick.core.calibration.files import load_camera_info, save_rig
from stereo_pick.core.camera import Camera
from stereo_pick.core.rig import StereoRig

FISHEYE = camera(focal_px=420.0, D=(0.05, -0.01, 0.002, -0.001), model="equidistant")
RATIONAL = camera(D=(0.1, -0.2, 1e-3, -1e-5, 0.01, 0.2, -0.1, 3e-7), model="rational_polynomial")
VERGED = looking_at((0.1, 0, 0), (0, 0, 1))
ALL = {
    **RIGS,
    "equidistant": StereoRig.from_extrinsics(FISHEYE, FISHEYE, VERGED),
    "rational": StereoRig.from_extrinsics(RATIONAL, RATIONAL, VERGED),
}


def strict(path: Path) -> dict[str, Any]:
    """What camera_calibration_parsers' reader makes of a file; fails on all that makes that one fail.

    Its numbers are C++ numbers: `rows` and `cols` whole ones of the expected values, `data` one flat list.
    """
    text = path.read_text(encoding="ascii")
    assert not text.startswith("%")  # a version line that is not YAML's own ends the C++ parser
    data = yaml.load(text, yaml.BaseLoader)  # all text: no kindness of Python's types

    def matrix(name: str, rows: int, cols: int | None) -> np.ndarray:
        node = data[name]
        assert isinstance(node, Mapping) and set(node) == {"rows", "cols", "data"}
        found = int(node["rows"]), int(node["cols"])
        assert found[0] == rows and cols in (None, found[1])
        assert isinstance(node["data"], list) and len(node["data"]) == found[0] * found[1]
        return np.array([float(value) for value in node["data"]]).reshape(found)

    assert data["camera_name"]
    return {
        "size": (int(data["image_width"]), int(data["image_height"])),
        "K": matrix("camera_matrix", 3, 3),
        "model": data["distortion_model"],
        "D": matrix("distortion_coefficients", 1, None)[0],
        "R": matrix("rectification_matrix", 3, 3),
        "P": matrix("projection_matrix", 3, 4),
    }


def assert_is(read: Mapping[str, Any], camera: Camera) -> None:
    """Every number to the last bit."""
    assert (read["size"], read["model"]) == (camera.frame_size, camera.distortion_model)
    for name in "KDRP":
        np.testing.assert_array_equal(read[name], getattr(camera, name))


@pytest.mark.parametrize("name", ALL)
def test_a_strict_reader_gets_every_number_unchanged(name: str, tmp_path: Path) -> None:
    save_rig(ALL[name], tmp_path)
    for side in ("left", "right"):
        assert_is(strict(tmp_path / f"{side}.yaml"), getattr(ALL[name], side))


@pytest.mark.parametrize("name", ALL)
def test_a_second_round_changes_nothing(name: str, tmp_path: Path) -> None:
    save_rig(ALL[name], tmp_path / "first")
    cameras = [load_camera_info(tmp_path / "first" / f"{side}.yaml") for side in ("left", "right")]
    save_rig(StereoRig(*cameras), tmp_path / "second")
    for file in ("left.yaml", "right.yaml"):
        assert (tmp_path / "first" / file).read_bytes() == (tmp_path / "second" / file).read_bytes()


THEIRS = """\
image_width: 640
image_height: 480
camera_name: narrow_stereo/left
camera_matrix:
  rows: 3
  cols: 3
  data: [438.783367, 0, 305.593336, 0, 437.302876, 243.738352, 0, 0, 1]
distortion_model: plumb_bob
distortion_coefficients:
  rows: 1
  cols: 5
  data: [-0.361976, 0.11051, 1e-05, 5.05e-04, 0.]
rectification_matrix:
  rows: 3
  cols: 3
  data: [1, 0, 0, 0, 1, 0, 0, 0, 1]
projection_matrix:
  rows: 3
  cols: 4
  data: [393.653800, 0.      , 322.797939, 0.      ,
         0.      , 393.653800, 241.090902, 0.      ,
         0.      , 0.      , 1.      , 0.      ]
"""


def test_a_file_as_others_write_it_is_read(tmp_path: Path) -> None:
    path = tmp_path / "theirs.yaml"
    path.write_text(THEIRS)
    camera = load_camera_info(path)
    assert_is(strict(path), camera)
    assert camera.name == "narrow_stereo/left"
    assert camera.D.tolist() == [-0.361976, 0.11051, 1e-05, 5.05e-04, 0.0]


@pytest.mark.parametrize(
    ("ours", "spoilt"),
    [
        ("cols: 5", "cols: 4"),
        ("rows: 3\n  cols: 4", "rows: 4\n  cols: 3"),
        ("camera_name: narrow_stereo/left\n", ""),
        ("data: [1, 0,", "data: [[1, 0],"),
    ],
)
def test_the_strict_reader_is_strict(ours: str, spoilt: str, tmp_path: Path) -> None:
    assert ours in THEIRS
    (tmp_path / "spoilt.yaml").write_text(THEIRS.replace(ours, spoilt, 1))
    with pytest.raises((AssertionError, KeyError, ValueError, TypeError, yaml.YAMLError)):
        strict(tmp_path / "spoilt.yaml")
