"""Residuals of each view as bars, and over the images as arrows."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from stereo_pick.core.calibration.result import CalibrationResult
from stereo_pick.core.calibration.views import RejectedView
from stereo_pick.core.calibration_page.drawing import BLUE, INK, ORANGE, Box, drawing, frame, line, nice, scales, text
from stereo_pick.core.calibration_page.evidence import Corners, corners
from stereo_pick.core.calibration_page.markup import Markup, element, figure, number, row_head, section, table_of

_LONG = 0.05  # of the image's width: how long the longer arrows are drawn
_BAR = 100.0


def views_section(result: CalibrationResult) -> Markup:
    """Every pair: how well it fits, or why it was left out; and the single corners that were left out."""
    longest_px = max(max(view.left_px, view.right_px) for view in result.used)
    rows = [
        _row(view.name, f"used, view {i + 1}", view.left_px, view.right_px, longest_px)
        for i, view in enumerate(result.used)
    ]
    note = f"Rms distance of a pair's corners from where the result puts them. A full bar is {longest_px:.3f} px."
    return section("Pairs", element("p", note), _table(rows, result.rejected), *_rejected_corners(result))


def rejected_table(rejected: Sequence[RejectedView]) -> Markup:
    """The pairs that were left out, and why."""
    return _table([], rejected)


def arrows_section(result: CalibrationResult) -> Markup:
    """The residuals over both images, drawn longer than they are."""
    both = corners(result)
    times = magnification(result.solution.size_px, both)
    longest_px = max(float(np.hypot(*each.residuals_px.T).max()) for each in both)
    caption = (
        f"From each corner to where the result puts it, drawn {times:g} times as long as it is; the longest is "
        f"{longest_px:.3f} px. Arrows without order are noise; neighbours that point one way are what the model misses."
    )
    drawings = [_arrows(side, result.solution.size_px, each, times) for side, each in zip(("left", "right"), both)]
    return section("Residuals over the images", figure(caption, *drawings))


def magnification(size_px: tuple[int, int], both: Sequence[Corners]) -> float:
    """How many times longer than they are residuals are drawn: a round number."""
    lengths_px = np.concatenate([np.hypot(*each.residuals_px.T) for each in both])
    return nice(_LONG * size_px[0] / max(float(np.percentile(lengths_px, 95)), 1e-9))


def _table(rows: Sequence[Markup], rejected: Sequence[RejectedView]) -> Markup:
    out = [
        element(
            "tr",
            row_head(view.name),
            element("td", "rejected", class_="state"),
            element("td", view.reason, class_="reason", colspan=3),
        )
        for view in rejected
    ]
    head = ("pair", "state", "left px", "right px", "left (filled) and right (outlined)")
    return table_of("Pairs used and left out", head, [*rows, *out])


def _rejected_corners(result: CalibrationResult) -> list[Markup]:
    """The corners that were left out of pairs that stay; nothing where there are none."""
    if not result.rejected_corners:
        return []
    items = (element("li", corner.describe(result.board)) for corner in result.rejected_corners)
    return [element("p", f"Single corners left out: {len(result.rejected_corners)}"), element("ul", *items)]


def _row(name: str, state: str, left_px: float, right_px: float, longest_px: float) -> Markup:
    widths = [_BAR * value / max(longest_px, 1e-12) for value in (left_px, right_px)]
    bars = element(
        "svg",
        element("rect", x=0, y=1, width=widths[0], height=4, fill=BLUE),
        element("rect", x=0, y=7, width=widths[1], height=4, fill="#fff", stroke=ORANGE),
        viewBox=f"0 0 {_BAR + 1:g} 12",
        preserveAspectRatio="none",
        class_="bar",
        aria_hidden="true",
    )
    return element(
        "tr",
        row_head(name),
        element("td", state, class_="state"),
        element("td", f"{left_px:.3f}"),
        element("td", f"{right_px:.3f}"),
        element("td", bars),
    )


def _arrows(side: str, size_px: tuple[int, int], each: Corners, times: float) -> Markup:
    box = Box.of_image(size_px)
    rms_px = float(np.sqrt((each.residuals_px**2).sum(axis=1).mean()))
    alternative = (
        f"Residuals of {len(each.seen_px)} corners over the {side} image, rms {rms_px:.3f} px, {times:g} times"
    )
    paths = (
        f"M{number(x)} {number(y)}l{number(times * dx)} {number(times * dy)}"
        for (x, y), (dx, dy) in zip(each.seen_px.tolist(), each.residuals_px.tolist())
    )
    heads = (
        element("circle", cx=x + times * dx, cy=y + times * dy, r=1.3 * box.unit)
        for (x, y), (dx, dy) in zip(each.seen_px.tolist(), each.residuals_px.tolist())
    )
    return drawing(
        box,
        alternative,
        element("path", d="".join(paths), fill="none", stroke=BLUE),
        element("g", *heads, fill=BLUE),
        frame(box),
        scales(box, "column, px", f"{side} image; row, px (a dot: the arrow's head)"),
        _ruler(box, times),
    )


def _ruler(box: Box, times: float) -> Markup:
    """What a residual of a round length looks like."""
    length_px = nice(0.12 * box.width / times)
    x, y = box.x + 8 * box.unit, box.y + box.height - 8 * box.unit
    words, end = f"{length_px:g} px", x + times * length_px
    back = element(
        "rect",
        x=box.x,
        y=y - 20 * box.unit,
        width=times * length_px + 16 * box.unit,
        height=28 * box.unit,
        fill="#fff",
        stroke=INK,
    )
    return element("g", back, line((x, y), (end, y)), text((x, y - 5 * box.unit), words, fill=INK), class_="ruler")
