"""Markdown tables."""

from __future__ import annotations

from collections.abc import Sequence

Row = Sequence[str]


def markdown_table(header: Row, rows: Sequence[Row]) -> str:
    """The first column to the left, all others to the right."""
    rule = ["---", *["---:"] * (len(header) - 1)]
    return "\n".join(f"| {' | '.join(cells)} |" for cells in (header, rule, *rows))


def decimals(value: float, places: int) -> str:
    """A number with that many decimals."""
    return f"{value:.{places}f}"
