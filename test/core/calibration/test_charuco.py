"""ChArUco boards: their names, and views that show them whole, in part and differently in left and right."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache

import cv2
import numpy as np
import pytest

from stereo_pick.core.calibration import aruco
from stereo_pick.core.calibration.any_board import parse_board
from stereo_pick.core.calibration.boards import Chessboard
from stereo_pick.core.calibration.charuco import CharucoBoard
from stereo_pick.core.calibration.detection import BoardImages, detect
from stereo_pick.core.calibration.detectors import SeenCorners, board_view, finders
from stereo_pick.core.calibration.parameters import USUAL, rig_vector
from stereo_pick.core.calibration.result import CalibrationResult
from stereo_pick.core.calibration.solving import calibrate, calibrate_best
from stereo_pick.core.calibration.views import BoardView, Detections, RejectedView
from stereo_pick.core.camera import Camera
from stereo_pick.core.errors import ArrayError, CalibrationError, ParameterError
from stereo_pick.core.transform import Transform

BOARD = CharucoBoard(8, 6, 0.025, 0.75, "5X5_100")
SIZE_PX = (480, 360)
K = np.array([[620.0, 0, 245], [0, 625, 178], [0, 0, 1]])
right_T_left = Transform(cv2.Rodrigues(np.array([0.01, 0.15, -0.02]))[0], np.array([-0.08, 0.002, 0.009]))
GREY = np.full((360, 480), 128, np.uint8)

needs_aruco = pytest.mark.skipif(not hasattr(cv2, "aruco"), reason="this OpenCV has no aruco module")


def poses(count: int, spread_m: float = 0.02, seed: int = 0) -> list[Transform]:
    """left_T_board of views 0.45 m away; a large spread leaves a part of the board outside the image."""
    rng = np.random.default_rng(seed)
    made = []
    for _ in range(count):
        R = cv2.Rodrigues(rng.uniform(-0.5, 0.5, 3) * [1, 1, 0.6])[0]
        centre = np.array([0.03, 0, 0.45]) + rng.uniform(-1, 1, 3) * [spread_m, spread_m, 0.06]
        made.append(Transform(R, centre - R @ BOARD.object_points().mean(axis=0)))
    return made


def truth_px(camera_T_board: Transform) -> np.ndarray:
    points = camera_T_board.apply(BOARD.object_points()) @ K.T
    return points[:, :2] / points[:, 2:]


def pairs(render_charuco, left_T_boards: Sequence[Transform], board: CharucoBoard = BOARD, legacy: bool = False):
    for i, pose in enumerate(left_T_boards):
        left, right = (
            render_charuco(board, K, camera_T_board, SIZE_PX, legacy) for camera_T_board in (pose, right_T_left @ pose)
        )
        yield BoardImages(f"pair{i}", f"left{i}", f"right{i}", left, right)


def assert_is_rig(result: CalibrationResult) -> None:
    np.testing.assert_allclose(result.rig.left.K, K, atol=3)
    np.testing.assert_allclose(result.rig.right.K, K, atol=3)
    np.testing.assert_allclose(result.rig.right_T_left.translation, right_T_left.translation, atol=5e-4)
    np.testing.assert_allclose(result.rig.right_T_left.rotation, right_T_left.rotation, atol=2e-3)
    assert abs(result.rig.baseline_m - np.linalg.norm(right_T_left.translation)) < 4 * result.baseline_sigma_m


@pytest.mark.parametrize(
    "text", ["charuco:11x8:0.75:5X5_100", "ChArUco: 11 x 8 : .75 : DICT_5x5_100", "charuco:11×8:22.5mm:5X5_100"]
)
def test_board_is_read_from_text(text: str) -> None:
    board = parse_board(text, 0.03)
    assert board == CharucoBoard(11, 8, 0.03, 0.75, "5X5_100")
    assert parse_board(str(board), 0.03) == board


@pytest.mark.parametrize("text", ["9x6", "chessboard:9x6"])
def test_chessboards_are_read_too(text: str) -> None:
    assert parse_board(text, 0.03) == Chessboard(9, 6, 0.03)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("circles:9x6", r"chessboard:9x6 .* charuco:11x8:0\.75:5X5_100"),
        ("charuco:11x8", r"write charuco:11x8:0\.75:5X5_100"),
        ("charuco:11x8:5X5_100:0.75", r"write charuco:11x8:0\.75:5X5_100"),
        ("charuco:11x8:0.022:5X5_100", r"0\.022 squares is outside .* 22mm"),
        ("charuco:11x8:0.75:5X5_99", r"no dictionary '5X5_99': choose from .*5X5_100"),
        ("charuco:11x10:0.75:5X5_50", "holds 55 markers, but the dictionary 5X5_50 has 50"),
        ("charuco:3x3:0.75:5X5_50", "at least 4x3"),
    ],
)
def test_text_that_is_no_board_is_refused(text: str, message: str) -> None:
    with pytest.raises(ParameterError, match=message):
        parse_board(text, 0.03)


def test_square_in_millimetres_is_refused() -> None:
    with pytest.raises(ParameterError, match="millimetres"):
        parse_board("charuco:11x8:22mm:5X5_100", 30)


@needs_aruco
@pytest.mark.parametrize("columns", [8, 7])
@pytest.mark.parametrize("rows", [6, 5])
def test_corners_are_found_where_they_are(render_charuco, columns: int, rows: int) -> None:
    board = CharucoBoard(columns, rows, 0.025, 0.75, "4X4_50")
    pose = poses(1)[0]
    found = next(iter(finders(board).values()))(render_charuco(board, K, pose, SIZE_PX))
    assert found is not None
    np.testing.assert_array_equal(found.seen, np.arange(board.corner_count))
    points = pose.apply(board.object_points()) @ K.T
    np.testing.assert_allclose(found.px, points[:, :2] / points[:, 2:], atol=0.3)


@needs_aruco
def test_an_image_without_a_board_shows_no_corners() -> None:
    assert [find(GREY) for find in finders(BOARD).values()] == [None] * len(finders(BOARD))


@needs_aruco
def test_a_chessboard_and_a_board_of_other_markers_are_no_such_board(render_board, render_charuco) -> None:
    find = next(iter(finders(BOARD).values()))
    assert find(render_board(Chessboard(7, 5, 0.025), K, poses(1)[0], SIZE_PX)) is None
    other = CharucoBoard(8, 6, 0.025, 0.75, "4X4_50")
    assert find(render_charuco(other, K, poses(1)[0], SIZE_PX)) is None


@needs_aruco
def test_whole_boards_give_the_rig(render_charuco) -> None:
    result = calibrate_best(detect(pairs(render_charuco, poses(12, spread_m=0.04)), BOARD), BOARD)
    assert len(result.used) >= 11
    assert result.detector == "ChArUco"
    assert_is_rig(result)


@needs_aruco
def test_boards_seen_in_part_give_the_rig(render_charuco) -> None:
    found = detect(pairs(render_charuco, poses(20, spread_m=0.1)), BOARD)[0]
    counts = [len(view.left_px) for view in found.views]
    assert min(counts) < 20 < max(counts)
    result = calibrate_best([found], BOARD)
    assert len(result.used) >= 12
    assert_is_rig(result)


@needs_aruco
def test_each_image_of_a_pair_counts_with_all_that_it_shows(render_charuco) -> None:
    pose = poses(1)[0]
    pair = next(pairs(render_charuco, [pose]))
    covered = pair.right.copy()
    covered[:, :200] = 128
    found = detect([BoardImages("pair", "left", "right", pair.left, covered)], BOARD)[0]
    view = found.views[0]
    left_seen, right_seen = view.seen
    assert 6 <= len(right_seen) < len(left_seen) == BOARD.corner_count
    np.testing.assert_allclose(view.left_px, truth_px(pose)[left_seen], atol=0.3)
    np.testing.assert_allclose(view.right_px, truth_px(right_T_left @ pose)[right_seen], atol=0.3)


@needs_aruco
@pytest.mark.skipif(not aruco.LEGACY, reason="this OpenCV knows no legacy pattern")
def test_a_board_printed_by_an_older_opencv_is_known_by_its_corners(render_charuco) -> None:
    result = calibrate_best(detect(pairs(render_charuco, poses(12, spread_m=0.04), legacy=True), BOARD), BOARD)
    assert result.detector == "ChArUco, legacy pattern"
    assert_is_rig(result)


@needs_aruco
def test_recording_without_the_board_says_what_to_check() -> None:
    with pytest.raises(CalibrationError, match=r"no ChArUco board of 8x6 squares .* name the dictionary"):
        detect([BoardImages("pair", "left.png", "right.png", GREY, GREY)], BOARD)


def test_without_aruco_the_error_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(aruco, "_ARUCO", None)
    monkeypatch.setattr(aruco, "_NEW", False)
    with pytest.raises(CalibrationError, match="without its aruco module.*: install"):
        aruco.charuco_corners(GREY, BOARD)


def exact_views(count: int, noise_px: float, share: float, seed: int = 0) -> list[BoardView]:
    """Views of some of the corners, chosen at random in each image."""
    rng = np.random.default_rng(seed)
    views = []
    for i, pose in enumerate(poses(count, seed=seed)):
        seen = [np.flatnonzero(rng.random(BOARD.corner_count) < share) for _ in range(2)]
        left, right = (
            truth_px(p)[ids] + noise_px * rng.normal(size=(len(ids), 2))
            for p, ids in zip((pose, right_T_left @ pose), seen)
        )
        views.append(BoardView(f"pair{i}", left, right, *seen))
    return views


def test_exact_corners_in_part_give_the_exact_rig() -> None:
    result = calibrate(exact_views(12, noise_px=0, share=0.5), SIZE_PX, BOARD)
    np.testing.assert_allclose(result.rig.left.K, K, atol=0.01)
    np.testing.assert_allclose(result.rig.right_T_left.translation, right_T_left.translation, atol=1e-6)


@cache
def seen_in_part() -> list[CalibrationResult]:
    """A hundred calibrations of one rig, each from ten views of its own of a board that leaves both images."""
    return [calibrate(leaving_views(12, noise_px=0.1, seed=seed), SIZE_PX, BOARD) for seed in range(100)]


def leaving_views(count: int, noise_px: float, seed: int) -> list[BoardView]:
    """Views of what each image shows of a board that is half outside; of those that share too little, others."""
    rng = np.random.default_rng(seed)
    views = list[BoardView]()
    for i, pose in enumerate(poses(5 * count, spread_m=0.1, seed=seed)):
        left, right = (in_image(truth_px(p) + noise_px * rng.normal(size=(35, 2))) for p in (pose, right_T_left @ pose))
        view = board_view(f"pair{i}", left, right, BOARD)
        if isinstance(view, BoardView) and min(map(len, view.seen)) < BOARD.corner_count:
            views.append(view)
    return views[:count]


def in_image(corners_px: np.ndarray) -> SeenCorners:
    seen = np.flatnonzero(((corners_px > 5) & (corners_px < np.array(SIZE_PX) - 5)).all(axis=1))
    return SeenCorners(corners_px[seen], seen)


def test_left_and_right_show_different_parts_of_a_board_that_leaves_them() -> None:
    seen = [view.seen for view in seen_in_part()[0].views]
    assert sum(list(left) != list(right) for left, right in seen) >= 8


def test_stated_uncertainties_cover_the_truth_where_boards_are_seen_in_part() -> None:
    cameras = [Camera(side, *SIZE_PX, K, np.zeros(5), np.eye(3), np.eye(3, 4)) for side in ("left", "right")]
    truth = rig_vector(cameras[0], cameras[1], right_T_left)
    free = USUAL.free
    errors = np.array([(result.solution.parameters - truth)[free] for result in seen_in_part()])
    sigmas = np.array([result.uncertainty.sigma[free] for result in seen_in_part()])
    for of_sigma, claimed, allowed in ((1.0, 0.683, 0.07), (1.96, 0.95, 0.04)):
        assert (np.abs(errors) < of_sigma * sigmas).mean() == pytest.approx(claimed, abs=allowed)


def test_noise_is_told_from_the_corners_there_are() -> None:
    sigma_px = [result.solution.sigma_px for result in seen_in_part()]
    assert np.sqrt(np.mean(np.square(sigma_px))) == pytest.approx(0.1, rel=0.02)


def test_held_out_errors_are_those_of_the_corners_that_both_images_show() -> None:
    result = seen_in_part()[0]
    held_out = result.held_out
    assert held_out is not None
    assert len(held_out.epipolar_px) == sum(len(np.intersect1d(*view.seen)) for view in result.views)
    assert held_out.epipolar_rms_px == pytest.approx(0.1 * np.sqrt(2), rel=0.3)
    assert 0 < held_out.length_rms_m < 0.001


def apart(view: BoardView) -> BoardView:
    """The board's first half in the left image, the rest of it in the right one."""
    left, right = view.seen
    return view.keep(left < BOARD.corner_count // 2, right >= BOARD.corner_count // 2)


def test_images_that_never_show_the_same_part_of_a_board_are_refused() -> None:
    views = [apart(view) for view in exact_views(8, noise_px=0.1, share=1.0)]
    with pytest.raises(CalibrationError, match="none of 8 pairs shows two corners of one row or column"):
        calibrate(views, SIZE_PX, BOARD)


def test_a_view_that_shows_no_corner_twice_is_left_out_of_the_held_out_errors_only() -> None:
    views = exact_views(8, noise_px=0.1, share=1.0)
    found = Detections("given", SIZE_PX, (apart(views[0]), *views[1:]), ())
    result = calibrate_best([found, found], BOARD)
    assert len(result.views) == 8
    assert result.held_out is not None
    assert len(result.held_out.epipolar_px) == 7 * BOARD.corner_count
    assert result.held_out.epipolar_rms_px < 0.3 and result.held_out.length_rms_m < 0.001


def test_corners_that_only_one_image_shows_count_too() -> None:
    views = leaving_views(12, noise_px=0.1, seed=0)
    more, less = (calibrate(each, SIZE_PX, BOARD) for each in (views, [view.in_both() for view in views]))
    assert more.uncertainty.sigmas["left.fx"] < less.uncertainty.sigmas["left.fx"]


def test_a_pair_of_two_moments_is_rejected_by_name() -> None:
    views = exact_views(12, noise_px=0.1, share=0.6)
    moved = BoardView("pair4", views[4].left_px, views[4].right_px + [3.0, 2.0], *views[4].seen)
    result = calibrate([*views[:4], moved, *views[5:]], SIZE_PX, BOARD)
    assert [view.name for view in result.rejected] == ["pair4"]


def test_corners_beyond_the_board_are_refused() -> None:
    views = exact_views(4, noise_px=0, share=0.5)
    with pytest.raises(CalibrationError, match="no part of a charuco:4x3"):
        calibrate(views, SIZE_PX, CharucoBoard(4, 3, 0.025, 0.75, "5X5_100"))
    with pytest.raises(CalibrationError, match="no part of a 7x5"):
        calibrate(views, SIZE_PX, Chessboard(7, 5, 0.025))


def seen_corners(seen: Sequence[int]) -> SeenCorners:
    return SeenCorners(truth_px(poses(1)[0])[list(seen)], np.array(seen))


@pytest.mark.parametrize(
    ("left", "right", "enough"),
    [
        (range(35), range(35), True),
        (range(14), range(7, 35), False),  # one row in common
        (range(15), range(7, 35), False),  # one row and a corner
        (range(16), range(7, 35), True),
        ([0, 1, 7, 8, 14, 21, 28], range(35), True),
        ([0, 1, 7, 14, 21, 28], range(35), False),
        (range(5), range(30, 35), False),
    ],
)
def test_a_pair_counts_where_common_corners_span_a_plane(left: Sequence[int], right: Sequence[int], enough: bool):
    outcome = board_view("pair", seen_corners(left), seen_corners(right), BOARD)
    assert isinstance(outcome, BoardView) == enough
    if isinstance(outcome, RejectedView):
        assert f"({len(left)} left, {len(right)} right)" in outcome.reason


@pytest.mark.parametrize("seen", [[1, 0], [0, 0], [-1, 2], [[0, 1]]])
def test_indices_that_do_not_grow_are_refused(seen: list[int]) -> None:
    with pytest.raises(ArrayError, match="ascending"):
        BoardView("pair", np.zeros((2, 2)), np.zeros((2, 2)), None, np.array(seen * 2 if len(seen) == 1 else seen))
