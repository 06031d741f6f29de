"""How well a calibration predicts the views that it was not made from (cross-validation)."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from stereo_pick.core.arrays import Floats, Ints, floats
from stereo_pick.core.calibration.any_board import Board
from stereo_pick.core.calibration.refinement import StereoSolution, refine
from stereo_pick.core.calibration.views import MIN_VIEWS, BoardView
from stereo_pick.core.camera import Camera
from stereo_pick.core.errors import CalibrationError
from stereo_pick.core.rays import closest_points
from stereo_pick.core.transform import Transform

FOLDS = 5

Cameras = tuple[Camera, Camera, Transform]


@dataclass(frozen=True, eq=False)
class HeldOut:
    """Errors of views that took no part: epipolar_px (N,) [px], the distance of each right corner from its left
    corner's epipolar line; length_m (M,) [m], the errors of the board's known lengths (its rows, its columns).
    """

    epipolar_px: Floats
    length_m: Floats

    def __post_init__(self) -> None:
        object.__setattr__(self, "epipolar_px", floats("epipolar_px", self.epipolar_px, None))
        object.__setattr__(self, "length_m", floats("length_m", self.length_m, None))

    @property
    def epipolar_rms_px(self) -> float:
        """Rms distance [px] of a corner from its epipolar line."""
        return float(np.sqrt(np.mean(self.epipolar_px**2)))

    @property
    def length_rms_m(self) -> float:
        """Rms error [m] of the board's lengths."""
        return float(np.sqrt(np.mean(self.length_m**2)))


def cross_validate(board: Board, views: Sequence[BoardView], solution: StereoSolution) -> HeldOut | None:
    """Calibrate FOLDS times without a part of the views, and measure on that part; None for too few views.

    solution: the refinement of all the views, from which every fold begins.
    """
    epipolar, length = list[Floats](), list[Floats]()
    for cameras, held in _folds(board, views, solution):
        epipolar += [epipolar_px(cameras, views[i]) for i in held]
        length += [length_errors_m(cameras, views[i], board) for i in held]
    return HeldOut(np.concatenate(epipolar), np.concatenate(length)) if epipolar else None


def typical_epipolar_px(
    board: Board, views: Sequence[BoardView], solution: StereoSolution, measured: Sequence[BoardView]
) -> float | None:
    """Rms epipolar error [px] in the median view of those that took no part; None for too few views.

    measured: the corners to measure on in each of the views; they may be more than were calibrated with. A view
    without a corner that both images show says nothing.
    """
    of_views = [epipolar_px(cameras, measured[i]) for cameras, held in _folds(board, views, solution) for i in held]
    errors_px = [np.sqrt(np.mean(of_view**2)) for of_view in of_views if len(of_view)]
    return float(np.median(errors_px)) if errors_px else None


def check_in_common(views: Sequence[BoardView], board: Board) -> None:
    """Raise CalibrationError where no view shows both cameras the same part of the board: nothing could be measured."""
    if any(_ends_of_lines(view.in_both(), board).size for view in views):
        return
    raise CalibrationError(
        f"none of {len(views)} pairs shows two corners of one row or column of the board in both images, so nothing "
        "tells how well the cameras fit together; take pairs in which both cameras see the same part of the board"
    )


def _folds(board: Board, views: Sequence[BoardView], solution: StereoSolution) -> Iterator[tuple[Cameras, list[int]]]:
    """The cameras without each part of the views, and which views that part is; nothing where too few would be left."""
    folds = min(FOLDS, len(views))
    if len(views) - -(-len(views) // folds) < MIN_VIEWS:
        return
    for fold in range(folds):
        kept = [i for i in range(len(views)) if i % folds != fold]
        poses = [solution.poses[i] for i in kept]
        cameras = refine(board, [views[i] for i in kept], solution.cameras, poses, solution.model).cameras
        yield cameras, list(range(fold, len(views), folds))


def epipolar_px(cameras: Cameras, view: BoardView) -> Floats:
    """Distance (N,) [px] of the right corners from the epipolar lines of the left ones, lens distortion taken out.

    Of the corners that both images show.
    """
    left, right, right_T_left = cameras
    view = view.in_both()
    x, y, z = right_T_left.translation
    essential = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]]) @ right_T_left.rotation
    lines = np.c_[left.normalized(view.left_px), np.ones(len(view.left_px))] @ essential.T
    # In pixels of the right camera without its distortion.
    lines = lines @ np.linalg.inv(right.K)
    pixels = np.c_[right.normalized(view.right_px), np.ones(len(view.right_px))] @ right.K.T
    return np.asarray(np.abs((lines * pixels).sum(axis=1)) / np.linalg.norm(lines[:, :2], axis=1))


def length_errors_m(cameras: Cameras, view: BoardView, board: Board) -> Floats:
    """Errors (N,) [m] of triangulated lengths: each row and column of corners, as far as both images show it."""
    left, right, right_T_left = cameras
    view = view.in_both()
    sides = (left, view.left_px), (right, view.right_px)
    rays = [np.c_[camera.normalized(px), np.ones(len(px))] for camera, px in sides]
    on_left, on_right = closest_points(rays[0], rays[1], right_T_left)
    xyz, (truth, _) = (on_left + on_right) / 2, view.points(board)
    first, last = _ends_of_lines(view, board)
    lengths, true_lengths = (np.linalg.norm(points[last] - points[first], axis=1) for points in (xyz, truth))
    return np.asarray(lengths - true_lengths)


def _ends_of_lines(view: BoardView, board: Board) -> Ints:
    """Places (2, L) in a view of the first and the last corner of each row and of each column; view: `in_both`."""
    return np.concatenate([_ends(line) for line in np.divmod(view.seen[0], board.grid[0])], axis=1)


def _ends(lines: Ints) -> Ints:
    """Places (2, L) of the first and the last corner of each line; lines (N,): the line that each corner is on."""
    first = np.unique(lines, return_index=True)[1]
    last = len(lines) - 1 - np.unique(lines[::-1], return_index=True)[1]
    return np.asarray(np.array([first, last])[:, first < last])
