"""Markdown tables."""

from __future__ import annotations

import statistics
from collections.abc import Iterable, Sequence
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


def mean_and_max(values: Iterable[float]) -> str:
    """Both, with two decimals; a dash where there are none."""
    listed = list(values)
    return f"{statistics.fmean(listed):.2f}, max {max(listed):.2f}" if listed else "–"


def percent(share: float) -> str:
    """A share of one, in percent with one decimal."""
    return f"{100 * share:.1f} %"
