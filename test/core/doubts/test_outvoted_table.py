"""A table is in doubt on which no more objects stand than are refused since they do not."""

from __future__ import annotations

import numpy as np
import pytest
from outlines import disc
from rigs import RIGS

from stereo_pick.core.doubts.outvoted_table import unless_outvoted
from stereo_pick.core.matches.left_over import Unread
from stereo_pick.core.places.position import Located, Row
from stereo_pick.core.shapes import SolidFit
from stereo_pick.core.shapes.table import Table

RIG = RIGS["thesis"]
SIZE_M = 0.04
TABLE = Table(np.array([0.0, 0.0, -1.0]), 0.9, 2e-4)


def standing(x_m: float, kind: str = "box", height_m: float = 0.0) -> Row:
    """What is so high above the table."""
    centre_m = np.array([x_m, 0.0, 0.9 - height_m - SIZE_M / 2])
    fit = SolidFit(kind, centre_m, np.eye(3), np.full(3, SIZE_M), 0.1, np.eye(3) * 1e-8)
    places = fit.centre_px(RIG.left), fit.centre_px(RIG.right)
    return (disc(*places[0], 15.0), disc(*places[1], 15.0)), Located(*places, 0.1, fit)


def refused(reason: str, count: int) -> list[Unread]:
    return [Unread(reason, *standing(0.0)[0])] * count


def doubted(rows: list[Row], others: list[Unread], table: Table | None = TABLE) -> list[bool]:
    return [bool(where.covariance.any()) for _, where in unless_outvoted(table, rows, others)]


@pytest.mark.parametrize(("on_it", "off_it", "is_doubted"), [(1, 1, False), (1, 2, True), (2, 2, True), (3, 2, False)])
def test_as_many_as_stand_on_it_outvote_it_if_they_are_several(on_it: int, off_it: int, is_doubted: bool) -> None:
    rows = [standing(0.1 * i) for i in range(on_it)]
    assert doubted(rows, refused("off_table", off_it)) == [is_doubted] * on_it
    assert not any(doubted(rows, refused("merged", off_it)))


def test_balls_do_not_vouch_for_it_but_are_as_much_in_doubt() -> None:
    rows = [standing(0.0), standing(0.1, "sphere"), standing(0.2, "sphere")]
    assert doubted(rows, refused("off_table", 2)) == [True] * 3


def test_what_does_not_stand_on_it_or_on_none_is_as_sure_as_before() -> None:
    assert doubted([standing(0.0, height_m=0.05)], refused("off_table", 2)) == [False]
    assert doubted([standing(0.0)], refused("off_table", 2), None) == [False]


def test_its_centre_is_anywhere_within_its_thickness() -> None:
    ((_, where),) = unless_outvoted(TABLE, [standing(0.0)], refused("off_table", 2))
    assert where.covariance == pytest.approx(SIZE_M**2 / 12 * np.eye(3))
