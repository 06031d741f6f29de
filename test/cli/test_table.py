"""`stereo-pick table`: from pairs with a board on the table to the value of a parameter."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from pathlib import Path

import cv2
import numpy as np
import pytest
import yaml
from board_bags import BOARD, GREY, K, right_T_left
from recordings import write_images

from stereo_pick.cli.main import main
from stereo_pick.core.arrays import Image
from stereo_pick.core.calibration.files import save_rig
from stereo_pick.core.camera import Camera
from stereo_pick.core.rig import StereoRig
from stereo_pick.core.shapes.table import Table
from stereo_pick.core.transform import Transform

RIG = StereoRig.from_extrinsics(
    *(Camera(side, 320, 240, K, np.zeros(5), np.eye(3), np.c_[K, np.zeros(3)]) for side in ("left", "right")),
    right_T_left,
)
TILT = cv2.Rodrigues(np.array([0.4, 0.1, 0.0]))[0]
MIDDLES = np.array([[0.0, -0.02, 0.0], [0.04, 0.02, 0.0]]) @ TILT.T + [0.02, 0.0, 0.5]
TURNS = 0.0, 0.3
THICKNESS_M = 0.003


@pytest.fixture
def folder(tmp_path: Path, render_board: Callable[..., Image]) -> Path:
    """A calibration, and pairs of the board on the table, and of nothing."""
    save_rig(RIG, tmp_path / "rig")
    pairs = [(GREY, GREY)]
    for middle, turn in zip(MIDDLES, TURNS):
        R = TILT @ cv2.Rodrigues(np.array([0.0, 0.0, turn]))[0]
        pose = Transform(R, middle - R @ BOARD.object_points().mean(axis=0))
        left, right = (render_board(BOARD, K, camera, (320, 240)) for camera in (pose, right_T_left @ pose))
        pairs.append((left, right))
    write_images(tmp_path / "board", pairs)
    write_images(tmp_path / "empty", pairs[:1])
    return tmp_path


def measure(folder: Path, *options: str, source: str = "board") -> int:
    given = ["--source", folder / source, "--calibration", folder / "rig", "--board", str(BOARD), "--square", "0.03"]
    return main(["table", *map(str, given), "--thickness", str(THICKNESS_M), *options])


def test_the_parameter_is_the_table(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert measure(folder, "--output", str(folder / "table.yaml")) == 0
    printed = capsys.readouterr().out
    assert "the board in 2 of 3 pairs" in printed
    written = yaml.safe_load((folder / "table.yaml").read_text(encoding="utf-8"))
    text = written["/**/correspondence"]["ros__parameters"]["feature"]["table"]
    assert f'--param feature.table="{text}"' in printed
    under = MIDDLES + THICKNESS_M * TILT[:, 2]  # the board's z axis points into it
    np.testing.assert_allclose(Table.parsed(text).height_m(under @ RIG.left.R.T), 0, atol=5e-4)


def test_pairs_of_a_camera_that_hung_are_not_measured_from(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    shutil.copy(folder / "board" / "left01.png", folder / "board" / "left02.png")
    assert measure(folder) == 0
    said = capsys.readouterr()
    assert "the board in 1 of 2 pairs" in said.out
    assert "warning: 1 of 3 pairs, the first of them number 3, are refused: the left camera repeats" in said.err


@pytest.mark.parametrize("file", ["board/left01.png", "rig/right.yaml"])
def test_what_is_measured_from_is_not_overwritten(file: str, folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    before = (folder / file).read_bytes()
    (folder / "link.yaml").symlink_to(folder / file)
    for output in (folder / file, folder / "rig" / ".." / file, folder / "link.yaml"):
        assert measure(folder, "--output", str(output)) == 1
        said = capsys.readouterr()
        assert f"--output {output} is part of the recording or of the calibration: give another file" in said.err
        assert said.out == "" and (folder / file).read_bytes() == before


def test_no_board_another_size_and_no_folder_are_said(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert measure(folder, source="empty") == 1
    assert "no chessboard of 7x5 inner corners found in both images of any of 1 pairs" in capsys.readouterr().err
    write_images(folder / "small", [(GREY[::2, ::2], GREY[::2, ::2])])
    assert measure(folder, source="small") == 1
    assert "160 x 120" in capsys.readouterr().err
    assert measure(folder, "--output", str(folder / "nowhere" / "table.yaml")) == 1
    assert "table.yaml cannot be written" in capsys.readouterr().err
