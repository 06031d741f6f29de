"""Calibration files: written, read back, and refused with the file and the field."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
import yaml
from rigs import RIGS, camera, looking_at, rotation, thesis_cameras

from stereo_pick.core.calibration.files import load_camera_info, load_rig, save_rig
from stereo_pick.core.calibration.opencv_file import load_opencv, save_opencv
from stereo_pick.core.errors import CalibrationError
from stereo_pick.core.rig import StereoRig


def assert_same(one: StereoRig, other: StereoRig) -> None:
    for mine, its in ((one.left, other.left), (one.right, other.right)):
        assert mine.frame_size == its.frame_size and mine.distortion_model == its.distortion_model
        for field in ("K", "D", "R", "P"):
            np.testing.assert_allclose(getattr(mine, field), getattr(its, field), rtol=1e-9, atol=1e-9)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A folder with the thesis's rig in both forms."""
    save_rig(RIGS["thesis"], tmp_path)
    return tmp_path


@pytest.mark.parametrize("name", RIGS)
@pytest.mark.parametrize("form", ["left.yaml", "stereo.yaml"])
def test_what_is_written_is_read_back(name: str, form: str, tmp_path: Path) -> None:
    written = save_rig(RIGS[name], tmp_path)
    assert sorted(path.name for path in written) == ["left.yaml", "right.yaml", "stereo.yaml"]
    for path in written:
        if (path.name == "stereo.yaml") != (form == "stereo.yaml"):
            path.unlink()
    assert_same(load_rig(tmp_path), RIGS[name])


@pytest.mark.parametrize("form", ["", "stereo.yaml"])
@pytest.mark.parametrize(
    ("D", "model"),
    [
        ((0.05, -0.01, 0.002, -0.001), "equidistant"),
        ((0.5, 0.1, 0, 0, 0, 0.7, 0.2, 0), "rational_polynomial"),
        ((0.5, 0.1, 0, 0, 0, 0.7, 0.2, 0, 0, 0, 0, 0, 0, 0), "rational_polynomial"),
    ],
)
def test_a_rig_with_lenses_of_another_model_survives(
    D: tuple[float, ...], model: str, form: str, tmp_path: Path
) -> None:
    """Four coefficients of a fisheye lens in stereo.yaml were read as those of plumb_bob."""
    lens, plain = camera(focal_px=420.0, D=D, model=model), camera(focal_px=420.0)
    for right in (lens, plain):
        rig = StereoRig.from_extrinsics(lens, right, looking_at((0.1, 0, 0), (0, 0, 1)))
        save_rig(rig, tmp_path)
        assert_same(load_rig(tmp_path / form), rig)


def test_the_written_camera_info_is_that_of_camera_info_manager(folder: Path) -> None:
    data = yaml.safe_load((folder / "left.yaml").read_text(encoding="utf-8"))
    assert list(data) == [
        "image_width", "image_height", "camera_name", "camera_matrix", "distortion_model",
        "distortion_coefficients", "rectification_matrix", "projection_matrix",
    ]  # fmt: skip
    assert {name: (data[name]["rows"], data[name]["cols"]) for name in data if "matrix" in name} == {
        "camera_matrix": (3, 3), "rectification_matrix": (3, 3), "projection_matrix": (3, 4),
    }  # fmt: skip


@pytest.mark.parametrize(("unit", "factor"), [("mm", 1000.0), ("cm", 100.0), ("m", 1.0), (None, 1.0)])
def test_an_opencv_file_is_read_in_its_unit(unit: str | None, factor: float, tmp_path: Path) -> None:
    write_opencv(tmp_path / "stereo.yaml", factor, unit)
    assert_same(load_rig(tmp_path), RIGS["thesis"])


def test_millimetres_without_a_unit_are_noticed(tmp_path: Path) -> None:
    write_opencv(tmp_path / "stereo.yaml", 1000.0, None)
    with pytest.raises(CalibrationError, match=r"stereo.yaml: baseline = 210\.3 m .* millimetres"):
        load_rig(tmp_path)


def write_opencv(path: Path, factor: float, unit: str | float | None, **instead: Any) -> None:
    left, right, right_T_left = thesis_cameras()
    content = {
        "image_width": 640, "image_height": 480, "K1": left.K, "D1": left.D.reshape(1, 5), "K2": right.K,
        "D2": right.D.reshape(5, 1), "R": right_T_left.rotation, "T": right_T_left.translation.reshape(3, 1) * factor,
        **({"unit": unit} if unit else {}), **instead,
    }  # fmt: skip
    storage = cv2.FileStorage(str(path), cv2.FILE_STORAGE_WRITE)
    for name, value in content.items():
        if value is not None:
            storage.write(name, np.array(value) if isinstance(value, np.ndarray) else value)
    storage.release()


@pytest.mark.parametrize(
    ("wrong", "complaint"),
    [
        ({"K2": None}, "matrix 'K2' is missing; needed are K1 D1 K2 D2 R T"),
        ({"T": None}, "matrix 'T' is missing"),
        ({"R": np.eye(4)}, "R has shape"),
        ({"K1": np.full((3, 3), np.nan)}, "K1 holds nan"),
        ({"T": np.zeros((4, 1))}, "T has shape"),
        ({"T": np.zeros((3, 1))}, "baseline = 0.000 mm is zero"),
        ({"R": np.diag([1.0, -1.0, 1.0])}, "not a rotation matrix"),
        ({"image_width": None}, "image_width is missing: add a line 'image_width: N', N being .* in pixels"),
        ({"image_height": None}, "image_height is missing: add a line 'image_height: N'"),
        ({"image_width": "wide"}, "image_width 'wide' must be a whole number"),
        ({"image_width": 640.5}, "image_width 640.5 must be a whole number"),
        ({"image_width": float("inf")}, "image_width inf must be a whole number"),
        ({"image_width": 0}, "image size 0 x 480"),
        ({"unit": "inch"}, "unit 'inch' must be one of m, mm, cm: the unit of T"),
        ({"unit": 0.001}, "unit 0.001 must be one of m, mm, cm: the unit of T"),
    ],
    ids=lambda value: next(iter(value)) if isinstance(value, dict) else "",
)
def test_a_bad_opencv_file_is_refused_with_the_file_and_the_field(
    wrong: dict[str, Any], complaint: str, tmp_path: Path
) -> None:
    path = tmp_path / "stereo.yaml"
    write_opencv(path, 1.0, wrong.pop("unit", None), **wrong)
    with pytest.raises(CalibrationError, match=f"stereo.yaml: .*{complaint}"):
        load_opencv(path)


def test_an_opencv_file_may_have_any_name(folder: Path) -> None:
    """OpenCV dies of one that is not UTF-8, as of an old disk or another system, by a segmentation fault."""
    script = (
        "import sys; from pathlib import Path; from stereo_pick.core.calibration.files import load_rig, save_rig\n"
        "rig, folder = load_rig(Path(sys.argv[1])), Path(sys.argv[2])\n"
        "save_rig(rig, folder); load_rig(folder / 'stereo.yaml')"
    )
    named = folder / os.fsdecode(b"r\xf6hre")
    done = subprocess.run([sys.executable, "-c", script, folder, named], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")
    assert_same(load_rig(named / "stereo.yaml"), load_rig(folder))


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs a full disk")
def test_an_opencv_file_that_a_full_disk_cuts_short_is_an_error() -> None:
    with pytest.raises(OSError, match="No space left"):
        save_opencv(RIGS["thesis"], Path("/dev/full"))


def test_an_opencv_file_is_refused_wherever_it_is_cut(tmp_path: Path) -> None:
    path = tmp_path / "stereo.yaml"
    write_opencv(path, 1.0, None)
    text = path.read_text().rstrip()
    for length in [*range(0, len(text), 7), len(text) - 1]:
        path.write_text(text[:length])
        with pytest.raises(CalibrationError, match="stereo.yaml: "):
            load_opencv(path)


@pytest.mark.parametrize(
    "content", ["", "K1: [1, 2", "just words\n", "\x00\x01\x02"], ids=["empty", "cut", "text", "binary"]
)
def test_what_is_no_opencv_file_is_refused_with_its_path(content: str, tmp_path: Path) -> None:
    path = tmp_path / "stereo.yaml"
    path.write_text(content)
    with pytest.raises(CalibrationError, match="stereo.yaml: "):
        load_rig(path)


@pytest.mark.parametrize(
    ("field", "value", "complaint"),
    [
        ("camera_matrix", None, "field 'camera_matrix' is missing"),
        ("projection_matrix", None, "field 'projection_matrix' is missing"),
        ("camera_matrix", {"rows": 3, "cols": 3}, "field 'camera_matrix' has no 'data'"),
        ("camera_matrix", 7, "field 'camera_matrix' has no 'data'"),
        ("camera_matrix", {"data": [1.0] * 8}, "field 'camera_matrix' must hold 3 x 3 numbers"),
        ("camera_matrix", {"data": ["a"] * 9}, "field 'camera_matrix' must hold 3 x 3 numbers"),
        ("projection_matrix", {"data": [float("nan")] * 12}, "projection_matrix holds nan"),
        ("distortion_coefficients", {"data": [0.1, 0.2, 0.3]}, "3 distortion coefficients do not fit"),
        ("rectification_matrix", {"data": [0.0] * 9}, "R is not a rotation"),
        ("unit", "mm", "unit 'mm': a camera_info counts in metres"),
        ("distortion_model", "fov", "unknown distortion model 'fov'"),
        ("image_width", "wide", "image_width and image_height must be whole numbers"),
        ("image_width", float("inf"), "image_width and image_height must be whole numbers"),
        ("image_height", 0, "image size 640 x 0"),
    ],
)
def test_a_bad_camera_info_is_refused_with_the_file_and_the_field(
    field: str, value: Any, complaint: str, folder: Path
) -> None:
    path = folder / "right.yaml"
    data = yaml.safe_load(path.read_text(encoding="utf-8"))
    data[field] = value
    if value is None:
        del data[field]
    path.write_text(yaml.safe_dump(data))
    with pytest.raises(CalibrationError) as caught:
        load_rig(folder)
    assert "right.yaml: " in str(caught.value) and complaint in str(caught.value)


@pytest.mark.parametrize(
    ("content", "complaint"),
    [
        ("a: [1, 2", "is no YAML: .* expected ',' or '\\]', but got '<stream end>' .*line 1"),
        ("a: 1\nb:\n\tc: 2", r"is no YAML: .* character '\\t' that cannot start any token .*line 3"),
        ("- 1\n- 2\n", "is no camera_info"),
    ],
)
def test_what_is_no_camera_info_is_refused_with_its_path(content: str, complaint: str, folder: Path) -> None:
    (folder / "left.yaml").write_text(content)
    with pytest.raises(CalibrationError, match=f"left.yaml: {complaint}"):
        load_rig(folder)


def test_bytes_that_are_no_text_are_refused_with_their_path(folder: Path) -> None:
    (folder / "left.yaml").write_bytes(b"\xff\xfe\x80")
    with pytest.raises(CalibrationError, match="left.yaml: is no YAML"):
        load_camera_info(folder / "left.yaml")


def test_files_that_are_not_there_are_named(tmp_path: Path) -> None:
    with pytest.raises(CalibrationError, match=f"{tmp_path}/nowhere: no such calibration folder or file"):
        load_rig(tmp_path / "nowhere")
    (tmp_path / "right.yaml").write_text("")
    with pytest.raises(CalibrationError, match=r"neither left.yaml and right.yaml nor stereo.yaml, but right.yaml"):
        load_rig(tmp_path)
    with pytest.raises(CalibrationError, match="left.yaml: cannot be read: No such file"):
        load_camera_info(tmp_path / "left.yaml")


def test_a_camera_info_may_say_that_it_counts_in_metres(folder: Path) -> None:
    with (folder / "right.yaml").open("a", encoding="utf-8") as file:
        file.write("unit: m\n")
    assert_same(load_rig(folder), RIGS["thesis"])


def test_exchanged_files_are_refused(folder: Path) -> None:
    left, right = folder / "left.yaml", folder / "right.yaml"
    held = left.read_bytes()
    left.write_bytes(right.read_bytes())
    right.write_bytes(held)
    with pytest.raises(CalibrationError, match=f"{folder}: .*left and right are swapped"):
        load_rig(folder)


def test_the_thesiss_rotation_vector_means_right_from_left(shared_data: Path) -> None:
    """Of the truth of bench_rig: R and T are those that the thesis prints, read as X_R = R X_L + T."""
    rig = load_rig(shared_data / "bench_rig" / "calibration" / "truth" / "opencv.yaml")
    np.testing.assert_allclose(rig.right_T_left.rotation, rotation((0.08355, 0.29692, -0.00108)), atol=1e-6)
    assert_same(rig, load_rig(shared_data / "bench_rig" / "calibration" / "truth"))
