"""The rectified cameras of a rig (thesis 3.7.3, eq. 3.9): which way they look and at what scale.

Both rectified cameras share one orientation whose x axis is the baseline, one focal length and
one row offset, so that a point lies on the same row in both images. OpenCV's `alpha = 0` zooms
into the largest rectangle without empty pixels, which on a verged rig holds no object any more;
here the focal length stays that of the raw cameras, reduced only as far as the common field of
view needs to fit into images of the raw size.
"""

from __future__ import annotations

from functools import lru_cache

import cv2
import numpy as np
from numpy.typing import NDArray

from stereo_pick.core.arrays import Bools, Floats
from stereo_pick.core.camera import Camera
from stereo_pick.core.errors import CalibrationError
from stereo_pick.core.transform import Transform

_MIN_SCALE = 0.5  # a wide lens has no perspective image of its whole field; the edges go first
_LOST_PERCENT = 0.5  # of the pixels at each border: a lens model may run wild in the far corners
_GRID = 64
_LEAST_COVERED = 0.01  # of a rectified view


def rectified_view(left: Camera, right: Camera, right_T_left: Transform) -> tuple[Camera, Camera]:
    """Return the two cameras with R and P of the rectified view (REP 104: right P[0,3] = -f * baseline).

    The R and P that the cameras came with play no part.
    """
    left_R, right_R = rectifying_rotations(right_T_left)
    left_extent, right_extent = _extent(left, left_R), _extent(right, right_R)
    columns = np.array([left_extent[:, 0], right_extent[:, 0]])
    rows = np.array([left_extent[:, 1], right_extent[:, 1]])
    _check_shared(columns, rows)
    rows = np.array([rows[:, 0].max(), rows[:, 1].min()])

    raw_focal_px = float(np.mean([camera.K[i, i] for camera in (left, right) for i in (0, 1)]))
    fit_width = (min(left.width_px, right.width_px) - 1) / float(np.ptp(columns, axis=1).max())
    fit_height = (min(left.height_px, right.height_px) - 1) / float(np.ptp(rows))
    focal_px = min(raw_focal_px, max(min(fit_width, fit_height), _MIN_SCALE * raw_focal_px))

    baseline_m = float(np.linalg.norm(right_T_left.translation))
    cy = (left.height_px - 1) / 2 - focal_px * float(rows.mean())
    views = []
    for camera, R, extent, tx in ((left, left_R, columns[0], 0.0), (right, right_R, columns[1], -baseline_m)):
        cx = (camera.width_px - 1) / 2 - focal_px * float(extent.mean())
        P = np.array([[focal_px, 0, cx, focal_px * tx], [0, focal_px, cy, 0], [0, 0, 1, 0]])
        views.append(
            Camera(camera.name, camera.width_px, camera.height_px, camera.K, camera.D, R, P, camera.distortion_model)
        )
    return views[0], views[1]


def rectifying_rotations(right_T_left: Transform) -> tuple[Floats, Floats]:
    """Rotations (3, 3) from the left and the right optical frame to the common rectified frame.

    Its x axis points from the left to the right camera; its z axis is as near as can be to the
    mean of the two optical axes (Fusiello et al. 2000).
    """
    left_T_right = right_T_left.inverse()
    x = left_T_right.translation / np.linalg.norm(left_T_right.translation)
    forward = np.array([0.0, 0.0, 1.0]) + left_T_right.rotation[:, 2]
    z = forward - x * float(x @ forward)
    z /= np.linalg.norm(z)
    left_R: Floats = np.array([x, np.cross(z, x), z])
    right_R: Floats = left_R @ left_T_right.rotation
    return left_R, right_R


def _extent(camera: Camera, R: Floats) -> Floats:
    """Bounds (2, 2) of the raw image in normalized rectified coordinates: [[x0, y0], [x1, y1]]."""
    x, y = np.meshgrid(np.linspace(0, camera.width_px - 1, _GRID), np.linspace(0, camera.height_px - 1, _GRID))
    grid = np.c_[x.ravel(), y.ravel()]
    rays = np.c_[camera.normalized(grid), np.ones(len(grid))] @ R.T
    rays = rays[rays[:, 2] > 0.1 * np.linalg.norm(rays, axis=1)]
    points = rays[:, :2] / rays[:, 2:]
    bounds: Floats = np.percentile(points, [_LOST_PERCENT, 100 - _LOST_PERCENT], axis=0)
    return bounds


def _check_shared(columns: Floats, rows: Floats) -> None:
    """Raise CalibrationError where no point before the cameras is in both images, of these normalized bounds (2, 2)."""
    if rows[:, 0].max() < rows[:, 1].min() and columns[0, 1] > columns[1, 0]:
        return
    raise CalibrationError(
        "the two cameras see nothing in common, at any distance: they look past each other; check order, signs and "
        "units of R and T, or calibrate again"
    )


@lru_cache(maxsize=8)
def valid_region(camera: Camera) -> Bools:
    """Mask (H, W), read-only, of the rectified pixels that the raw image covers.

    Raises CalibrationError where these are next to none.
    """
    map_x, map_y = rectification_maps(camera)
    inside: Bools = (map_x >= 0) & (map_x <= camera.width_px - 1) & (map_y >= 0) & (map_y <= camera.height_px - 1)
    if inside.mean() < _LEAST_COVERED:
        raise CalibrationError(
            f"{camera.name} camera: its rectified view shows nothing of its image, with D = "
            f"{np.array2string(camera.D, precision=3)}: calibrate again"
        )
    inside.setflags(write=False)
    return inside


def rectification_maps(camera: Camera) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Raw pixel (float32 x and y, each (H, W)) of every rectified pixel."""
    size = camera.frame_size
    if camera.distortion_model == "equidistant":
        maps = cv2.fisheye.initUndistortRectifyMap(camera.K, camera.D, camera.R, camera.P[:, :3], size, cv2.CV_32FC1)
    else:
        maps = cv2.initUndistortRectifyMap(camera.K, camera.D, camera.R, camera.P[:, :3], size, cv2.CV_32FC1)
    return np.asarray(maps[0], np.float32), np.asarray(maps[1], np.float32)
