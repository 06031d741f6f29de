"""Where in each image corners were seen, and where there is no evidence for the lens."""

from __future__ import annotations

import cv2
import numpy as np

from stereo_pick.core.arrays import Bools, Floats
from stereo_pick.core.calibration.result import CalibrationResult
from stereo_pick.core.calibration_page.drawing import BLUE, GREY, INK, Box, dots, drawing, frame, line, scales
from stereo_pick.core.calibration_page.markup import Markup, element, figure, joined, section

_COLUMNS = 8


def coverage_section(result: CalibrationResult) -> Markup:
    """The corners of all used views, and the tilts and depths of their boards."""
    covered = result.coverage
    near, far = (depth_m * 1000 for depth_m in covered.depth_m)
    note = (
        f"The boards cover {covered.left_area:.0%} of the left image and {covered.right_area:.0%} of the right; "
        f"their tilts differ by up to {covered.tilt_deg:.0f} deg, their distances go from {near:.0f} to {far:.0f} mm."
    )
    sides = [np.concatenate([getattr(view, side) for view in result.views]) for side in ("left_px", "right_px")]
    return section("Coverage", element("p", note), coverage_figure(result.solution.size_px, sides[0], sides[1]))


def coverage_figure(size_px: tuple[int, int], left_px: Floats, right_px: Floats) -> Markup:
    """Corners (N, 2) [px] over both images, the cells without any crossed out."""
    empty = [empty_cells(size_px, corners_px) for corners_px in (left_px, right_px)]
    caption = (
        "Each dot is a corner of a view. Crossed cells hold none: there the lens is guessed from other parts. "
        f"Left: {empty[0].sum()} of {empty[0].size} cells crossed; right: {empty[1].sum()} of {empty[1].size}."
    )
    drawings = [
        _drawn(side, size_px, corners_px, cells)
        for side, corners_px, cells in zip(("left", "right"), (left_px, right_px), empty)
    ]
    return figure(caption, *drawings)


def empty_cells(size_px: tuple[int, int], corners_px: Floats) -> Bools:
    """Which cells (rows, columns) of an image hold no corner."""
    width, height = size_px
    rows = max(1, round(_COLUMNS * height / width))
    edges = np.linspace(-0.5, height - 0.5, rows + 1), np.linspace(-0.5, width - 0.5, _COLUMNS + 1)
    counts, *_ = np.histogram2d(corners_px[:, 1], corners_px[:, 0], bins=edges)
    return np.asarray(counts == 0)


def _drawn(side: str, size_px: tuple[int, int], corners_px: Floats, empty: Bools) -> Markup:
    box = Box.of_image(size_px)
    alternative = f"{len(corners_px)} corners over the {side} image; {empty.sum()} of {empty.size} cells hold none"
    return drawing(
        box,
        alternative,
        _cells(box, empty),
        _hull(corners_px),
        dots(corners_px, 1.6 * box.unit, BLUE),
        frame(box),
        scales(box, "column, px", f"{side} image; row, px"),
    )


def _cells(box: Box, empty: Bools) -> Markup:
    rows, columns = empty.shape
    width, height = box.width / columns, box.height / rows
    marks = list[Markup]()
    for row, column in np.argwhere(empty).tolist():
        x, y = box.x + column * width, box.y + row * height
        marks.append(element("rect", x=x, y=y, width=width, height=height, fill="#f0f0f0", stroke=GREY))
        marks += [line((x, y), (x + width, y + height), GREY), line((x, y + height), (x + width, y), GREY)]
    return element("g", *marks)


def _hull(corners_px: Floats) -> Markup:
    if len(corners_px) == 0:
        return joined([])
    hull = cv2.convexHull(corners_px.astype(np.float32)).reshape(-1, 2).astype(np.float64)
    points = " ".join(f"{x:.1f},{y:.1f}" for x, y in hull.tolist())
    return element("polygon", points=points, fill="none", stroke=INK, stroke_dasharray="6 4")
