"""calibration.yaml: what was written is read back to the bit, and a changed file is noticed."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np
import pytest
import yaml
from simulated_views import BOARD, SIZE_PX, make_views

from stereo_pick.core.calibration.files import load_rig, save_rig
from stereo_pick.core.calibration.fingerprint import calibration_hash
from stereo_pick.core.calibration.record import load_record, save_record
from stereo_pick.core.calibration.result import CalibrationResult
from stereo_pick.core.calibration.solving import calibrate
from stereo_pick.core.calibration.verdict import judge
from stereo_pick.core.errors import CalibrationError


@cache
def result() -> CalibrationResult:
    return calibrate(make_views(6, noise_px=0.1), SIZE_PX, BOARD)


def test_what_was_written_is_read_back(tmp_path: Path) -> None:
    path = save_record(result(), tmp_path)
    for found in (load_record(path), load_record(tmp_path)):
        assert found.uncertainty.size_px == SIZE_PX
        np.testing.assert_array_equal(found.uncertainty.parameters, result().solution.parameters)
        np.testing.assert_array_equal(found.uncertainty.covariance, result().solution.covariance)
        assert found.verdict == judge(result())


def test_file_says_everything_in_names_and_units(tmp_path: Path) -> None:
    data = yaml.safe_load(save_record(result(), tmp_path).read_text())
    assert data["parameters"]["left.fx"]["unit"] == "px"
    assert data["parameters"]["translation.x"]["value"] == pytest.approx(-0.118, abs=1e-3)
    assert data["parameters"]["translation.x"]["sigma"] > 0
    assert [view["name"] for view in data["views"]["used"]] == [f"pair{i}" for i in range(6)]
    assert data["quality"]["held_out_epipolar_px"] > 0
    assert len(data["quality"]["point_sigmas"]) == 3


def test_hash_is_of_the_content(tmp_path: Path) -> None:
    path = save_record(result(), tmp_path)
    stated = load_record(path).hash
    path.write_text(yaml.safe_dump(yaml.safe_load(path.read_text())))
    assert load_record(path).hash == stated
    other = calibrate(make_views(6, noise_px=0.1, seed=1), SIZE_PX, BOARD)
    assert load_record(save_record(other, tmp_path)).hash != stated


def test_file_states_the_hash_of_the_camera_info_beside_it(tmp_path: Path) -> None:
    path = save_record(result(), tmp_path)
    save_rig(result().rig, tmp_path)
    stated = yaml.safe_load(path.read_text())["calibration_hash"]
    assert stated == calibration_hash(load_rig(tmp_path)) == load_record(path).calibration_hash


def test_changed_file_is_noticed(tmp_path: Path) -> None:
    path = save_record(result(), tmp_path)
    data = yaml.safe_load(path.read_text())
    data["parameters"]["left.fx"]["value"] += 1
    path.write_text(yaml.safe_dump(data))
    with pytest.raises(CalibrationError, match=r"calibration\.yaml: was changed"):
        load_record(path)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("a:\n  {", "is no YAML: .* found '<stream end>' .*line 2"),
        ("[]", "is no 'stereo_pick calibration 1'"),
        (None, "cannot be read"),
    ],
)
def test_what_is_no_record_is_refused(text: str | None, message: str, tmp_path: Path) -> None:
    if text is not None:
        (tmp_path / "calibration.yaml").write_text(text)
    with pytest.raises(CalibrationError, match=message):
        load_record(tmp_path / "calibration.yaml")
