"""One camera at a time: intrinsics, and where the board stood in each view (thesis 3.4, Zhang 2000)."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import NamedTuple

import cv2
import numpy as np

from stereo_pick.core.arrays import Floats, floats
from stereo_pick.core.calibration.any_board import Board
from stereo_pick.core.calibration.lone_corners import Corners, stand_out
from stereo_pick.core.calibration.parameters import transform
from stereo_pick.core.calibration.views import (
    BoardView,
    RejectedCorner,
    RejectedView,
    check_enough,
    outlier_limit_px,
)
from stereo_pick.core.camera import Camera
from stereo_pick.core.errors import ArrayError, CalibrationError
from stereo_pick.core.transform import Transform

_TIGHT = (cv2.TERM_CRITERIA_COUNT + cv2.TERM_CRITERIA_EPS, 100, 1e-9)


@dataclass(frozen=True)
class MonoCalibration:
    """A camera, `camera_T_board` of each view, and each view's rms distance `errors_px` (V,) [px]."""

    camera: Camera
    poses: tuple[Transform, ...]
    errors_px: Floats

    def only(self, views: Sequence[int]) -> MonoCalibration:
        """The same camera with these views alone."""
        return MonoCalibration(self.camera, tuple(self.poses[i] for i in views), self.errors_px[list(views)])


class EachAlone(NamedTuple):
    """Both cameras, the views that they were calibrated from, and what was rejected, now or before."""

    left: MonoCalibration
    right: MonoCalibration
    views: list[BoardView]
    rejected: list[RejectedView]
    rejected_corners: list[RejectedCorner]


def calibrate_cameras(
    views: Sequence[BoardView], size_px: tuple[int, int], board: Board, rejected: Sequence[RejectedView] = ()
) -> EachAlone:
    """Calibrate left and right one by one, leaving out single corners, then (worst first) views that are imprecise.

    Raises CalibrationError where fewer than three are left or the views do not determine a camera.
    """
    kept, out, corners, out_px = list(views), list(rejected), list[RejectedCorner](), list[tuple[float, float]]()
    while True:
        check_enough(kept, out, board)
        left = calibrate_camera("left", [view.left_px for view in kept], size_px, [v.points(board)[0] for v in kept])
        right = calibrate_camera("right", [view.right_px for view in kept], size_px, [v.points(board)[1] for v in kept])
        kept, wrong = without_wrong_corners(board, kept, (left, right))
        if wrong:
            corners += wrong
            continue
        errors_px = np.c_[left.errors_px, right.errors_px]
        limits_px = [outlier_limit_px(errors_px[:, side], [error[side] for error in out_px]) for side in (0, 1)]
        worst, side = (int(i) for i in np.unravel_index((errors_px / limits_px).argmax(), errors_px.shape))
        if errors_px[worst, side] <= limits_px[side]:
            return EachAlone(left, right, kept, out, corners)
        out.append(RejectedView(kept.pop(worst).name, _imprecise(("left", "right")[side], errors_px[:, side], worst)))
        out_px.append((errors_px[worst, 0], errors_px[worst, 1]))


def calibrate_camera(
    name: str, corners_px: Sequence[Floats], size_px: tuple[int, int], points: Sequence[Floats]
) -> MonoCalibration:
    """Calibrate one camera (k1 k2 p1 p2; k3 = 0) from the corners (N, 2) [px] of several views.

    points: each view's corners (N, 3) [m] in the board frame.
    Raises CalibrationError where the views do not determine the camera.
    """
    try:
        with _one_thread():
            _, K, D, rvecs, tvecs, _, _, errors = cv2.calibrateCameraExtended(
                [corners.astype(np.float32) for corners in points],
                [corners.astype(np.float32) for corners in corners_px],
                size_px,
                np.eye(3),
                np.zeros(5),
                flags=cv2.CALIB_FIX_K3,
                criteria=_TIGHT,
            )
        camera = Camera(name, *size_px, floats("K", K, 3, 3), floats("D", D.ravel()[:5], 5), np.eye(3), np.eye(3, 4))
    except (cv2.error, ArrayError, CalibrationError) as error:
        raise CalibrationError(
            f"the {len(corners_px)} views do not determine the {name} camera: tilt the board to all sides, up to "
            f"45 degrees, and move it through the image ({str(error).strip().splitlines()[-1]})"
        ) from None
    poses = tuple(transform(r, t) for r, t in zip(rvecs, tvecs))
    return MonoCalibration(camera, poses, np.asarray(errors, np.float64).ravel())


@contextmanager
def _one_thread() -> Iterator[None]:
    """OpenCV's threads add up in the order in which they end: with one of them the same views give the same bits."""
    threads = cv2.getNumThreads()
    cv2.setNumThreads(1)
    try:
        yield
    finally:
        cv2.setNumThreads(threads)


def _imprecise(side: str, errors_px: Floats, worst: int) -> str:
    return (
        f"corners of the {side} image are off by {errors_px[worst]:.2f} px, those of the other views by "
        f"{np.median(errors_px):.2f} px: over-exposed, blurred or hidden in part"
    )


def without_wrong_corners(
    board: Board, views: Sequence[BoardView], cameras: tuple[MonoCalibration, MonoCalibration]
) -> tuple[list[BoardView], list[RejectedCorner]]:
    """Leave out the corners that stand out of the others in their image, and name them."""
    pictures = [
        Corners(points[:, :2], seen_px - alone.camera.project(alone.poses[i].apply(points)))
        for i, view in enumerate(views)
        for alone, points, seen_px in zip(cameras, view.points(board), view.corners_px)
    ]
    wrong_px = stand_out(pictures)
    kept, rejected = list[BoardView](), list[RejectedCorner]()
    for view, left, right in zip(views, wrong_px[::2], wrong_px[1::2]):
        kept.append(view if not (left.any() or right.any()) else view.keep(left == 0, right == 0))
        for side, off_px, seen in zip(("left", "right"), (left, right), view.seen):
            rejected += [
                RejectedCorner(view.name, side, int(seen[i]), float(off_px[i])) for i in np.flatnonzero(off_px)
            ]
    return kept, rejected
