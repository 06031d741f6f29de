"""The table, as a calibration board that lies on it shows it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from stereo_pick.core.arrays import Floats
from stereo_pick.core.calibration.any_board import Board
from stereo_pick.core.calibration.views import BoardView
from stereo_pick.core.errors import ArrayError, CalibrationError
from stereo_pick.core.rays import closest_points
from stereo_pick.core.rig import StereoRig
from stereo_pick.core.shapes.table import Table

_THICKEST_M = 0.1
_ROWS_APART_PX = 1.5  # as far as outlines of one object may be: `feature.epipolar_tolerance_px`
_WRONG_SCALE = 0.02
_FLAT_M = 0.001  # so far a table may be from a plane, in the middle
_NOISE = 3.0


@dataclass(frozen=True, eq=False)
class MeasuredTable:
    """table: in the rectified left frame; views: of how many pairs; rms_m: distance of the corners from one plane [m];
    tilt_rad: one sigma of its tilt by their noise; square_m: the side of a square as the rig measures it [m]."""

    table: Table
    views: int
    rms_m: float
    tilt_rad: float
    square_m: float


def table_under(views: Sequence[BoardView], board: Board, thickness_m: float, rig: StereoRig) -> MeasuredTable:
    """The plane that a board of this thickness [m] lies on in all views.

    Raises CalibrationError where the board does not lie on one plane, where the views do not fit the rig, and where the
    cameras see the table from below or edge-on.
    """
    if not 0 <= thickness_m <= _THICKEST_M:
        raise CalibrationError(
            f"thickness = {thickness_m:g} m must be between 0 and {_THICKEST_M:g} m: that of the board, in metres"
        )
    corners = [_corners_m(view.in_both(), rig) for view in views]
    square_m = _checked_square_m(views, corners, board)
    normal, rms_m = _common_plane(views, corners)
    points = np.concatenate(corners)
    spread_m = np.linalg.svd(points - points.mean(axis=0), compute_uv=False)[1]
    return MeasuredTable(
        _checked(Table(normal, thickness_m - float(normal @ points.mean(axis=0)), rms_m)),
        len(views),
        rms_m,
        rms_m / float(spread_m),
        square_m,
    )


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
    ratio = float(np.mean([_scale(view.in_both(), points, board) for view, points in zip(views, corners, strict=True)]))
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


def _common_plane(views: Sequence[BoardView], corners: Sequence[Floats]) -> tuple[Floats, float]:
    """The normal (3,), towards the cameras, of the plane on which the board lies in all views, and how far from it
    corners are."""
    points = np.concatenate(corners)
    normal, middle = _normal(points), points.mean(axis=0)
    rms_m = [_rms((each - middle) @ normal) for each in corners]
    own_m = _rms(np.concatenate([(each - each.mean(axis=0)) @ _normal(each) for each in corners]))
    worst = int(np.argmax(rms_m))
    if rms_m[worst] > _NOISE * own_m + _FLAT_M:
        raise CalibrationError(
            f"{views[worst].name}: the board is {rms_m[worst] * 1000:.1f} mm off the plane that all views have in "
            "common: lay it on the table, flat, in each of them"
        )
    return normal, _rms((points - middle) @ normal)


def _normal(points: Floats) -> Floats:
    normal = np.linalg.svd(points - points.mean(axis=0), full_matrices=False)[2][2]
    return np.asarray(-normal if normal @ points.mean(axis=0) > 0 else normal)


def _rms(distances: Floats) -> float:
    return float(np.sqrt((distances**2).mean()))


def _checked(table: Table) -> Table:
    """The table as the parameter will have it; raises CalibrationError where that refuses it."""
    try:
        return Table.parsed(table.text)
    except ArrayError as error:
        raise CalibrationError(f"the board lies on no table that the cameras see: {error}") from None
