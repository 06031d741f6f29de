"""Parts that are none of the shapes that are known, nor made of these: refused, or said to be unsure."""

from __future__ import annotations

import evaluate_unknown
import pytest
from family_scoring import WRONG_M
from mahalanobis import CHI2_3
from marks import first_of
from odd_parts import ODD_PARTS


@pytest.mark.parametrize("light", first_of("bright", "dark"))
@pytest.mark.parametrize("shape", first_of(*ODD_PARTS))
def test_no_pose_is_far_off_unless_it_says_so(shape: str, light: str) -> None:
    scored = evaluate_unknown.scored((light, shape, 1))
    assert scored.found  # the known parts beside it
    for off_m, surprise in zip(scored.off_m, scored.mahalanobis2):
        assert off_m < WRONG_M or surprise < CHI2_3[95]


@pytest.mark.parametrize(("shape", "seed"), [("ell", 3), ("capsule", 5)])
def test_alone_without_a_table_it_says_so_too(shape: str, seed: int) -> None:
    """The stem of the L was a lying cylinder, 21 mm off; the capsule one that stands, and both were sure of it."""
    scored = evaluate_unknown.scored(("alone", shape, seed))
    assert max(scored.confidence, default=0.0) < 0.5
