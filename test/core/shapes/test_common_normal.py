"""The table's normal from the solids that stand on it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from solids_on_table import LYING, MIXED, NUTS, UPRIGHT, Standing, fits_on_table, table_of

from stereo_pick.core.shapes import common_normal


@pytest.mark.parametrize("tilt_deg", [15, 40, 60])
@pytest.mark.parametrize("parts", [MIXED, LYING, UPRIGHT, NUTS], ids=["mixed", "lying", "upright", "nuts"])
def test_the_normal_is_what_all_solids_agree_on(tilt_deg: float, parts: list[Standing]) -> None:
    found = common_normal(fits_on_table(tilt_deg, parts))
    assert found is not None
    assert np.rad2deg(np.arccos(found @ table_of(tilt_deg).normal)) < 0.5


def test_one_object_or_none_tells_nothing() -> None:
    fits = fits_on_table(40, MIXED)
    assert common_normal([]) is None and common_normal([None, None]) is None
    assert common_normal(fits[:1]) is None and common_normal([fits[0], None, fits[3]]) is None


def test_solids_that_disagree_have_no_common_normal() -> None:
    assert common_normal([*fits_on_table(15, UPRIGHT[:1]), *fits_on_table(50, UPRIGHT[1:])]) is None


def test_a_level_face_counts_as_one_more_solid() -> None:
    """A lit top, with one body beside it; a ball alone says nothing about the normal, two tops beside it do."""
    fits, truth = fits_on_table(40, UPRIGHT), table_of(40)
    ball = fits_on_table(40, MIXED)[3]
    tops = [replace(fit, size_m=np.array([*fit.size_m[:2], 0.001])) for fit in fits if fit]
    for solids, faces in ((fits[:1], tops[1:]), ([ball], tops)):
        found = common_normal(solids, faces)
        assert found is not None and np.rad2deg(np.arccos(found @ truth.normal)) < 0.5
    assert common_normal([ball], tops[:1]) is None and common_normal([], tops) is None


def test_a_face_that_is_not_level_speaks_against_the_solids() -> None:
    fits = fits_on_table(40, UPRIGHT[:1])
    (other,) = fits_on_table(5, UPRIGHT[1:])
    assert other is not None
    assert common_normal(fits, [replace(other, size_m=np.array([*other.size_m[:2], 0.001]))]) is None
