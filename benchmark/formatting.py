"""Markdown tables."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

Row = Sequence[str]


class Section(NamedTuple):
    """Markdown, and what it comes to in a few words."""

    headline: str
    text: str


def markdown_table(header: Row, rows: Sequence[Row], words: bool = False) -> str:
    """The first column to the left; all others to the right, or to the left where they hold words."""
    rule = ["---", *["---" if words else "---:"] * (len(header) - 1)]
    return "\n".join(f"| {' | '.join(cells)} |" for cells in (header, rule, *rows))


def decimals(value: float, places: int) -> str:
    """A number with that many decimals."""
    return f"{value:.{places}f}"
