"""The drawings tell the truth: what is at a pixel, or a place in space, is drawn there at the scale stated."""

from __future__ import annotations

import base64
import re
import xml.etree.ElementTree as ET
from collections.abc import Callable
from functools import cache

import cv2
import numpy as np
import pytest
from page_reading import circles, drawings, drawn, parsed, tables, words
from simulated_views import BOARD, RIG, SIZE_PX, make_views, rig_with, rotation

from stereo_pick.core.arrays import Image
from stereo_pick.core.calibration.detection import BoardImages
from stereo_pick.core.calibration.result import CalibrationResult
from stereo_pick.core.calibration.solving import calibrate
from stereo_pick.core.calibration.views import BoardView
from stereo_pick.core.calibration_page.coverage import coverage_figure, coverage_section
from stereo_pick.core.calibration_page.drawing import Box, drawing, nice, ticks
from stereo_pick.core.calibration_page.epipolar import epipolar_section, spread
from stereo_pick.core.calibration_page.evidence import corners
from stereo_pick.core.calibration_page.points import points_section
from stereo_pick.core.calibration_page.residuals import arrows_section
from stereo_pick.core.calibration_page.rig import rig_section
from stereo_pick.core.frames import StereoFrame
from stereo_pick.core.rectification import Rectifier
from stereo_pick.core.transform import Transform

WIDTH, HEIGHT = SIZE_PX


@cache
def result() -> CalibrationResult:
    return calibrate(make_views(9, noise_px=0.15), SIZE_PX, BOARD)


def relative_lines(path: str) -> np.ndarray:
    """Each "Mx yldx dy" of a path as x, y, dx, dy."""
    return np.array([re.split("[ l]", part) for part in path.split("M")[1:]], float)


def border(svg: ET.Element) -> list[float]:
    (frame,) = [each for each in svg.findall("rect") if each.get("fill") == "none"]
    return [float(frame.get(name)) for name in ("x", "y", "width", "height")]


def test_a_corner_is_drawn_at_its_pixel() -> None:
    left_px, right_px = np.array([[100.0, 50.0], [639.25, 0.0]]), np.array([[12.5, 479.0]])
    root = parsed(coverage_figure(SIZE_PX, left_px, right_px))
    left, right = drawings(root).values()
    assert circles(left) == [(100.0, 50.0), (639.25, 0.0)]
    assert circles(right) == [(12.5, 479.0)]
    for svg in (left, right):
        assert border(svg) == [-0.5, -0.5, WIDTH, HEIGHT]
        x, y, width, height = map(float, svg.get("viewBox").split())
        assert x < -0.5 < WIDTH - 0.5 < x + width
        assert y < -0.5 < HEIGHT - 0.5 < y + height


def test_all_corners_of_all_used_views_are_drawn() -> None:
    root = parsed(coverage_section(result()))
    for side, svg in zip(("left_px", "right_px"), drawings(root).values()):
        expected = np.concatenate([getattr(view, side) for view in result().views])
        np.testing.assert_allclose(circles(svg), expected, atol=0.0051)


def test_cells_without_a_corner_are_crossed() -> None:
    centres = np.stack(np.meshgrid(np.arange(8) * 80 + 39.5, np.arange(6) * 80 + 39.5), axis=-1).reshape(-1, 2)
    kept = np.delete(centres, [0, 10, 47], axis=0)
    root = parsed(coverage_figure(SIZE_PX, kept, centres))
    left, right = drawings(root).values()
    crossed = [(float(cell.get("x")) + 40, float(cell.get("y")) + 40) for cell in left.findall("g/rect")]
    assert crossed == [tuple(centres[i]) for i in (0, 10, 47)]
    assert right.findall("g/rect") == []
    assert "Left: 3 of 48 cells crossed; right: 0 of 48" in words(root)


def test_residuals_are_those_of_the_solution() -> None:
    for side, each in enumerate(corners(result())):
        np.testing.assert_allclose(
            each.residuals_px,
            np.concatenate([view[side] for view in result().solution.residuals_px]),
            rtol=0,
            atol=1e-9,
        )


def test_arrows_go_from_the_corner_along_the_residual_at_the_scale_stated() -> None:
    root = parsed(arrows_section(result()))
    times = float(re.search(r"drawn ([\d.e+]+) times", words(root))[1])
    for side, svg in enumerate(drawings(root).values()):
        arrows = relative_lines(svg.find("path").get("d"))
        seen_px = np.concatenate([(view.left_px, view.right_px)[side] for view in result().views])
        residuals_px = np.concatenate([view[side] for view in result().solution.residuals_px])
        np.testing.assert_allclose(arrows[:, :2], seen_px, atol=0.0051)
        np.testing.assert_allclose(arrows[:, 2:], times * residuals_px, atol=0.0051)
        np.testing.assert_allclose(circles(svg), arrows[:, :2] + arrows[:, 2:], atol=0.02)


def test_ruler_is_as_long_as_it_says() -> None:
    root = parsed(arrows_section(result()))
    times = float(re.search(r"drawn ([\d.e+]+) times", words(root))[1])
    for svg in drawings(root).values():
        (ruler,) = [each for each in svg.iter("g") if each.get("class") == "ruler"]
        line, said_px = ruler.find("line"), float(ruler.find("text").text.removesuffix(" px"))
        assert float(line.get("x2")) - float(line.get("x1")) == pytest.approx(times * said_px, abs=0.02)


@pytest.mark.parametrize(("view", "axis"), [("from above", 0), ("from the side", 1)])
def test_rig_and_boards_are_drawn_in_mm_where_they_stand(view: str, axis: int) -> None:
    exact = calibrate(make_views(6), SIZE_PX, BOARD)
    svg = drawn(parsed(rig_section(exact)), view)
    edges = [relative_lines(path.get("d")) for path in svg.iter("path")]
    centres_mm = np.zeros(3), RIG.right_T_left.inverse().translation * 1000
    for lines, centre_mm in zip(edges, centres_mm, strict=True):
        np.testing.assert_allclose(lines[:4, :2], np.tile(centre_mm[[2, axis]], (4, 1)), atol=0.02)
    grid = np.arange(BOARD.corner_count).reshape(BOARD.rows, BOARD.columns)
    ends = [grid[0, 0], grid[0, -1], grid[-1, -1], grid[-1, 0]]
    outlines = [each.get("points") for each in svg.iter("polygon")]
    for text, pose in zip(outlines, exact.solution.poses, strict=True):
        found = np.array([[float(n) for n in pair.split(",")] for pair in text.split()])
        expected = pose.apply(BOARD.object_points()[ends])[:, [2, axis]] * 1000
        np.testing.assert_allclose(found, expected, atol=0.0051)


def test_field_of_view_is_the_cameras() -> None:
    exact = calibrate(make_views(6), SIZE_PX, BOARD)
    left = relative_lines(next(drawn(parsed(rig_section(exact)), "from above").iter("path")).get("d"))[:4]
    slopes = np.unique(np.round(left[:, 3] / left[:, 2], 3))
    K = RIG.left.K
    np.testing.assert_allclose(slopes, [-K[0, 2] / K[0, 0], (WIDTH - 1 - K[0, 2]) / K[0, 0]], atol=0.002)


def test_map_holds_the_sigma_of_the_point_in_the_middle_of_each_cell() -> None:
    root, seen = parsed(points_section(result())), 0
    left, right, right_T_left = result().solution.cameras
    for svg, row in zip(drawings(root).values(), result().point_sigmas, strict=True):
        cells = [each for each in svg.findall("rect") if each.get("fill") != "none"]
        for cell, label in zip(cells, svg.findall("text"), strict=True):
            x, y, width, height = (float(cell.get(name)) for name in ("x", "y", "width", "height"))
            xyz = np.append(left.normalized([[x + width / 2, y + height / 2]])[0], 1) * row.depth_m
            u, v = right.project(right_T_left.apply(xyz[None]))[0]
            if not (-0.5 < u < WIDTH - 0.5 and -0.5 < v < HEIGHT - 0.5):
                assert label.text == "–"
                continue
            seen += 1
            sigma_mm = np.sqrt(np.trace(result().uncertainty.point_covariance(xyz)[0])) * 1000
            assert float(label.text) == pytest.approx(sigma_mm, abs=0.0051, rel=1e-3)
    assert seen > 30


@pytest.fixture(scope="module")
def rendered(render_board: Callable[..., Image]) -> tuple[BoardView, BoardImages]:
    """A rendered pair of a rig without distortion, with the true corners."""
    rig = rig_with((0.0,) * 5, (0.0,) * 5)
    R = rotation(0.3, -0.2, 0.1)
    left_T_board = Transform(R, np.array([0.0, 0.0, 0.6]) - R @ BOARD.object_points().mean(axis=0))
    left = render_board(BOARD, rig.left.K, left_T_board, SIZE_PX)
    right = render_board(BOARD, rig.right.K, rig.right_T_left @ left_T_board, SIZE_PX)
    view = BoardView("pair <1>", *rig.project(left_T_board.apply(BOARD.object_points())))
    return view, BoardImages("pair <1>", "l", "r", left, right)


def embedded(svg: ET.Element) -> list[tuple[np.ndarray, float]]:
    """The pictures in a drawing and the column where each begins."""
    found = []
    for picture in svg.iter("image"):
        data = base64.b64decode(picture.get("href").removeprefix("data:image/jpeg;base64,"))
        assert (float(picture.get("width")), float(picture.get("height"))) == SIZE_PX
        found.append((cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_UNCHANGED), float(picture.get("x"))))
    return found


def test_pictures_are_the_rectified_pair(rendered: tuple[BoardView, BoardImages]) -> None:
    rig, (view, images) = rig_with((0.0,) * 5, (0.0,) * 5), rendered
    pair = Rectifier(rig).rectify(StereoFrame(images.left, images.right))
    svg = drawn(parsed(epipolar_section(rig, view, images)), "rectified pair")
    for (picture, _), expected in zip(embedded(svg), (pair.left, pair.right), strict=True):
        assert np.abs(picture.astype(float) - expected).mean() < 3


def test_rings_are_around_the_corners_that_the_pictures_show(rendered: tuple[BoardView, BoardImages]) -> None:
    rig, (view, images) = rig_with((0.0,) * 5, (0.0,) * 5), rendered
    svg = drawn(parsed(epipolar_section(rig, view, images)), "rectified pair")
    (left, left_x), (right, right_x) = embedded(svg)
    rings = np.unique(circles(svg), axis=0)
    assert len(rings) >= 8
    for x, y in rings:
        picture, start = (left, left_x) if x < right_x else (right, right_x)
        at = np.array([[x - start - 0.5, y]], np.float32)
        shown = cv2.cornerSubPix(picture, at.copy(), (4, 4), (-1, -1), (3, 50, 1e-3))
        assert np.linalg.norm(shown - at) < 0.3


def test_row_differences_are_those_of_the_rings(rendered: tuple[BoardView, BoardImages]) -> None:
    rig, (view, images) = rig_with((0.0,) * 5, (0.0,) * 5), rendered
    shifted = BoardView(view.name, view.left_px, view.right_px + [0, 0.5])
    root = parsed(epipolar_section(rig, shifted, images))
    rows = np.array(tables(root)["The corners on the lines, in the rectified images"], float)
    scale = rig.focal_px / rig.right.K[1, 1]
    np.testing.assert_allclose(rows[:, 5], 0.5 * scale, atol=0.06)
    np.testing.assert_allclose(rows[:, 5], rows[:, 4] - rows[:, 2], atol=0.011)
    left, right = np.array(circles(drawn(root, "rectified pair"))).reshape(-1, 4, 2)[:, [0, 2]].transpose(1, 0, 2)
    np.testing.assert_allclose(left, rows[:, 1:3], atol=0.011)
    np.testing.assert_allclose(right[:, 1], rows[:, 4], atol=0.011)
    said_px = float(re.search(r"rows differ by ([\d.]+) px rms", words(root))[1])
    assert said_px == pytest.approx(0.5 * scale, abs=0.05)


def test_large_pictures_are_made_smaller_and_stay_in_place(render_board: Callable[..., Image]) -> None:
    big = (1080, 810)
    R, at = rotation(0.1, 0.1, 0), np.array([-0.1, -0.07, 0.6])
    K = RIG.left.K * [[1.69], [1.69], [1]]
    picture = render_board(BOARD, K, Transform(R, at), big)
    cameras = [type(RIG.left)(name, *big, K, np.zeros(5), np.eye(3), np.eye(3, 4)) for name in ("left", "right")]
    rig = type(RIG).from_extrinsics(*cameras, Transform(np.eye(3), np.array([-0.05, 0, 0])))
    view = BoardView("big", *rig.project(BOARD.object_points() @ R.T + at))
    svg = drawn(parsed(epipolar_section(rig, view, BoardImages("", "", "", picture, picture))), "rectified pair")
    image = next(svg.iter("image"))
    decoded = cv2.imdecode(
        np.frombuffer(base64.b64decode(image.get("href").partition(",")[2]), np.uint8), cv2.IMREAD_UNCHANGED
    )
    assert decoded.shape == (750, 1000)
    assert (float(image.get("width")), float(image.get("height"))) == big


def test_lines_are_spread_over_the_rows() -> None:
    rows_px = np.random.default_rng(0).uniform(0, 400, 300)
    chosen = rows_px[spread(rows_px, 20.0)]
    assert 7 <= len(chosen) <= 10
    assert (np.diff(chosen) >= 20).all()
    assert list(spread(np.array([5.0, 5.1]), 20.0)) == [0]


@pytest.mark.parametrize(("low", "high"), [(0, 640), (-0.5, 479.5), (-210, 1150), (0.0, 0.03)])
def test_ticks_are_round_and_within(low: float, high: float) -> None:
    values = ticks(low, high)
    assert 4 <= len(values) <= 11
    assert low <= values[0] and values[-1] <= high
    np.testing.assert_allclose(np.diff(values), nice((high - low) / 4), rtol=1e-9)


@pytest.mark.parametrize(("value", "expected"), [(1, 1), (4.99, 2), (5, 5), (99, 50), (0.03, 0.02), (2000, 2000)])
def test_nice_is_the_round_number_below(value: float, expected: float) -> None:
    assert nice(value) == pytest.approx(expected)


def test_text_and_lines_keep_their_size_on_the_page() -> None:
    for width in (320, 3200):
        svg = ET.fromstring(drawing(Box(0, 0, width, 10), "words"))
        assert float(svg.get("font-size")) / width == pytest.approx(12 / 440, rel=1e-3)
