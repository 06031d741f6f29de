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
