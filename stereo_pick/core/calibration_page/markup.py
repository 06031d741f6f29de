"""HTML and SVG, made so that no text can become markup by accident."""

from __future__ import annotations

import re
from collections.abc import Sequence
from html import escape

# What XML 1.0 holds no text with; a file's name may.
_NO_TEXT = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")


class Markup(str):
    """Text that is HTML or SVG already; any other text is escaped where it becomes a part of it."""

    __slots__ = ()


_NOTHING = Markup("&#160;")


def element(tag: str, *children: str, **attributes: str | float) -> Markup:
    """`<tag ...>children</tag>`, well-formed as XML too.

    Attributes: `_` stands for `-`, a `_` at the end is dropped (`class_`), numbers are written by `number`.
    """
    named = "".join(f' {name.rstrip("_").replace("_", "-")}="{_value(value)}"' for name, value in attributes.items())
    content = "".join(map(_escaped, children))
    return Markup(f"<{tag}{named}>{content}</{tag}>" if content else f"<{tag}{named}/>")


def joined(parts: Sequence[str]) -> Markup:
    """The parts one after the other, those that are text escaped."""
    return Markup("".join(map(_escaped, parts)))


def number(value: float) -> str:
    """A coordinate with at most two decimals."""
    return f"{value:.2f}".rstrip("0").rstrip(".")


def table(caption: str, head: Sequence[str], rows: Sequence[Sequence[str]]) -> Markup:
    """A table of these cells."""
    return table_of(caption, head, [element("tr", row_head(name), *map(_cell, cells)) for name, *cells in rows])


def table_of(caption: str, head: Sequence[str], rows: Sequence[Markup]) -> Markup:
    """A table of rows that are markup already; it scrolls by itself where the page is narrower."""
    heads = (element("th", text or _NOTHING, scope="col") for text in head)
    parts = (
        element("caption", caption),
        element("thead", element("tr", *heads)),
        element("tbody", *rows),
    )
    return element("div", element("table", *parts), class_="table")


def row_head(name: str) -> Markup:
    """The first cell of a row."""
    return element("th", name or _NOTHING, scope="row")


def section(title: str, *children: str) -> Markup:
    """A part of the page with its heading."""
    return element("section", element("h2", title), *children)


def figure(caption: str, *drawings: Markup) -> Markup:
    """Drawings beside each other over one caption."""
    return element("figure", element("div", *drawings, class_="row"), element("figcaption", caption))


def _cell(text: str) -> Markup:
    return element("td", text or _NOTHING)


def _value(value: str | float) -> str:
    return _escaped(value if isinstance(value, str) else number(value))


def _escaped(text: str) -> str:
    return text if isinstance(text, Markup) else escape(_NO_TEXT.sub("\N{REPLACEMENT CHARACTER}", text))
