"""`stereo-pick import-bouguet`: the toolbox's numbers, unchanged, in the package's own files."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest

from stereo_pick.cli.main import main
from stereo_pick.core.calibration.bouguet import rig_from_bouguet
from stereo_pick.core.calibration.files import load_rig
from stereo_pick.core.errors import CalibrationError

PUBLISHED = {
    "nx": [[640]],
    "ny": [[480]],
    "fc_left": [[533.52331], [533.52699]],
    "cc_left": [[341.60376], [235.19287]],
    "kc_left": [[-0.28838], [0.09714], [0.00109], [-0.0003], [0.0]],
    "alpha_c_left": [[0]],
    "fc_right": [[536.81377], [536.47649]],
    "cc_right": [[326.28657], [250.10121]],
    "kc_right": [[-0.28943], [0.1069], [-0.00059], [0.00014], [0.0]],
    "alpha_c_right": [[0]],
    "om": [[0.00669], [0.00452], [-0.0035]],
    "T": [[-99.80198], [1.12443], [0.05041]],
}


def values(**changed: Any) -> dict[str, Any]:
    return {name: np.array(value) for name, value in (PUBLISHED | changed).items()}


def without(name: str) -> dict[str, Any]:
    return {key: value for key, value in values().items() if key != name}


def test_the_published_result_becomes_a_rig_in_metres() -> None:
    rig = rig_from_bouguet(values())
    np.testing.assert_allclose(rig.right_T_left.translation, [-0.09980198, 0.00112443, 0.00005041], atol=1e-12)
    np.testing.assert_allclose(cv2.Rodrigues(rig.right_T_left.rotation)[0].ravel(), [0.00669, 0.00452, -0.0035])
    np.testing.assert_allclose(rig.right.K, [[536.81377, 0, 326.28657], [0, 536.47649, 250.10121], [0, 0, 1]])
    np.testing.assert_allclose(rig.left.D, [-0.28838, 0.09714, 0.00109, -0.0003, 0])
    assert rig.left.frame_size == (640, 480)


def test_a_point_projects_as_by_the_toolbox_s_own_formula() -> None:
    point = np.array([0.12, -0.09, 0.8])
    x, y = point[:2] / point[2]
    k1, k2, p1, p2, _ = np.ravel(PUBLISHED["kc_left"])
    r2 = x * x + y * y
    radial = 1 + k1 * r2 + k2 * r2 * r2
    xd = radial * x + 2 * p1 * x * y + p2 * (r2 + 2 * x * x)
    yd = radial * y + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y
    expected = [533.52331 * xd + 341.60376, 533.52699 * yd + 235.19287]
    np.testing.assert_allclose(rig_from_bouguet(values()).left.project(point[None])[0], expected, atol=1e-9)


@pytest.mark.parametrize(
    ("content", "says"),
    [
        (without("T"), "variable 'T' is missing"),
        (without("kc_right"), "variable 'kc_right' is missing"),
        (values(fc_left=[[1.0]]), "variable fc_left has shape"),
        (values(om=[[np.nan], [0], [0]]), "variable om holds nan"),
        (values(om=np.array(["a", "b", "c"])), "variable 'om' holds no 3 numbers"),
        (values(alpha_c_left=[[0.01]]), "alpha_c_left = 0.01 skews the image by 2.40 px"),
        (values(fc_right=[[-5.0], [5.0]]), "focal length"),
        (values(T=[[99.8], [0], [0]]), "left and right are swapped"),
        (values(T=[[-99.8 + 1j], [0], [0]]), "variable 'T' holds complex numbers"),
        (values(T=[[-5], [0], [99]]), "stands 0.005 m right of the left one, -0.001 below and -0.099 before it"),
        (values(cc_left=[[5000], [235]]), "left camera: principal point K[0,2], K[1,2] = 5000, 235 px lies 8.2 focal"),
        (values(kc_right=[[-25], [0], [0], [0], [0]]), "right camera: D = -25, 0, 0, 0, 0 folds the image over"),
        (values(om=[[0.383], [17.0], [-0.2]]), "om turns by 17.0055, more than half a turn"),
        ({"fc": np.ones((2, 1))}, "is the result of one camera"),
    ],
)
def test_what_is_missing_or_wrong_is_named(content: dict[str, Any], says: str) -> None:
    with pytest.raises(CalibrationError) as caught:
        rig_from_bouguet(content)
    assert says in str(caught.value)


def test_squares_given_in_metres_need_their_unit() -> None:
    in_metres = values(T=[[-0.0998], [0.00112], [0.00005]])
    with pytest.raises(CalibrationError, match="baseline = 0.100 mm is zero"):
        rig_from_bouguet(in_metres)
    assert rig_from_bouguet(in_metres, "m").baseline_m == pytest.approx(0.0998, abs=1e-4)


@pytest.mark.parametrize(
    ("length", "given", "says"),
    [
        (
            0.0998,
            "mm",
            r"baseline = 0\.100 mm is zero: T, of length 0\.0998, is not in mm: give --unit m \(99\.8 mm\)$",
        ),
        (9.98, "m", r"baseline = 10\.0 m is longer than 5 m: .*: give --unit cm \(99\.8 mm\)$"),
        (99.8, "m", r"baseline = 99\.8 m is longer than 5 m: .*: give --unit mm \(99\.8 mm\) or --unit cm \(998 mm\)$"),
        (1e-6, "mm", "calibrate them as a stereo pair"),
        (1e7, "m", "the calibration is in millimetres"),
    ],
)
def test_the_unit_that_would_do_is_named(length: float, given: str, says: str) -> None:
    with pytest.raises(CalibrationError, match=says):
        rig_from_bouguet(values(T=[[-length], [0.0], [0.0]]), given)


def test_a_real_file_becomes_a_calibration_folder(
    shared_data: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    loadmat = pytest.importorskip("scipy.io", reason="scipy is not installed").loadmat
    file = shared_data / "vigir2023_puma" / "bouguet_results" / "Calib_Results_stereo.mat"
    assert main(["import-bouguet", str(file), "--output", str(tmp_path / "rig")]) == 0
    assert "baseline  262.352 mm" in capsys.readouterr().out
    rig, truth = load_rig(tmp_path / "rig"), loadmat(str(file))
    np.testing.assert_allclose(rig.right_T_left.rotation, truth["R"], atol=1e-9)
    np.testing.assert_allclose(rig.right_T_left.translation * 1000, truth["T"].ravel(), atol=1e-6)
    np.testing.assert_allclose(rig.right.K, truth["KK_right"], atol=1e-9)
    np.testing.assert_allclose(rig.left.D, truth["kc_left"].ravel(), atol=1e-12)


def test_the_toolbox_s_own_corners_project_where_it_saw_them(shared_data: Path) -> None:
    loadmat = pytest.importorskip("scipy.io", reason="scipy is not installed").loadmat
    mat = loadmat(str(shared_data / "vigir2023_puma" / "bouguet_results" / "Calib_Results_stereo.mat"))
    rig = rig_from_bouguet(mat)
    for view in range(1, 12):
        rotation = cv2.Rodrigues(mat[f"omc_left_{view}"].astype(float))[0]
        left_m = (mat[f"X_left_{view}"].T @ rotation.T + mat[f"Tc_left_{view}"].T) / 1000
        for seen, projected in zip(("x_left", "x_right"), rig.project(left_m)):
            misses = projected - mat[f"{seen}_{view}"].T
            assert np.sqrt((misses**2).sum(axis=1).mean()) < 2.0, (view, seen)


def test_the_published_example_is_the_one_in_this_test(shared_data: Path) -> None:
    published = json.loads((shared_data / "bouguet_stereo" / "published.json").read_text())["after_stereo_optimisation"]
    for name in ("fc_left", "cc_left", "kc_left", "fc_right", "cc_right", "kc_right", "om"):
        np.testing.assert_array_equal(np.ravel(PUBLISHED[name]), published[name])
    np.testing.assert_array_equal(np.ravel(PUBLISHED["T"]), published["T_mm"])


def test_a_file_of_one_camera_is_refused(shared_data: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    pytest.importorskip("scipy.io", reason="scipy is not installed")
    file = shared_data / "bouguet_stereo" / "Calib_Results_left.mat"
    assert main(["import-bouguet", str(file), "--output", str(tmp_path / "rig")]) == 1
    assert "Calib_Results_left.mat: is the result of one camera" in capsys.readouterr().err
    assert not (tmp_path / "rig").exists()


@pytest.mark.parametrize("content", [b"", b"MATLAB", b"nonsense" * 100, b"MATLAB 5.0 MAT-file" + bytes(200)])
def test_a_damaged_or_missing_file_is_one_clear_line(
    content: bytes, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    pytest.importorskip("scipy.io", reason="scipy is not installed")
    file = tmp_path / "broken.mat"
    assert main(["import-bouguet", str(file), "--output", str(tmp_path / "rig")]) == 1
    assert "broken.mat: no such file" in capsys.readouterr().err
    file.write_bytes(content)
    assert main(["import-bouguet", str(file), "--output", str(tmp_path / "rig")]) == 1
    text = capsys.readouterr().err
    assert "broken.mat" in text and text.count("\n") == 1


def test_without_scipy_the_command_to_install_it_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setitem(sys.modules, "scipy.io", None)
    assert main(["import-bouguet", str(tmp_path / "a.mat"), "--output", str(tmp_path / "rig")]) == 1
    assert "pip install scipy" in capsys.readouterr().err
