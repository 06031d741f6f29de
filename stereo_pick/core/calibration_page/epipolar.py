"""One pair, rectified: a corner and its partner must lie on one line."""

from __future__ import annotations

import base64

import cv2
import numpy as np

from stereo_pick.core.arrays import Floats, Image, Ints
from stereo_pick.core.calibration.detection import BoardImages
from stereo_pick.core.calibration.views import BoardView
from stereo_pick.core.calibration_page.drawing import INK, Box, drawing, frame, text
from stereo_pick.core.calibration_page.markup import Markup, element, figure, section, table
from stereo_pick.core.frames import StereoFrame
from stereo_pick.core.rectification import Rectifier
from stereo_pick.core.rig import StereoRig

_LINES = 9
_MAX_WIDTH_PX = 1000  # of an embedded picture: enough for a printed page
_JPEG_QUALITY = 80
_DRAWN = 880.0
_GAP = 0.02  # of an image's width, between the two
_YELLOW = "#ffe45c"


def epipolar_section(rig: StereoRig, view: BoardView, images: BoardImages) -> Markup:
    """The rectified pair with lines through some corners of the left image, and by how much their partners miss them.

    view: the corners that both of these images show, at least one.
    """
    left_px, right_px = rig.left.rectified(view.left_px), rig.right.rectified(view.right_px)
    differences_px = right_px[:, 1] - left_px[:, 1]
    shown = spread(left_px[:, 1], rig.left.height_px / (2 * _LINES))
    rms_px, most_px = float(np.sqrt(np.mean(differences_px**2))), float(np.abs(differences_px).max())
    caption = (
        f"The pair {view.name}, rectified. A line runs along the row of a corner in the left picture; its partner in "
        f"the right one must lie on it. Over all {len(left_px)} corners the rows differ by {rms_px:.3f} px rms and "
        f"{most_px:.3f} px at most."
    )
    rows = [
        (str(k + 1), *(f"{value:.2f}" for value in (*left_px[i], *right_px[i])), f"{differences_px[i]:+.3f}")
        for k, i in enumerate(shown.tolist())
    ]
    head = ("line", "left column px", "left row px", "right column px", "right row px", "difference of rows px")
    pictures = Rectifier(rig).rectify(StereoFrame(images.left, images.right))
    return section(
        "Epipolar lines",
        figure(caption, _drawn(pictures.left, pictures.right, left_px[shown], right_px[shown])),
        table("The corners on the lines, in the rectified images", head, rows),
    )


def spread(rows_px: Floats, apart_px: float) -> Ints:
    """Indices of at most _LINES corners, top to bottom, at least that far apart."""
    order = np.argsort(rows_px, kind="stable")
    apart_px = max(apart_px, float(np.ptp(rows_px)) / _LINES)
    chosen = [int(order[0])]
    for i in order.tolist():
        if rows_px[i] - rows_px[chosen[-1]] >= apart_px:
            chosen.append(i)
    return np.array(chosen, np.int64)


def _drawn(left: Image, right: Image, left_px: Floats, right_px: Floats) -> Markup:
    height, width = left.shape
    shift = width * (1 + _GAP)
    box = Box(-0.5, -0.5, width + shift, height, drawn=_DRAWN)
    size = box.unit
    marks = [_picture(left, 0.0), _picture(right, shift)]
    for k, ((x0, y0), (x1, y1)) in enumerate(zip(left_px.tolist(), right_px.tolist())):
        marks += [
            _line(box, y0),
            _mark(x0, y0, size),
            _mark(x1 + shift, y1, size),
            text((box.x - 5 * size, y0 + 5 * size), str(k + 1), text_anchor="end", fill=INK, font_size=14 * size),
        ]
    alternative = f"A rectified pair with {len(left_px)} horizontal lines through corners of the board"
    return drawing(box, alternative, *marks, margin=30.0)


def _line(box: Box, y: float) -> Markup:
    """A row across both pictures, light within dark, so that it is seen on either."""
    both = (
        element("rect", x=box.x, y=y - width / 2, width=box.width, height=width, fill=colour, stroke="none")
        for colour, width in ((INK, 2.6 * box.unit), (_YELLOW, 1.2 * box.unit))
    )
    return element("g", *both)


def _mark(x: float, y: float, size: float) -> Markup:
    """A ring, likewise."""
    rings = [
        element("circle", cx=x, cy=y, r=7 * size, fill="none", stroke=colour, stroke_width=width * size)
        for colour, width in (("#000", 4.5), ("#fff", 2))
    ]
    return element("g", *rings)


def _picture(picture: Image, shift: float) -> Markup:
    height, width = picture.shape
    box = Box(shift - 0.5, -0.5, width, height)
    small = cv2.resize(picture, None, fx=_scale(width), fy=_scale(width), interpolation=cv2.INTER_AREA)
    _, encoded = cv2.imencode(".jpg", small, (cv2.IMWRITE_JPEG_QUALITY, _JPEG_QUALITY))
    data = base64.b64encode(encoded.tobytes()).decode()
    href = f"data:image/jpeg;base64,{data}"
    place = {"x": box.x, "y": box.y, "width": box.width, "height": box.height}
    return element("g", element("image", href=href, preserveAspectRatio="none", **place), frame(box))


def _scale(width_px: int) -> float:
    return min(1.0, _MAX_WIDTH_PX / width_px)
