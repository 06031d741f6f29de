"""Fixtures that every test may use."""

from __future__ import annotations

import os
import pickle
import re
import signal
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, TypeVar

import cv2
import numpy as np
import pytest

from stereo_pick.core.arrays import Floats, Image
from stereo_pick.core.calibration.boards import Chessboard
from stereo_pick.core.calibration.charuco import CharucoBoard
from stereo_pick.core.calibration.detection import BoardImages, Detections, detect
from stereo_pick.core.calibration.result import CalibrationResult
from stereo_pick.core.calibration.solving import calibrate_best
from stereo_pick.core.frames import grey
from stereo_pick.core.images import read_image
from stereo_pick.core.transform import Transform

Calibrated = Callable[..., CalibrationResult]
Made = TypeVar("Made")
Once = Callable[[str, Callable[[], Made]], Made]

cv2.utils.logging.setLogLevel(cv2.utils.logging.LOG_LEVEL_ERROR)  # the package asks for that before it imports OpenCV

if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:  # by `make test &` in a script: children would not hear Ctrl-C
    signal.signal(signal.SIGINT, signal.default_int_handler)


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--all", action="store_true", help="run the tests marked `more`, too")


def pytest_configure(config: pytest.Config) -> None:
    config.addinivalue_line("markers", "first: takes as long as no other; begun last, all workers but one would wait")


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    items.sort(key=lambda item: item.get_closest_marker("first") is None)
    if config.getoption("--all"):
        return
    for item in items:
        if item.get_closest_marker("more"):
            item.add_marker(pytest.mark.skip(reason="one more scene of the same: `make test-all` runs it"))


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
        x, y = on_board(K, camera_T_board, size_px) / board.square_m
        inside = (x > -1) & (x < board.columns) & (y > -1) & (y < board.rows)
        white = ((np.floor(x) + np.floor(y)) % 2 == 1) | ~inside
        return shrunk(np.where(white, 210, 40), size_px)

    return render


@pytest.fixture(scope="session")
def render_charuco() -> Callable[..., Image]:
    """Draws a ChArUco board, whose squares come from OpenCV itself, like `render_board`; `legacy`: OpenCV 4.5's."""

    def render(
        board: CharucoBoard, K: Floats, camera_T_board: Transform, size_px: tuple[int, int], legacy: bool = False
    ) -> Image:
        texture = charuco_texture(board, legacy)
        fine_to_pixel = np.array([[1 / FINE, 0, 0.5 / FINE - 0.5], [0, 1 / FINE, 0.5 / FINE - 0.5], [0, 0, 1]])
        square, half = TEXELS / board.square_m, TEXELS - 0.5  # OpenCV's texel 0 reaches from -0.5 to 0.5
        board_to_texel = np.array([[square, 0, half], [0, square, half], [0, 0, 1]])
        homography = np.linalg.inv(K @ np.c_[camera_T_board.rotation[:, :2], camera_T_board.translation])
        fine = cv2.warpPerspective(
            (40 + texture * (170 / 255)).astype(np.uint8),
            board_to_texel @ homography @ fine_to_pixel,
            [n * FINE for n in size_px],
            flags=cv2.INTER_NEAREST | cv2.WARP_INVERSE_MAP,
            borderValue=210,
        )
        return shrunk(fine, size_px)

    return render


FINE, TEXELS = 4, 56  # samples in a pixel, texels in a square


def on_board(K: Floats, camera_T_board: Transform, size_px: tuple[int, int]) -> Floats:
    """Board coordinates (2, H, W) [m] of each of the FINE x FINE samples of each pixel."""
    u, v = (np.arange(n * FINE) / FINE - 0.5 + 0.5 / FINE for n in size_px)
    pixels = np.stack([*np.meshgrid(u, v), np.ones((len(v), len(u)))], axis=-1)
    homography = K @ np.c_[camera_T_board.rotation[:, :2], camera_T_board.translation]
    points = pixels @ np.linalg.inv(homography).T
    return np.moveaxis(points[..., :2] / points[..., 2:], -1, 0)


def shrunk(fine: Floats, size_px: tuple[int, int]) -> Image:
    return cv2.resize(fine.astype(np.uint8), size_px, interpolation=cv2.INTER_AREA)


def charuco_texture(board: CharucoBoard, legacy: bool) -> Image:
    """The board as OpenCV draws it, TEXELS to a square."""
    dictionary = cv2.aruco.getPredefinedDictionary(getattr(cv2.aruco, f"DICT_{board.dictionary}"))
    size = (board.columns * TEXELS, board.rows * TEXELS)
    if not hasattr(cv2.aruco, "CharucoDetector"):  # up to OpenCV 4.6
        pattern = cv2.aruco.CharucoBoard_create(board.columns, board.rows, 1.0, board.marker_ratio, dictionary)
        return pattern.draw(size)
    pattern = cv2.aruco.CharucoBoard((board.columns, board.rows), 1.0, board.marker_ratio, dictionary)
    if legacy:
        pattern.setLegacyPattern(True)
    return pattern.generateImage(size)


@pytest.fixture(scope="session")
def once(tmp_path_factory: pytest.TempPathFactory) -> Once[Any]:
    """Makes what has a name, and takes seconds, once for all workers, but for those that ask at the same time."""
    own = tmp_path_factory.getbasetemp()
    folder = own.parent if "PYTEST_XDIST_WORKER" in os.environ else own

    def taken(name: str, make: Callable[[], Made]) -> Made:
        file = folder / f"{name}.pickle"
        if not file.is_file():
            part = file.with_suffix(f".{os.getpid()}")
            part.write_bytes(pickle.dumps(make()))
            part.replace(file)
        made: Made = pickle.loads(file.read_bytes())
        return made

    return taken


@pytest.fixture(scope="session")
def calibrated(shared_data: Path, once: Once[Any]) -> Calibrated:
    """Calibrates from a real recording, once: patterns of the left and right files, the board, a detector."""

    def detections(left: str, right: str, board: Chessboard) -> list[Detections]:
        pairs = [
            BoardImages(f"{a.parent.name}/{a.name}", a.name, b.name, grey(read_image(a)), grey(read_image(b)))
            for a, b in zip(sorted(shared_data.glob(left)), sorted(shared_data.glob(right)))
        ]
        return detect(pairs, board)

    def result(left: str, right: str, board: Chessboard, detector: str = "") -> CalibrationResult:
        seen = once(file_name(f"seen {left} {right} {board}"), lambda: detections(left, right, board))
        return calibrate_best([each for each in seen if detector in ("", each.detector)], board)

    def named(left: str, right: str, board: Chessboard, detector: str = "") -> CalibrationResult:
        return once(file_name(f"{left} {right} {board} {detector}"), lambda: result(left, right, board, detector))

    return named


def file_name(text: str) -> str:
    return re.sub(r"\W+", "_", text)


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
