"""Pieces of one part are flush; parts that only touch are not."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from rendering.rigs import rotation

from stereo_pick.core.doubts.flush_boxes import are_flush, moved_m
from stereo_pick.core.shapes import SolidFit

Size = tuple[float, float, float]


def box(middle_m: Size, size_m: Size, turned_deg: float = 0.0, kind: str = "box") -> SolidFit:
    turned = rotation((0.0, 0.0, np.deg2rad(turned_deg)))
    return SolidFit(kind, np.array(middle_m), turned, np.array(size_m), 0.1, 1e-8 * np.eye(3))


def standing(x_m: float, y_m: float, size_m: Size, turned_deg: float = 0.0) -> SolidFit:
    """On the plane z = 1."""
    return box((x_m, y_m, 1.0 - size_m[2] / 2), size_m, turned_deg)


FOOT = standing(0.0, 0.0, (0.06, 0.04, 0.01))
WALL = standing(0.034, 0.0, (0.008, 0.04, 0.05))
BAR = standing(0.0, 0.0, (0.015, 0.06, 0.03))
STEM = standing(0.0275, 0.0, (0.04, 0.014, 0.03))
LONG = standing(0.02, 0.0, (0.055, 0.014, 0.03))


@pytest.mark.parametrize("pair", [(FOOT, WALL), (BAR, STEM), (BAR, LONG)], ids=["bracket", "T", "T, its stem too long"])
@given(turn=st.tuples(*[st.floats(-3, 3)] * 3))
def test_flanges_and_arms_are_flush_however_they_are_turned(
    pair: tuple[SolidFit, SolidFit], turn: tuple[float, float, float]
) -> None:
    whole = rotation(np.array(turn))
    one, other = (
        SolidFit("box", whole @ each.centre_m, whole @ each.rotation, each.size_m, 0.1, each.covariance)
        for each in pair
    )
    assert are_flush(one, other, touch=False) and are_flush(other, one, touch=False)


@pytest.mark.parametrize(
    ("one", "other"),
    [
        (BAR, standing(0.0275, 0.0, (0.04, 0.014, 0.035))),
        (BAR, standing(0.0305, 0.0, (0.04, 0.014, 0.03), turned_deg=8)),
        (BAR, standing(0.015, 0.0, BAR.size_m)),
        (BAR, standing(0.035, 0.0, (0.04, 0.014, 0.03))),
        (BAR, box((0.0275, 0.0, 0.985), (0.04, 0.04, 0.03), kind="cylinder")),
    ],
    ids=["another height", "at an angle", "equal ones in a row", "apart", "of another kind"],
)
def test_what_only_touches_is_not(one: SolidFit, other: SolidFit) -> None:
    assert not are_flush(one, other, touch=False) and not are_flush(other, one, touch=False)


def test_a_short_stem_may_be_found_turned_by_as_much_as_what_is_flush_is_off() -> None:
    """One of 36 mm, half of it hidden, was turned by 1.7 degrees: both were published, 10 mm off and sure of it."""
    turned = standing(0.0275, 0.0, (0.036, 0.014, 0.03), turned_deg=1.8)
    assert are_flush(BAR, turned, touch=True) and are_flush(turned, BAR, touch=True)


@pytest.mark.parametrize("open_m", [0.0, 0.001])
def test_what_is_open_of_where_boxes_are_is_open_of_whether_they_are_flush(open_m: float) -> None:
    """The foot of a bracket was turned by 3 degrees, and known to 3 mm only."""
    turned = standing(0.0275, 0.0, (0.036, 0.014, 0.03), turned_deg=3.0)
    assert are_flush(BAR, turned, touch=True, open_m=open_m) == (open_m > 0)
    more = standing(0.0275, 0.0, (0.036, 0.014, 0.03), turned_deg=6.0)
    assert not are_flush(BAR, more, touch=True, open_m=10 * open_m)  # else all beside what is unsure would be


def test_what_is_flush_to_one_of_two_is_flush_to_both() -> None:
    """Each is turned a little, so that its faces are off by another amount from those of the other."""
    long = box((0.0, 0.0, 1.0), (0.0147, 0.0478, 0.0264))
    short = replace(box((0.0248, 0.0, 1.0005), (0.0309, 0.0146, 0.0253)), rotation=rotation((0.0, -0.0081, 0.0)))
    assert are_flush(long, short, touch=True) and are_flush(short, long, touch=True)


def test_a_piece_may_be_hidden_between_what_touches_in_both_views_or_is_flush_on_both_sides() -> None:
    far, shorter = standing(0.06, 0.0, (0.03, 0.014, 0.03)), standing(0.0325, 0.0, (0.03, 0.014, 0.03))
    assert are_flush(BAR, shorter, touch=True) and not are_flush(BAR, shorter, touch=False)
    rest = standing(0.0395, 0.0, (0.014, 0.014, 0.03))
    assert are_flush(BAR, rest, touch=True) and are_flush(rest, BAR, touch=True)
    assert not are_flush(BAR, far, touch=True)
    wide = standing(0.0325, 0.0, (0.03, 0.06, 0.01))
    assert are_flush(BAR, wide, touch=False) and are_flush(wide, BAR, touch=False)


def test_the_centre_of_both_is_that_of_their_volumes() -> None:
    volumes = [np.prod(each.size_m) for each in (BAR, STEM)]
    both = (volumes[0] * BAR.centre_m + volumes[1] * STEM.centre_m) / sum(volumes)
    assert moved_m(BAR, STEM) == pytest.approx(float(np.linalg.norm(both - BAR.centre_m)))
    assert moved_m(STEM, BAR) == pytest.approx(float(np.linalg.norm(both - STEM.centre_m)))
