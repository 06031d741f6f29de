"""A report page, read as a browser or a screen reader would."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Iterator
from html.parser import HTMLParser

VOID = {"meta", "rect", "circle", "line", "path", "polygon", "image"}


def parsed(page: str) -> ET.Element:
    """The page's tree; raises where it is not well-formed."""
    return ET.fromstring(page)


def words(element: ET.Element) -> str:
    return "".join(element.itertext())


def tables(root: ET.Element) -> dict[str, list[list[str]]]:
    """The rows of each table's body, by its caption."""
    return {
        words(table.find("caption")): [[words(cell) for cell in row] for row in table.find("tbody")]
        for table in root.iter("table")
    }


def drawings(root: ET.Element) -> dict[str, ET.Element]:
    """The drawings by their text alternative."""
    return {svg.get("aria-label", ""): svg for svg in root.iter("svg") if svg.get("aria-hidden") != "true"}


def drawn(root: ET.Element, start: str) -> ET.Element:
    """The one drawing whose text alternative begins, or goes on, like that."""
    (found,) = [svg for name, svg in drawings(root).items() if start in name]
    return found


def circles(element: ET.Element) -> list[tuple[float, float]]:
    return [(float(each.get("cx")), float(each.get("cy"))) for each in element.iter("circle")]


def references(root: ET.Element) -> Iterator[str]:
    """What the page would load or go to."""
    for element in root.iter():
        for name in ("src", "href", "srcset", "action", "data", "poster", "{http://www.w3.org/1999/xlink}href"):
            if element.get(name) is not None:
                yield element.get(name)


class Nesting(HTMLParser):
    """Whether each element is closed where it must be, by HTML's own rules."""

    def __init__(self, page: str) -> None:
        super().__init__()
        self.open: list[str] = []
        self.faults: list[str] = []
        self.feed(page)
        self.close()
        self.faults += [f"{tag} is left open" for tag in self.open]

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.open.append(tag)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        if tag not in VOID:
            self.faults.append(f"<{tag}/> is no empty element in HTML")

    def handle_endtag(self, tag: str) -> None:
        if not self.open or self.open.pop() != tag:
            self.faults.append(f"</{tag}> closes another element")
