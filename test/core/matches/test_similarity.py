"""How alike objects of both views are, where one of them is but a line."""

from __future__ import annotations

import numpy as np
import pytest

from stereo_pick.core.matches.similarity import Similarity
from stereo_pick.core.objects import Blob

SIMILARITY = Similarity(1.5, 0.03, 1.5, (0.0, 100.0))


def blob(width_px: float, left_px: float = 50.0) -> Blob:
    corners = [(0.0, 0.0), (width_px, 0.0), (width_px, 20.0), (0.0, 20.0)]
    return Blob(np.array(corners) + (left_px, 30.0), 100.0)


@pytest.mark.filterwarnings("error")
def test_a_line_is_no_partner_of_a_surface_and_may_be_one_of_a_line() -> None:
    cost = SIMILARITY.costs([blob(10.0), blob(0.0)], [blob(10.0, 40.0), blob(0.0, 40.0)])
    np.testing.assert_array_equal(np.isfinite(cost), np.eye(2, dtype=bool))
    np.testing.assert_allclose(np.diag(cost), 0.0, atol=1e-12)
