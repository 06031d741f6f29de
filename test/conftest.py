"""Fixtures that every test may use."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest

from stereo_pick.core.arrays import Floats, Image
from stereo_pick.core.calibration.boards import Chessboard
from stereo_pick.core.calibration.detection import BoardImages, detect
from stereo_pick.core.calibration.result import CalibrationResult
from stereo_pick.core.calibration.solving import calibrate_best
from stereo_pick.core.frames import grey
from stereo_pick.core.images import read_image
from stereo_pick.core.transform import Transform

Calibrated = Callable[[str, str, Chessboard], CalibrationResult]


@pytest.fixture(scope="session")
def shared_data() -> Path:
    """The folder of real recordings, which are no part of the project; skips where it is absent."""
    named = os.environ.get("STEREO_PICK_DATA")
    folder = Path(named) if named else Path(__file__).resolve().parents[2] / "shared" / "data"
    if not (folder / "README.md").is_file():
        pytest.skip(f"no real recordings in {folder}; set STEREO_PICK_DATA to their folder")
    return folder


@pytest.fixture(scope="session")
def render_board() -> Callable[[Chessboard, Floats, Transform, tuple[int, int]], Image]:
    """Draws a chessboard as a camera without distortion sees it: board, K, camera_T_board, (width, height) [px]."""

    def render(board: Chessboard, K: Floats, camera_T_board: Transform, size_px: tuple[int, int]) -> Image:
        fine = 4
        u, v = (np.arange(n * fine) / fine - 0.5 + 0.5 / fine for n in size_px)
        pixels = np.stack([*np.meshgrid(u, v), np.ones((len(v), len(u)))], axis=-1)
        homography = K @ np.c_[camera_T_board.rotation[:, :2], camera_T_board.translation]
        on_board = pixels @ np.linalg.inv(homography).T
        x, y = np.moveaxis(on_board[..., :2] / on_board[..., 2:] / board.square_m, -1, 0)
        inside = (x > -1) & (x < board.columns) & (y > -1) & (y < board.rows)
        white = ((np.floor(x) + np.floor(y)) % 2 == 1) | ~inside
        return cv2.resize(np.where(white, 210, 40).astype(np.uint8), size_px, interpolation=cv2.INTER_AREA)

    return render


@pytest.fixture(scope="session")
def calibrated(shared_data: Path) -> Calibrated:
    """Calibrates from a real recording, once: patterns of the left and right files, and the board."""

    @cache
    def result(left: str, right: str, board: Chessboard) -> CalibrationResult:
        pairs = [
            BoardImages(f"{a.parent.name}/{a.name}", a.name, b.name, grey(read_image(a)), grey(read_image(b)))
            for a, b in zip(sorted(shared_data.glob(left)), sorted(shared_data.glob(right)))
        ]
        return calibrate_best(detect(pairs, board), board)

    return result


@pytest.fixture
def graph() -> Iterator[Any]:
    """The test's own place in a ROS domain of its own: a `ros_tools.Graph`."""
    from ros_tools import Graph, reserved_domain

    with reserved_domain() as domain:
        graph = Graph(domain)
        yield graph
        graph.close()


@pytest.fixture
def system(tmp_path: Path) -> Iterator[Any]:
    """A ROS domain of its own for the package's processes: a `ros_tools.System`."""
    from ros_tools import running_system

    with running_system(tmp_path) as system:
        yield system


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config: pytest.Config, log: Any) -> Any:
    """Keep the tests of a file that shares running nodes on one worker; all others go wherever there is room."""
    from xdist.scheduler import LoadScopeScheduling

    class Scheduling(LoadScopeScheduling):
        def _split_scope(self, nodeid: str) -> str:
            return nodeid.split("::")[0] if nodeid.startswith(("test/ros/", "test/system/")) else nodeid

    return Scheduling(config, log) if config.getvalue("dist") == "load" else None
