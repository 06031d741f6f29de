"""Pieces of one part are flush; parts that only touch are not."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from rendering.rigs import rotation
from rigs import RIGS

from stereo_pick.core.correspondence.flush_boxes import are_flush, moved_m
from stereo_pick.core.shapes import SolidFit

Size = tuple[float, float, float]
RIG = RIGS["thesis"]


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
    assert are_flush(one, other, RIG) and are_flush(other, one, RIG)


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
    assert not are_flush(one, other, RIG) and not are_flush(other, one, RIG)


def test_a_piece_may_be_hidden_between_what_is_seen_together() -> None:
    """A wall before the cameras hides where its foot ends; two that are flush on one side, with the table seen between
    them, are apart."""
    wall, foot = box((0.0, 0.0, 0.9), (0.05, 0.05, 0.01)), box((0.0, 0.019, 0.937), (0.05, 0.012, 0.04))
    assert are_flush(wall, foot, RIG) and are_flush(foot, wall, RIG)
    assert not are_flush(wall, replace(foot, centre_m=np.array([0.0, 0.019, 0.98])), RIG)
    assert are_flush(standing(0.0, 0.0, (0.01, 0.05, 0.05)), standing(0.033, 0.0, (0.04, 0.05, 0.012)), RIG)
    wall, foot = box((0.0, 0.0, 0.9), (0.01, 0.05, 0.05)), box((0.033, 0.019, 0.895), (0.04, 0.012, 0.04))
    assert not are_flush(wall, foot, RIG)


def test_the_centre_of_both_is_that_of_their_volumes() -> None:
    volumes = [np.prod(each.size_m) for each in (BAR, STEM)]
    both = (volumes[0] * BAR.centre_m + volumes[1] * STEM.centre_m) / sum(volumes)
    assert moved_m(BAR, STEM) == pytest.approx(float(np.linalg.norm(both - BAR.centre_m)))
    assert moved_m(STEM, BAR) == pytest.approx(float(np.linalg.norm(both - STEM.centre_m)))
