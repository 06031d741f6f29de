"""Whether an image shows a larger chessboard than the one named: detectors take a part of it, another in each image."""

from __future__ import annotations

import cv2
import numpy as np

from stereo_pick.core.arrays import Floats, Image
from stereo_pick.core.calibration.boards import Chessboard

_INSIDE = np.array([-0.1, 0.0, 0.1])  # of a square: where it is looked at, about the point named
_BEYOND = 1.25  # squares from the outermost corners: a little of the next but one is enough, boards may be cut there
_LEAST_CONTRAST = 0.3  # of that of the squares between the corners
_LEAST_STEPS = 3  # from square to square: fewer may look like a pattern by chance


def goes_on(picture: Image, corners_px: Floats, board: Chessboard) -> bool:
    """Whether there are squares beyond the outermost ones of the board whose inner corners (N, 2) [px] these are.

    picture: (H, W) uint8. Beyond one side of the board, all that the image shows of another row of squares must be as
    light and dark in turn as the board's own; a margin, a table and a hand are not.
    """
    homography, _ = cv2.findHomography(board.object_points()[:, :2] / board.square_m, corners_px)
    if homography is None:
        return False
    last_x, last_y = board.columns - 1, board.rows - 1
    xs, ys = (np.arange(last, dtype=np.float64) + 0.5 for last in (last_x, last_y))
    # Both rows of points are an even number of squares apart, so light meets light.
    sides = (
        (_points(0.5, ys), _points(-_BEYOND, ys)),
        (_points(last_x - 0.5, ys), _points(last_x + _BEYOND, ys)),
        (_points(xs, 0.5), _points(xs, -_BEYOND)),
        (_points(xs, last_y - 0.5), _points(xs, last_y + _BEYOND)),
    )
    return any(_alternates_alike(picture, np.asarray(homography, np.float64), *side) for side in sides)


def _points(x: Floats | float, y: Floats | float) -> Floats:
    """Points (N, 2), in squares from the first corner."""
    return np.stack(np.broadcast_arrays(x, y), axis=-1)


def _alternates_alike(picture: Image, homography: Floats, own: Floats, beyond: Floats) -> bool:
    """Whether the squares beyond (N, 2) step from light to dark and back where the board's own (N, 2) do."""
    steps, steps_beyond = (np.diff(_brightness(picture, homography, points)) for points in (own, beyond))
    seen = np.isfinite(steps) & np.isfinite(steps_beyond)
    if seen.sum() < _LEAST_STEPS:
        return False
    contrast = np.median(np.abs(steps[seen]))
    return bool((np.sign(steps) * steps_beyond > _LEAST_CONTRAST * contrast)[seen].all())


def _brightness(picture: Image, homography: Floats, points: Floats) -> Floats:
    """Mean brightness (N,) about each point; NaN where the image does not show all of that."""
    about = np.stack(np.meshgrid(_INSIDE, _INSIDE), axis=-1).reshape(1, -1, 2)
    px = np.asarray(cv2.perspectiveTransform(points[:, None] + about, homography), np.float32)
    values = cv2.remap(picture, px[..., 0], px[..., 1], cv2.INTER_LINEAR).astype(np.float64)
    height, width = picture.shape
    inside = ((px >= 0) & (px <= [width - 1, height - 1])).all(axis=(1, 2))
    return np.where(inside, values.mean(axis=1), np.nan)
