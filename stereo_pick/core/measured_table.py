"""The table, as a calibration board that lies on it shows it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from stereo_pick.core.arrays import Floats
from stereo_pick.core.calibration.any_board import Board
from stereo_pick.core.calibration.views import BoardView
from stereo_pick.core.errors import ArrayError, CalibrationError, ParameterError
from stereo_pick.core.rays import closest_points
from stereo_pick.core.rig import StereoRig
from stereo_pick.core.shapes.table import TILT_RAD, Table

_THICKEST_M = 0.1
_ROWS_APART_PX = 1.5  # as far as outlines of one object may be: `feature.epipolar_tolerance_px`
_WRONG_SCALE = 0.02
_FLAT_M = 0.001  # so far a table may be from a plane, in the middle
_NOISE = 3.0


@dataclass(frozen=True, eq=False)
class MeasuredTable:
    """table: in the rectified left frame; rms_m: distance of the corners from one plane [m]; tilt_rad: one sigma of its
    tilt by their noise; square_m: the side of a square as the rig measures it [m]."""

    table: Table
    rms_m: float
    tilt_rad: float
    square_m: float


def table_under(views: Sequence[BoardView], board: Board, thickness_m: float, rig: StereoRig) -> MeasuredTable:
    """The plane that a board of this thickness [m] lies on in all views.

    Raises ParameterError where no board is so thick, CalibrationError where the board does not lie on one plane, where
    the views do not fit the rig, or show too little, and where the cameras see the table from below or edge-on.
    """
    if not 0 <= thickness_m <= _THICKEST_M:
        raise ParameterError(
            f"thickness = {thickness_m:g} m must be between 0 and {_THICKEST_M:g} m: that of the board, in metres"
        )
    views = [view.in_both() for view in views]
    corners = [_corners_m(view, rig) for view in views]
    square_m = _checked_square_m(views, corners, board)
    points = np.concatenate(corners)
    middle, normal, spread_m = _plane(points)
    _check_common([view.name for view in views], corners, middle, normal)
    rms_m = _rms((points - middle) @ normal)
    if not rms_m < TILT_RAD * spread_m:
        raise CalibrationError(
            f"the {len(points)} corners that both cameras see lie too close to one line to tell how the table is "
            "tilted: show more of the board"
        )
    table = Table(normal, thickness_m - float(normal @ middle), rms_m)
    return MeasuredTable(_checked(table), rms_m, rms_m / spread_m, square_m)


def _corners_m(view: BoardView, rig: StereoRig) -> Floats:
    """The corners (N, 3) [m] of the board in the rectified left frame; raises CalibrationError where rays miss."""
    left_px, right_px = rig.left.rectified(view.left_px), rig.right.rectified(view.right_px)
    left, right = closest_points(rig.left.rays(left_px), rig.right.rays(right_px), rig.right_T_left)
    rows_apart_px = float(np.median(np.abs(left_px[:, 1] - right_px[:, 1])))
    if rows_apart_px > _ROWS_APART_PX or left[:, 2].min() <= 0:
        raise CalibrationError(
            f"{view.name}: the corners of the board do not fit the calibration ({rows_apart_px:.1f} rows apart in the "
            "rectified views): it is of other cameras, or one has moved since, or left and right are exchanged"
        )
    return np.asarray((left + right) / 2 @ rig.left.R.T)


def _checked_square_m(views: Sequence[BoardView], corners: Sequence[Floats], board: Board) -> float:
    """The side of a square as the rig measures it; raises CalibrationError where that is another board's."""
    ratio = float(np.mean([_scale(view, points, board) for view, points in zip(views, corners, strict=True)]))
    square_m = ratio * board.square_m
    if abs(ratio - 1) > _WRONG_SCALE:
        raise CalibrationError(
            f"the squares of the board measure {square_m * 1000:.2f} mm by this calibration, and --square says "
            f"{board.square_m * 1000:g} mm: one of them is wrong, or the images are of another rig"
        )
    return square_m


def _scale(view: BoardView, corners: Floats, board: Board) -> float:
    """By how much larger the board seems than it is."""
    true, _ = view.points(board)
    seen, known = (np.linalg.norm(each - each.mean(axis=0)) for each in (corners, true))
    return float(seen / known)


def _check_common(names: Sequence[str], corners: Sequence[Floats], middle: Floats, normal: Floats) -> None:
    """Raise CalibrationError where the board is not on the plane through a middle (3,) in all views."""
    rms_m = [_rms((each - middle) @ normal) for each in corners]
    own_m = _rms(np.concatenate([(each - mean) @ own for each in corners for mean, own, _ in (_plane(each),)]))
    worst = int(np.argmax(rms_m))
    if rms_m[worst] > _NOISE * own_m + _FLAT_M:
        raise CalibrationError(
            f"{names[worst]}: the board is {rms_m[worst] * 1000:.1f} mm off the plane that all views have in "
            "common: lay it on the table, flat, in each of them"
        )


def _plane(points: Floats) -> tuple[Floats, Floats, float]:
    """The middle (3,) of points (N, 3), the normal (3,) of their plane, towards the cameras, and how far they are
    spread along the lesser of its two directions: the root of the sum of squares [m]."""
    middle = points.mean(axis=0)
    _, spread_m, axes = np.linalg.svd(points - middle, full_matrices=False)
    normal = axes[2]
    return middle, np.asarray(-normal if normal @ middle > 0 else normal), float(spread_m[1])


def _rms(distances: Floats) -> float:
    return float(np.sqrt((distances**2).mean()))


def _checked(table: Table) -> Table:
    """The table as the parameter will have it; raises CalibrationError where that refuses it."""
    try:
        return Table.parsed(table.text)
    except ArrayError as error:
        raise CalibrationError(f"the board lies on no table that the cameras see: {error}") from None
