"""The rig and the boards from above and from the side, to scale."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from stereo_pick.core.arrays import Floats
from stereo_pick.core.calibration.result import CalibrationResult
from stereo_pick.core.calibration_page.drawing import (
    BLUE,
    GREY,
    INK,
    ORANGE,
    Box,
    drawing,
    frame,
    outline,
    scales,
    text,
)
from stereo_pick.core.calibration_page.markup import Markup, element, figure, number, section
from stereo_pick.core.camera import Camera
from stereo_pick.core.transform import Transform

_FRUSTUM = 0.3  # of the boards' median depth: how far a camera's field of view is drawn
_ROOM = 0.06
_DRAWN = 640.0
_EDGES = (0, 1), (0, 2), (0, 3), (0, 4), (1, 2), (4, 3), (1, 4), (2, 3)


def rig_section(result: CalibrationResult) -> Markup:
    """Both cameras' fields of view and every board, in mm in the left camera's frame."""
    boards = [_board_mm(result, pose) for pose in result.solution.poses]
    left, right, right_T_left = result.solution.cameras
    length_mm = _FRUSTUM * float(np.median([board[:, 2].mean() for board in boards]))
    frusta = frustum_mm(left, Transform.identity(), length_mm), frustum_mm(right, right_T_left.inverse(), length_mm)
    caption = (
        "To scale, in mm, in the left camera's frame: x right, y down, z forward. Numbered at their first corner: the "
        "boards, as the pairs above are; L and R: the cameras, each with the beginning of its field of view, the right "
        f"one dashed. They stand {result.rig.baseline_m * 1000:.1f} mm apart, turned by {result.rotation_deg:.1f} deg."
    )
    above = _drawn("Rig and boards from above", "from above; x, mm", 0, frusta, boards)
    side = _drawn("Rig and boards from the side", "from the side; y, mm", 1, frusta, boards)
    return section("The rig", figure(caption, above, side))


def frustum_mm(camera: Camera, left_T_camera: Transform, length_mm: float) -> Floats:
    """The camera's centre, then where the images' corners are seen at that depth: (5, 3) [mm] in the left frame."""
    width, height = camera.frame_size
    corners_px = np.array([[0, 0, 1], [width - 1, 0, 1], [width - 1, height - 1, 1], [0, height - 1, 1]])
    rays = corners_px @ np.linalg.inv(camera.K).T
    return left_T_camera.apply(np.r_[np.zeros((1, 3)), rays * length_mm] / 1000) * 1000


def _board_mm(result: CalibrationResult, left_T_board: Transform) -> Floats:
    """The four outer corners (4, 3) [mm] of the board's pattern."""
    points = result.board.object_points()
    (x0, y0, _), (x1, y1, _) = points.min(axis=0), points.max(axis=0)
    return left_T_board.apply(np.array([[x0, y0, 0], [x1, y0, 0], [x1, y1, 0], [x0, y1, 0]])) * 1000


def _drawn(alternative: str, name: str, axis: int, frusta: tuple[Floats, Floats], boards: Sequence[Floats]) -> Markup:
    """Across: z; down: the axis x (0) or y (1) of that name."""
    flat = [points[:, [2, axis]] for points in (*frusta, *boards)]
    box = _box(np.concatenate(flat))
    marks = [outline(board, fill="none", stroke=GREY) for board in flat[2:]]
    marks += [_label(board[0], str(i + 1), box) for i, board in enumerate(flat[2:])]
    marks.append(_camera("L", flat[0], BLUE, "none", -6 * box.unit, box))
    marks.append(_camera("R", flat[1], ORANGE, number(4 * box.unit), 14 * box.unit, box))
    return drawing(box, alternative, *marks, frame(box), scales(box, "z, mm", name))


def _camera(name: str, frustum: Floats, colour: str, dashes: str, below: float, box: Box) -> Markup:
    """The edges of a camera's frustum (5, 2), those that coincide dashed alike, and its name at its centre."""
    ends = ((frustum[a], frustum[b] - frustum[a]) for a, b in _EDGES)
    path = "".join(f"M{number(x)} {number(y)}l{number(dx)} {number(dy)}" for (x, y), (dx, dy) in ends)
    edges = element("path", d=path, fill="none", stroke=colour, stroke_dasharray=dashes)
    return element("g", edges, _label(frustum[0] + [-9 * box.unit, below], name, box, colour))


def _label(at: Floats, words: str, box: Box, colour: str = INK) -> Markup:
    return text((float(at[0]), float(at[1])), words, text_anchor="middle", fill=colour, font_size=12 * box.unit)


def _box(points: Floats) -> Box:
    room = _ROOM * float(np.ptp(points, axis=0).max())
    (left, top), (right, bottom) = (points.min(axis=0) - room).tolist(), (points.max(axis=0) + room).tolist()
    return Box(left, top, right - left, bottom - top, _DRAWN)
