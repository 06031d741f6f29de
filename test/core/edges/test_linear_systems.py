"""Many small systems solved at once."""

from __future__ import annotations

import numpy as np
import pytest

from stereo_pick.core.edges.linear_systems import solutions


@pytest.mark.parametrize("unknowns", [3, 4, 5])
def test_systems_are_solved_beside_singular_ones(unknowns: int) -> None:
    """As those of boxes are, of which many begin with a zero."""
    random = np.random.default_rng(unknowns)
    matrix = random.integers(-1, 2, (2000, unknowns, unknowns)).astype(float)
    right = random.normal(size=(2000, unknowns))
    regular = np.abs(np.linalg.det(matrix)) > 0.5
    found = solutions(np.concatenate([matrix, right[..., None]], axis=2).transpose(1, 2, 0).copy())
    np.testing.assert_allclose(found[regular], np.linalg.solve(matrix[regular], right[regular][..., None])[..., 0])
    assert 100 < regular.sum() < 1900
