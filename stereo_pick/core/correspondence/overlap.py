"""No two objects are at the same place."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace

from stereo_pick.core.correspondence.position import Row
from stereo_pick.core.shapes import SolidFit


def is_apart(fit: SolidFit, rows: Iterable[Row]) -> bool:
    """Whether a solid has its centre in none of those found, nor they theirs in it."""
    others = [where.fit for _, where in rows if where.fit is not None]
    return not any(fit.overlaps(other) for other in others)


def one_in_each_place(rows: Sequence[Row]) -> tuple[list[Row], list[Row]]:
    """Those that stay, the surest of each place, and the others, to be refused."""
    stays: list[Row] = []
    goes: list[Row] = []
    for blobs, where in sorted(rows, key=lambda row: row[1].sigma_px):
        if where.fit is None or is_apart(where.fit, stays):
            stays.append((blobs, where))
        else:
            goes.append((blobs, replace(where, fit=None, reason="merged")))
    return stays, goes
