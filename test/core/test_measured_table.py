"""The table by a board on it: exact geometry, noise, and what is no table."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from simulated_views import BOARD, RIG, rotation

from stereo_pick.core.arrays import Floats
from stereo_pick.core.calibration.boards import Chessboard
from stereo_pick.core.calibration.views import BoardView
from stereo_pick.core.errors import CalibrationError, ParameterError
from stereo_pick.core.measured_table import MeasuredTable, table_under
from stereo_pick.core.rig import StereoRig
from stereo_pick.core.shapes.table import Table
from stereo_pick.core.transform import Transform

THICKNESS_M = 0.004
CAMERA_T_TABLE = Transform(rotation(2.6, 0.1, 0.2), [0.01, -0.02, 0.62])  # its z axis is the normal
PLACES = (-0.06, -0.04, 0.1), (0.05, -0.05, 1.2), (0.0, 0.05, -0.4)  # x, y [m] and turn [rad] on the table


def lying(x_m: float, y_m: float, turn_rad: float, above_m: float = THICKNESS_M) -> Floats:
    """The board's corners (N, 3) [m] in the raw left frame, its squares up."""
    flat = (BOARD.object_points() - BOARD.object_points().mean(axis=0)) * [1, -1, 1]
    return CAMERA_T_TABLE.apply(flat @ rotation(0.0, 0.0, turn_rad).T + [x_m, y_m, above_m])


def view(number: int, corners_m: Floats, noise_px: float = 0.0, rig: StereoRig = RIG) -> BoardView:
    rng = np.random.default_rng(number)
    left_px, right_px = (px + rng.normal(0, 1, px.shape) * noise_px for px in rig.project(corners_m))
    return BoardView(f"pair {number}", left_px, right_px)


def measured(views: list[BoardView], board: Chessboard = BOARD, thickness_m: float = THICKNESS_M) -> MeasuredTable:
    return table_under(views, board, thickness_m, RIG)


def heights_m(table: Table) -> Floats:
    """How high by this table points of the true one are, all over it."""
    x, y = (each.ravel() for each in np.meshgrid(*[np.linspace(-0.15, 0.15, 5)] * 2))
    return table.height_m(CAMERA_T_TABLE.apply(np.c_[x, y, 0 * x]) @ RIG.left.R.T)


@pytest.mark.parametrize("count", [1, 3])
def test_the_table_is_where_it_is(count: int) -> None:
    found = measured([view(number, lying(*place)) for number, place in enumerate(PLACES[:count])])
    np.testing.assert_allclose(heights_m(found.table), 0, atol=2e-6)  # the text ends at a micrometre
    assert found.square_m == pytest.approx(BOARD.square_m, abs=1e-6)
    assert found.table.normal[2] < 0 and Table.parsed(found.table.text).text == found.table.text


def test_noise_of_corners_is_told_and_averages_out() -> None:
    found = measured([view(number, lying(*place), noise_px=0.1) for number, place in enumerate(PLACES)])
    assert 1e-4 < found.rms_m < 1e-3
    assert np.abs(heights_m(found.table)).max() < found.rms_m
    truth = RIG.left.R @ CAMERA_T_TABLE.rotation[:, 2]
    assert np.arccos(min(1.0, float(found.table.normal @ truth))) < 4 * found.tilt_rad


def test_a_board_in_the_hand_lies_on_no_table() -> None:
    views = [view(number, lying(*place)) for number, place in enumerate(PLACES)]
    views[1] = view(1, lying(*PLACES[1], above_m=0.04))
    with pytest.raises(CalibrationError, match="pair 1: the board is .* mm off the plane .* lay it on the table"):
        measured(views)


def test_squares_of_another_size_are_an_error() -> None:
    views = [view(0, lying(*PLACES[0]))]
    with pytest.raises(CalibrationError, match="measure 25.00 mm by this calibration, and --square says 30 mm"):
        measured(views, replace(BOARD, square_m=0.030))


def test_exchanged_images_and_a_camera_that_has_turned_are_errors() -> None:
    right_way = view(0, lying(*PLACES[0]))
    with pytest.raises(CalibrationError, match="pair 0: the corners of the board do not fit the calibration"):
        measured([BoardView("pair 0", right_way.right_px, right_way.left_px)])
    turned = Transform(rotation(0.005, 0.0, 0.0) @ RIG.right_T_left.rotation, RIG.right_T_left.translation)
    moved = StereoRig.from_extrinsics(RIG.left, RIG.right, turned)
    with pytest.raises(CalibrationError, match=r"3\.7 rows apart"):
        measured([view(0, lying(*PLACES[0]), rig=moved)])


@pytest.mark.parametrize("thickness_m", [-0.001, 3.0, float("nan")])
def test_a_thickness_that_no_board_has(thickness_m: float) -> None:
    with pytest.raises(ParameterError, match="thickness"):
        measured([view(0, lying(*PLACES[0]))], thickness_m=thickness_m)


@pytest.mark.parametrize("noise_px", [0.0, 0.1])
def test_corners_on_one_line_tell_no_plane(noise_px: float) -> None:
    whole = view(0, lying(*PLACES[0]), noise_px)
    row = np.arange(BOARD.columns)
    with pytest.raises(CalibrationError, match="8 corners that both cameras see lie too close to one line"):
        measured([BoardView("pair 0", whole.left_px[row], whole.right_px[row], row, row)])
