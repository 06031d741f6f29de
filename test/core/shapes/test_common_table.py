"""The table that solids stand on, found from the solids."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from rigs import rotation
from solids_on_table import LYING, MIXED, NUTS, UPRIGHT, Standing, fits_on_table, table_of

from stereo_pick.core.shapes import SolidFit
from stereo_pick.core.shapes.common_normal import common_normal
from stereo_pick.core.shapes.common_table import common_table, hangs_above, stands_on, supposed_tables, surely_on
from stereo_pick.core.shapes.table import Table


def off_deg(one: Table, other: Table) -> float:
    return float(np.rad2deg(np.arccos(min(one.normal @ other.normal, 1.0))))


def off_m(one: Table, fits: list[SolidFit | None]) -> float:
    """By how much the solids' lowest points are off the plane."""
    return max(abs(float(one.under(fit.solid)[0][0])) for fit in fits if fit)


@pytest.mark.parametrize("tilt_deg", [15, 40, 60])
@pytest.mark.parametrize("parts", [MIXED, LYING, UPRIGHT, NUTS], ids=["mixed", "lying", "upright", "nuts"])
def test_the_plane_is_what_the_solids_stand_on(tilt_deg: float, parts: list[Standing]) -> None:
    fits, truth = fits_on_table(tilt_deg, parts), table_of(tilt_deg)
    found = common_table(fits)
    assert found is not None
    assert off_deg(found, truth) < 0.5
    assert off_m(found, fits) < 2e-3 and found.sigma_m < 1e-3
    assert sum(stands_on(found, fit) for fit in fits if fit) > len(fits) / 2


def test_what_stands_on_something_else_does_not_lift_the_table() -> None:
    fits = [*fits_on_table(40, MIXED[:3]), *fits_on_table(40, UPRIGHT[1:], lifted_m=0.015)]
    found = common_table(fits)
    assert found is not None
    assert off_m(found, fits[:3]) < 5e-4
    lifted = fits[3]
    assert lifted is not None and not stands_on(found, lifted) and hangs_above(found, lifted)
    assert all(surely_on(found, fit) for fit in fits[:3] if fit) and not surely_on(found, lifted)


def test_what_would_hang_higher_than_it_is_itself_is_no_body() -> None:
    (fit,) = fits_on_table(40, UPRIGHT[1:], lifted_m=0.05)
    assert fit is not None and not hangs_above(table_of(40), fit)


def test_what_reaches_below_the_table_neither_stands_nor_hangs() -> None:
    (fit,), lower = fits_on_table(40, UPRIGHT[:1]), table_of(40, lifted_m=0.01)
    assert fit is not None and not stands_on(lower, fit) and not hangs_above(lower, fit)


def test_solids_that_disagree_have_no_common_table() -> None:
    assert common_table([*fits_on_table(15, UPRIGHT[:1]), *fits_on_table(50, UPRIGHT[1:])]) is None
    assert common_table([]) is None


@pytest.mark.parametrize("tilt_deg", [70, 75, 80])
def test_what_the_cameras_would_hardly_see_is_no_table(tilt_deg: float) -> None:
    """Two parts of which one was marks of a print agreed on a wall, on which nothing else stood."""
    fits = fits_on_table(tilt_deg, UPRIGHT)
    assert common_normal(fits) is not None and common_table(fits) is None


@pytest.mark.parametrize("tilt_deg", [15, 40, 60])
def test_the_table_is_among_what_one_standing_solid_supposes(tilt_deg: float) -> None:
    for part in (UPRIGHT[0], MIXED[2], NUTS[0]):
        fits = fits_on_table(tilt_deg, [part])
        supposed = supposed_tables(fits)
        assert any(off_deg(each, table_of(tilt_deg)) < 1.5 for each in supposed)
        assert all(off_m(each, fits) < 1e-9 for each in supposed)


@pytest.mark.parametrize("tilt_deg", [15, 40, 60])
def test_the_table_is_among_what_a_lying_cylinder_and_a_ball_suppose(tilt_deg: float) -> None:
    fits = fits_on_table(tilt_deg, [MIXED[1], MIXED[3]])
    supposed = supposed_tables(fits)
    near = [each for each in supposed if off_deg(each, table_of(tilt_deg)) < 1.5 and off_m(each, fits) < 5e-4]
    assert near and len(supposed) <= 4


@pytest.mark.parametrize("tilt_deg", [15, 40, 60])
def test_what_most_would_stand_on_is_supposed_first(tilt_deg: float) -> None:
    fits = fits_on_table(tilt_deg, [MIXED[3], MIXED[2], UPRIGHT[0]])
    assert off_deg(supposed_tables(fits)[0], table_of(tilt_deg)) < 1.5


def test_neither_a_ball_nor_a_thin_part_supposes_a_table() -> None:
    thin: Standing = ("cylinder", 0.0, 0.0, 0.0, False, (0.03, 0.003))
    assert supposed_tables([None, *fits_on_table(40, [MIXED[3], thin])]) == []


@pytest.mark.parametrize(("roll_deg", "stable"), [(0, True), (60, True), (15, False), (30, False)])
def test_a_prism_hangs_on_a_side_not_on_an_edge(roll_deg: float, stable: bool) -> None:
    (fit,) = fits_on_table(40, NUTS[1:2], lifted_m=0.01)
    assert fit is not None and fit.kind == "hexprism"
    rolled = replace(fit, rotation=fit.rotation @ rotation((0, 0, np.deg2rad(roll_deg))))
    assert hangs_above(table_of(40), rolled) == stable
