"""The scene on what may be its table, where outlines are one with those of what lies there."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from evaluate_surroundings import scored
from marks import more
from outlines import disc
from rendered_solids import PARTS, PLACED, RIG, rectified, table_of, true_fit
from rendering import Scene as Rendered

from stereo_pick.core.correspondence import scene as scenes
from stereo_pick.core.correspondence.found_table import FoundTable
from stereo_pick.core.correspondence.reading import Reading
from stereo_pick.core.correspondence.scene import Scene
from stereo_pick.core.correspondence.together import Together
from stereo_pick.core.found_late.last_look import LastLook
from stereo_pick.core.matches.left_over import Unread
from stereo_pick.core.places.position import Located, Row
from stereo_pick.core.tables.lying_flat import WarpedViews

SEEN = Rendered(tuple(PARTS.values()), PLACED)
TABLE = table_of(RIG, PLACED)


def scene_on(height_m: float, *names: str) -> Scene:
    """These parts, and a table so much above the one on which they stand."""
    fits = [true_fit(RIG, SEEN, PARTS[name]) for name in names]
    rows: list[Row] = [((disc(300, 200), disc(250, 200)), Located(np.zeros(2), np.zeros(2), 0.1, fit)) for fit in fits]
    table = replace(TABLE, offset_m=TABLE.offset_m - height_m)
    together = Together(rows, [], WarpedViews(rectified(RIG, SEEN), table))
    return Scene(Reading(rows, [], table), together, True, frozenset())


def test_balls_stand_on_any_table() -> None:
    assert len(scene_on(0.0, *PARTS).standing) == len(PARTS) - 1
    assert scene_on(0.01, *PARTS).standing == []


@pytest.mark.parametrize(("height_m", "is_above"), [(0.01, True), (0.001, False), (-0.01, False)])
def test_a_table_that_parts_go_through_is_above_theirs(height_m: float, is_above: bool) -> None:
    """Such as that of the tops of walls."""
    assert scene_on(height_m).is_above(scene_on(0.0, "standing", "box")) is is_above
    assert not scene_on(height_m).is_above(scene_on(0.0, "sphere"))


def chosen(
    monkeypatch: pytest.MonkeyPatch,
    found: Scene,
    other: Scene,
    bears: bool = True,
    shaded: bool = False,
    last_look: bool = True,
) -> Scene:
    """The scene, where one is on the table that was found, and the other on what may be it by all that is seen.

    bears: whether something that is refused is found there; shaded: or in its own shadow; last_look: whether that may
    be looked for.
    """
    there, may_be = found.together.table, other.together.table
    assert there is not None and may_be is not None
    monkeypatch.setattr(scenes, "scene_on", lambda _, __, on, ___: other if on.table is may_be else found)
    monkeypatch.setattr(LastLook, "at_refused", lambda look, *_: bears or None)
    monkeypatch.setattr(scenes, "refused_in_its_shadow", lambda *_: shaded or None)
    images = SimpleNamespace(pair=rectified(RIG, SEEN))
    reader: Any = SimpleNamespace(table=lambda *_: FoundTable(there, True), images=images, last_look=last_look)
    looks: Any = SimpleNamespace(first=None, kept_besides=[], fits=[])
    return scenes.scene_on_found_table(reader, looks, lambda _: [may_be], 0.0)


def test_where_few_stand_on_the_table_that_was_found_another_may_be_it(monkeypatch: pytest.MonkeyPatch) -> None:
    """Unless nothing is refused, or found there of what is, or no more is found."""
    few, several = scene_on(0.01, "standing", "box"), scene_on(0.0, *PARTS)
    left, right = (replace(disc(x_px, 200), sharpness=np.full(64, 0.9)) for x_px in (300, 250))
    refused = [Unread("merged", left, right)]
    unread = replace(few, together=replace(few.together, refused=refused))
    assert chosen(monkeypatch, unread, several) is several
    assert chosen(monkeypatch, few, several) is few
    assert chosen(monkeypatch, unread, several, bears=False) is unread
    assert chosen(monkeypatch, unread, several, bears=False, shaded=True) is several
    assert chosen(monkeypatch, unread, several, last_look=False) is unread
    assert chosen(monkeypatch, unread, scene_on(0.0, "standing", "box")) is unread


@pytest.mark.parametrize(("family", "seed", "found"), [("sheet", 3, 5), pytest.param("belt", 0, 3, marks=more)])
def test_parts_are_found_whose_outlines_are_one_with_what_lies_or_stands_there(
    family: str, seed: int, found: int
) -> None:
    """Sheets of paper and rails: no table was known."""
    result = scored(None, (family, seed))
    assert result.required - len(result.missed) >= found and result.wrong == 0


@more
def test_what_stands_on_a_higher_table_does_not_reach_down_to_the_lower_one() -> None:
    """It was 29 mm off; the law itself: `test_last_look.py`."""
    result = scored(None, ("terrace", 3))
    assert len(result.missed) == 0 and result.wrong == 0


@pytest.mark.parametrize(("seed", "found"), [(6, 4), pytest.param(9, 4, marks=more), pytest.param(1, 3, marks=more)])
def test_parts_in_the_cells_of_a_tray_are_found(seed: int, found: int) -> None:
    """Bright walls make one outline of all of them; dark ones have them for high lights."""
    result = scored(None, ("dividers", seed))
    assert result.required - len(result.missed) >= found and result.wrong == 0
