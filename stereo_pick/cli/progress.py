"""A progress bar on stderr, where that is a terminal."""

from __future__ import annotations

import sys
from collections.abc import Iterable, Iterator
from typing import TypeVar

T = TypeVar("T")

_WIDTH = 30


def progress(items: Iterable[T], total: int | None, what: str) -> Iterator[T]:
    """Yield the items, showing how many of them are done."""
    shown = sys.stderr.isatty()
    for number, item in enumerate(items, start=1):
        yield item
        if shown:
            _show(number, total, what)
    if shown:
        print(file=sys.stderr)


def _show(number: int, total: int | None, what: str) -> None:
    if not total:
        print(f"\r{number} {what}", end="", file=sys.stderr, flush=True)
        return
    done = min(_WIDTH, _WIDTH * number // total)
    print(f"\r[{'#' * done}{'.' * (_WIDTH - done)}] {number}/{total} {what}", end="", file=sys.stderr, flush=True)
