"""What the calibration leaves uncertain of a point, over the volume in which the boards were seen."""

from __future__ import annotations

import numpy as np

from stereo_pick.core.arrays import Floats
from stereo_pick.core.calibration.result import CalibrationResult
from stereo_pick.core.calibration_page.drawing import GREY, INK, Box, drawing, frame, scales, text
from stereo_pick.core.calibration_page.markup import Markup, element, figure, section, table

_COLUMNS = 6


def points_section(result: CalibrationResult) -> Markup:
    """A table over the depths, and for each depth a map over the left image."""
    rows = [
        (f"{row.depth_m * 1000:.0f}", *(f"{sigma_m * 1000:.2f}" for sigma_m in (row.x_m, row.y_m, row.z_m)))
        for row in result.point_sigmas
    ]
    depths_m = [row.depth_m for row in result.point_sigmas]
    maps_m = [sigma_map_m(result, depth_m) for depth_m in depths_m]
    seen = np.concatenate([values[np.isfinite(values)] for values in maps_m])
    most_m = float(seen.max()) if len(seen) else 1.0
    caption = (
        "One sigma of a point's place in mm (the root of the sum of the squares of x, y and z), by where the left "
        "image shows it; darker is less sure. A dash: the right camera does not see that place."
    )
    drawings = [_drawn(result, depth_m, values, most_m) for depth_m, values in zip(depths_m, maps_m)]
    note = (
        "From the calibration alone, in the left camera's frame, x right, y down, z forward; how exactly the point "
        "itself was found in the images comes on top."
    )
    return section(
        "How sure a triangulated point is",
        table("One sigma at the depths of the boards", ("depth mm", "x mm", "y mm", "z mm"), rows),
        element("p", note),
        figure(caption, *drawings),
    )


def sigma_map_m(result: CalibrationResult, depth_m: float) -> Floats:
    """One sigma (rows, columns) [m] of the points at this depth in the middle of each cell of the left image.

    NaN where the right camera does not see the point.
    """
    left, right, right_T_left = result.solution.cameras
    centres_px = _cell_centres_px(result.solution.size_px)
    grid = centres_px.shape[:2]
    xyz = np.c_[left.normalized(centres_px.reshape(-1, 2)), np.ones(grid[0] * grid[1])] * depth_m
    in_right = right_T_left.apply(xyz)
    right_px = right.project(in_right)
    inside = (right_px > -0.5).all(axis=1) & (right_px < np.array(result.solution.size_px) - 0.5).all(axis=1)
    variance = np.trace(result.uncertainty.point_covariance(xyz), axis1=1, axis2=2)
    return np.asarray(np.where(inside & (in_right[:, 2] > 0), np.sqrt(variance), np.nan).reshape(grid))


def _cell_centres_px(size_px: tuple[int, int]) -> Floats:
    width, height = size_px
    rows = max(1, round(_COLUMNS * height / width))
    x = (np.arange(_COLUMNS) + 0.5) * width / _COLUMNS - 0.5
    y = (np.arange(rows) + 0.5) * height / rows - 0.5
    return np.stack(np.meshgrid(x, y), axis=-1)


def _drawn(result: CalibrationResult, depth_m: float, values_m: Floats, most_m: float) -> Markup:
    box = Box.of_image(result.solution.size_px)
    centres_px = _cell_centres_px(result.solution.size_px)
    rows, columns = values_m.shape
    width, height = box.width / columns, box.height / rows
    cells = list[Markup]()
    for (x, y), value_m in zip(centres_px.reshape(-1, 2).tolist(), values_m.ravel().tolist()):
        known = np.isfinite(value_m)
        words, fill = (f"{value_m * 1000:.2f}", _shade(value_m / most_m)) if known else ("–", "#fff")
        cells += [
            element("rect", x=x - width / 2, y=y - height / 2, width=width, height=height, fill=fill, stroke=GREY),
            text((x, y + 5 * box.unit), words, text_anchor="middle", font_size=16 * box.unit, fill=INK),
        ]
    title = f"{depth_m * 1000:.0f} mm away; row, px"
    known_mm = values_m[np.isfinite(values_m)] * 1000
    range_text = f"{known_mm.min():.2f} to {known_mm.max():.2f} mm" if known_mm.size else "nothing seen by both"
    alternative = f"One sigma over the left image {depth_m * 1000:.0f} mm away: {range_text}"
    return drawing(box, alternative, *cells, frame(box), scales(box, "column, px", title))


def _shade(part: float) -> str:
    """White to a blue on which black text is well read."""
    return "#" + "".join(f"{round(255 - part * (255 - full)):02x}" for full in (120, 180, 235))
