"""A table on which as many objects are not as are: of shapes that are unknown here, some agree on one by chance."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from stereo_pick.core.matches.left_over import Unread
from stereo_pick.core.places.position import Row, of_thickness
from stereo_pick.core.shapes.common_table import stands_on
from stereo_pick.core.shapes.kinds import SPHERE
from stereo_pick.core.shapes.table import Table

_SEVERAL = 2  # objects: a single one may be mistaken itself


def unless_outvoted(table: Table | None, rows: Sequence[Row], refused: Sequence[Unread]) -> list[Row]:
    """The same, of which those that stand on the table may be anywhere within their thickness if it is outvoted: by as
    many objects as stand there, balls not counted, that are refused since they do not."""
    off_it = sum(each.reason == "off_table" for each in refused)
    on_it = [row for row in rows if table is not None and row[1].fit is not None and stands_on(table, row[1].fit)]
    bodies = [row for row in on_it if row[1].fit is not None and row[1].fit.kind != SPHERE.name]
    if off_it < max(_SEVERAL, len(bodies)):
        return list(rows)
    return [_anywhere_within(row) if row in on_it else row for row in rows]


def _anywhere_within(row: Row) -> Row:
    blobs, where = row
    if where.fit is None:
        return row
    return blobs, replace(where, covariance=where.covariance + of_thickness(where.fit))
