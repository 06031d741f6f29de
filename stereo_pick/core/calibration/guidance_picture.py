"""A picture for the person who moves the board: what was seen, what was kept, and what is missing."""

from __future__ import annotations

from collections.abc import Sequence

import cv2
import numpy as np

from stereo_pick.core.arrays import Bools, Floats, Image
from stereo_pick.core.calibration.detection import BoardImages
from stereo_pick.core.calibration.guidance import Guidance
from stereo_pick.core.calibration.views import BoardView

_WIDTH_PX = 640  # of each half
_KEPT, _SEEN, _EMPTY, _TEXT = (0, 160, 255), (80, 220, 80), (60, 60, 240), (255, 255, 255)
_TINT = 0.25


def guidance_picture(pair: BoardImages, seen: BoardView | None, kept: Sequence[BoardView], guidance: Guidance) -> Image:
    """Return a BGR picture (H, 2 W, 3) of the left and the right image side by side, each at most 640 px wide.

    Green: the corners seen in this pair; orange: those of the views kept so far; reddish: ninths of the image that no
    board has reached. Above: what is missing.
    """
    scale = min(1.0, _WIDTH_PX / pair.size_px[0])
    halves = [
        _half(
            picture,
            scale,
            empty,
            [view.corners_px[side] for view in kept],
            None if seen is None else seen.corners_px[side],
        )
        for side, (picture, empty) in enumerate(((pair.left, guidance.left_empty), (pair.right, guidance.right_empty)))
    ]
    canvas = np.ascontiguousarray(np.hstack(halves), np.uint8)
    for number, line in enumerate((f"{guidance.views} views", *(f"missing: {text}" for text in guidance.missing))):
        for ink, thickness in (((0, 0, 0), 3), (_TEXT, 1)):
            cv2.putText(canvas, line, (8, 18 + 18 * number), cv2.FONT_HERSHEY_SIMPLEX, 0.5, ink, thickness, cv2.LINE_AA)
    return canvas


def _half(picture: Image, scale: float, empty: Bools, kept_px: Sequence[Floats], seen_px: Floats | None) -> Image:
    small = cv2.resize(picture, None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA)
    canvas = np.asarray(cv2.cvtColor(small, cv2.COLOR_GRAY2BGR), np.uint8)
    height, width = canvas.shape[:2]
    ninths = cv2.resize(empty.astype(np.uint8), (width, height), interpolation=cv2.INTER_NEAREST) > 0
    canvas[ninths] = (canvas[ninths] * (1 - _TINT) + np.array(_EMPTY) * _TINT).astype(np.uint8)
    for corners_px, colour, radius in ((np.concatenate([np.empty((0, 2)), *kept_px]), _KEPT, 1), (seen_px, _SEEN, 3)):
        for x, y in np.rint((corners_px if corners_px is not None else np.empty((0, 2))) * scale).astype(int).tolist():
            cv2.circle(canvas, (x, y), radius, colour, -1)
    return canvas
