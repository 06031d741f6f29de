"""What of a solid must show."""

from __future__ import annotations

import numpy as np
import pytest

from stereo_pick.core.edges.adjusted import Adjusted
from stereo_pick.core.shapes import SolidFit


def adjusted(kind: str, shown: float, creased: float, has_creases: bool) -> Adjusted:
    fit = SolidFit(kind, np.array([0.0, 0.0, 1.0]), np.eye(3), np.full(3, 0.04), 0.1, 1e-8 * np.eye(3))
    return Adjusted(fit, shown, creased, has_creases, denied=0.0)


@pytest.mark.parametrize(
    ("kind", "shown", "creased", "has_creases", "is_seen"),
    [
        ("box", 0.5, 0.9, True, True),
        ("box", 0.5, 0.3, True, False),
        ("cylinder", 0.8, 0.0, True, True),
        ("cylinder", 0.7, 0.0, True, False),
        ("sphere", 0.5, 1.0, False, True),
    ],
    ids=["creased", "half of it without", "all around without", "not all around without", "a ball"],
)
def test_a_solid_shows_its_creases_or_all_around(
    kind: str, shown: float, creased: float, has_creases: bool, is_seen: bool
) -> None:
    assert adjusted(kind, shown, creased, has_creases).is_seen is is_seen


@pytest.mark.parametrize(
    ("creased", "has_creases", "shows"), [(0.7, True, True), (0.6, True, False), (1.0, False, False)]
)
def test_only_what_has_creases_shows_them(creased: float, has_creases: bool, shows: bool) -> None:
    assert adjusted("box", 0.9, creased, has_creases).shows_creases is shows
