"""The outline of what is dark may be that of an object and its shadow."""

from __future__ import annotations

import evaluate_unknown
import pytest


@pytest.mark.parametrize(("parts", "poses"), [("bright", 1), ("dark", 0)])
def test_what_no_solid_explains_has_a_place_unless_it_may_be_one_with_its_shadow(parts: str, poses: int) -> None:
    scored = evaluate_unknown.scored((parts, "step", 14))
    assert len(scored.off_m) == poses and scored.found == scored.known
