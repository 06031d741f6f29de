"""A table on which nothing stands after all is looked for again."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from families import staged

from stereo_pick.core.configuration import steps
from stereo_pick.core.correspondence.found_table import FoundTable, Shaded
from stereo_pick.core.correspondence.reading import FirstLook, Reader
from stereo_pick.core.pipeline import Pipeline
from stereo_pick.core.places.position import Row


def test_a_table_that_nothing_stands_on_is_looked_for_again(monkeypatch: pytest.MonkeyPatch) -> None:
    scene = staged("four_cylinders", 0)
    frame, truth = scene.taken()
    asked: list[FoundTable | None] = []
    find = Reader.table

    def wrong_at_first(reader: Reader, first: FirstLook, others: Sequence[Row], shaded: Shaded) -> FoundTable | None:
        right = find(reader, first, others, shaded)
        assert right is not None
        tilted = replace(right.table, normal=np.array([0.6, 0.0, -0.8]))
        asked.append(right if asked else FoundTable(tilted, False))
        return asked[-1]

    monkeypatch.setattr(Reader, "table", wrong_at_first)
    found = Pipeline(scene.rig, steps({})).run(frame).poses
    assert len(asked) == 2
    assert len(found) == len(truth.objects)
    for each in truth.objects:
        assert np.linalg.norm(found.xyz - each.centre_m, axis=1).min() < 1e-3
