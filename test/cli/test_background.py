"""`stereo-pick background`: from a folder of the empty surface to a file that `locate` uses."""

from __future__ import annotations

import json
import shutil
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest
from recordings import write_images
from rendering import Carton, Scene, Sensor, balls, render
from rigs import RIGS

from stereo_pick.cli.main import main
from stereo_pick.core.calibration.files import save_rig
from stereo_pick.core.calibration.fingerprint import calibration_hash
from stereo_pick.core.objects.background_files import load_background

RIG = RIGS["thesis"]
SCENE = Scene(
    balls((-0.08, -0.03, 0.04), (0.0, 0.05, 0.05)), paints=(Carton(0.1, -0.02, 0.1, 0.08, 0.4, 0.7),), ambient=0.9
)
SENSOR = Sensor(gain=0.9)


@pytest.fixture(scope="module")
def taken(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A calibration, a folder `empty` of the table, and a pair of the parts on it."""
    folder = tmp_path_factory.mktemp("background")
    save_rig(RIG, folder / "rig")
    frames = [render(RIG, replace(SCENE, solids=()), SENSOR, SENSOR, seed) for seed in range(4)]
    write_images(folder / "empty", [(frame.left, frame.right) for frame in frames])
    full = render(RIG, SCENE, SENSOR, SENSOR, seed=9)
    for side in ("left", "right"):
        cv2.imwrite(str(folder / f"{side}.png"), getattr(full, side))
    return folder


@pytest.fixture
def folder(taken: Path, tmp_path: Path) -> Path:
    """A copy of it that a test may spoil."""
    return Path(shutil.copytree(taken, tmp_path / "taken"))


def learn(folder: Path, source: str = "empty", output: str = "out/b.npz") -> int:
    given = ["--source", folder / source, "--calibration", folder / "rig", "--output", folder / output]
    return main(["background", *map(str, given)])


def seen(folder: Path, capsys: pytest.CaptureFixture[str], *options: str) -> int:
    """Objects and refusals together."""
    images = [str(folder / f"{side}.png") for side in ("left", "right")]
    assert main(["locate", *images, "--calibration", str(folder / "rig"), "--json", *options]) == 0
    found = json.loads(capsys.readouterr().out)
    return len(found["objects"]) + len(found["refused"])


def test_what_was_learned_is_no_object(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    before = seen(folder, capsys)
    assert learn(folder) == 0
    assert f"learned from 4 pairs, for calibration {calibration_hash(RIG)}" in capsys.readouterr().out
    assert load_background(folder / "out" / "b.npz").pairs == 4
    after = seen(folder, capsys, "--param", f"segmentation.background_file={folder / 'out' / 'b.npz'}")
    assert after == len(SCENE.solids) < before


def test_parts_that_lay_there_while_it_was_learned_are_told_of(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert learn(folder) == 0
    assert "warning" not in capsys.readouterr().err
    for side in ("left", "right"):
        for file in (folder / "empty").glob(f"{side}*.png"):
            shutil.copy(folder / f"{side}.png", file)
    assert learn(folder, output="out/full.npz") == 0
    warning = capsys.readouterr().err
    assert "in the views that the background was learned from" in warning and "clear the surface" in warning


def test_pairs_of_a_camera_that_hung_are_not_learned_from(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    shutil.copy(folder / "empty" / "right01.png", folder / "empty" / "right02.png")
    assert learn(folder) == 0
    said = capsys.readouterr()
    assert "warning: 1 of 4 pairs, the first of them number 3, are refused: the right camera repeats" in said.err
    assert load_background(folder / "out" / "b.npz").pairs == 3


def test_a_background_of_another_calibration_is_one_clear_line(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert learn(folder) == 0
    save_rig(RIGS["parallel"], folder / "rig")
    images = [str(folder / f"{side}.png") for side in ("left", "right")]
    given = ["--calibration", str(folder / "rig"), "--param", f"segmentation.background_file={folder}/out/b.npz"]
    capsys.readouterr()
    assert main(["locate", *images, *given]) == 1
    assert "learned with another calibration" in capsys.readouterr().err


def test_too_few_pairs_are_one_clear_line(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for file in (folder / "empty").glob("*0[123].png"):
        file.unlink()
    assert learn(folder) == 1
    assert "1 pairs are too few to learn a background from: give at least 3" in capsys.readouterr().err
    assert not (folder / "out").exists()


@pytest.mark.parametrize("file", ["empty/left01.png", "rig/right.yaml"])
def test_what_is_learned_from_is_not_overwritten(file: str, folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    before = (folder / file).read_bytes()
    assert learn(folder, output=file) == 1
    assert f"--output {folder / file} is part of the recording or of the calibration" in capsys.readouterr().err
    assert (folder / file).read_bytes() == before


def test_a_lens_cap_is_one_clear_line(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for file in (folder / "empty").glob("right*.png"):
        cv2.imwrite(str(file), np.zeros(cv2.imread(str(file)).shape, np.uint8))
    assert learn(folder) == 1
    assert "the right view is black all over" in capsys.readouterr().err
    assert not (folder / "out").exists()
