"""SVG primitives. A drawing's coordinates are its subject's: pixels of an image, millimetres of a rig."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from stereo_pick.core.arrays import Floats
from stereo_pick.core.calibration_page.markup import Markup, element, number

INK, GREY, BLUE, ORANGE = "#1a1a1a", "#767676", "#0060a8", "#b34700"
_HALF_PAGE, _MARGIN = 440.0, 46.0


@dataclass(frozen=True)
class Box:
    """The part of the plane that a drawing shows, y downwards.

    drawn: its width on the page [CSS px] where there is room for it.
    """

    x: float
    y: float
    width: float
    height: float
    drawn: float = _HALF_PAGE

    @staticmethod
    def of_image(size_px: tuple[int, int]) -> Box:
        """All of an image: the centre of its first pixel is (0, 0)."""
        return Box(-0.5, -0.5, *size_px)

    @property
    def unit(self) -> float:
        """How much of the plane one CSS pixel shows; for text, lines and marks."""
        return self.width / self.drawn


def drawing(box: Box, alternative: str, *children: Markup, margin: float = _MARGIN) -> Markup:
    """The drawing with a margin [CSS px] around the box for the scales; alternative: what it shows, in words."""
    edge = margin * box.unit
    view = (box.x - edge, box.y - edge / 2, box.width + 1.5 * edge, box.height + 1.5 * edge)
    return element(
        "svg",
        element("title", alternative),
        *children,
        viewBox=" ".join(map(number, view)),
        role="img",
        aria_label=alternative,
        style=f"flex: 1 1 {0.75 * box.drawn:.0f}px; max-width: {1.1 * box.drawn:.0f}px",
        font_size=12 * box.unit,
        stroke_width=box.unit,
    )


def frame(box: Box) -> Markup:
    """The border of the box."""
    return element("rect", x=box.x, y=box.y, width=box.width, height=box.height, fill="none", stroke=INK)


def scales(box: Box, across: str, down: str) -> Markup:
    """Ticks with their values below and left of the box, and what the axes are."""
    unit, bottom, marks = box.unit, box.y + box.height, list[Markup]()
    for x in ticks(box.x, box.x + box.width):
        marks += [line((x, bottom), (x, bottom + 5 * unit))]
        marks += [text((x, bottom + 17 * unit), number(x), text_anchor="middle")]
    for y in ticks(box.y, bottom):
        marks += [line((box.x - 5 * unit, y), (box.x, y))]
        marks += [text((box.x - 7 * unit, y + 4 * unit), number(y), text_anchor="end")]
    marks += [text((box.x + box.width / 2, bottom + 32 * unit), across, text_anchor="middle")]
    marks += [text((box.x, box.y - 7 * unit), down)]
    return element("g", *marks, fill=INK)


def ticks(low: float, high: float) -> Floats:
    """Round values within low and high, four to nine of them."""
    step = nice((high - low) / 4)
    return np.asarray(np.arange(math.ceil(low / step), math.floor(high / step) + 1) * step)


def nice(value: float) -> float:
    """The largest of 1, 2 and 5 times a power of ten that is not above the value."""
    power = 10.0 ** math.floor(math.log10(value))
    return max(factor for factor in (1, 2, 5) if factor * power <= value * (1 + 1e-9)) * power


def line(start: tuple[float, float], end: tuple[float, float], colour: str = INK) -> Markup:
    """A straight line."""
    return element("line", x1=start[0], y1=start[1], x2=end[0], y2=end[1], stroke=colour)


def text(at: tuple[float, float], content: str, **attributes: str | float) -> Markup:
    """A line of text that begins there, unless `text_anchor` says otherwise."""
    return element("text", content, x=at[0], y=at[1], **attributes)


def outline(points: Floats, **attributes: str | float) -> Markup:
    """The closed polygon through points (N, 2)."""
    corners = " ".join(f"{number(x)},{number(y)}" for x, y in points.tolist())
    return element("polygon", points=corners, **attributes)


def dots(points: Floats, radius: float, colour: str) -> Markup:
    """A dot at each of the points (N, 2)."""
    circles = (element("circle", cx=x, cy=y, r=radius) for x, y in points.tolist())
    return element("g", *circles, fill=colour)
