"""What begins on the axis of another, where that ends, is hardly a part of its own."""

from __future__ import annotations

import evaluate_unknown
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from mahalanobis import CHI2_3
from rendering.rigs import rotation

from stereo_pick.core.doubts.coaxial import are_coaxial
from stereo_pick.core.shapes import SolidFit


def standing(
    base_m: float, thick_m: float, high_m: float, x_m: float = 0.0, lean_deg: float = 0.0, kind: str = "cylinder"
) -> SolidFit:
    """On the plane z = 1, or so far above it."""
    middle_m, turned = np.array([x_m, 0.0, 1.0 - base_m - high_m / 2]), rotation((np.deg2rad(lean_deg), 0.0, 0.0))
    return SolidFit(kind, middle_m, turned, np.array([thick_m, thick_m, high_m]), 0.1, 1e-8 * np.eye(3))


BODY, NECK = standing(0.0, 0.045, 0.03), standing(0.03, 0.02, 0.02)
HEAD = standing(0.0, 0.04, 0.015, kind="hexprism")


@pytest.mark.parametrize("pair", [(BODY, NECK), (HEAD, standing(0.015, 0.02, 0.03))], ids=["step", "bolt"])
@given(turn=st.tuples(*[st.floats(-3, 3)] * 3))
def test_diameters_of_one_part_are_coaxial_however_it_is_turned(
    pair: tuple[SolidFit, SolidFit], turn: tuple[float, float, float]
) -> None:
    whole = rotation(np.array(turn))
    one, other = (
        SolidFit(each.kind, whole @ each.centre_m, whole @ each.rotation, each.size_m, 0.1, each.covariance)
        for each in pair
    )
    assert are_coaxial(one, other) and are_coaxial(other, one)


@pytest.mark.parametrize(
    "other",
    [
        BODY,
        standing(0.03, 0.02, 0.02, x_m=0.002),
        standing(0.032, 0.02, 0.02),
        standing(0.03, 0.02, 0.02, lean_deg=3.0),
        standing(0.03, 0.02, 0.02, kind="box"),
    ],
    ids=["itself", "beside the axis", "above it", "leaning", "of a kind without an axis"],
)
def test_what_only_stands_on_another_is_not(other: SolidFit) -> None:
    assert not are_coaxial(BODY, other) and not are_coaxial(other, BODY)


@pytest.mark.parametrize("above_m", [0.0, 0.002, 0.01])
def test_nothing_hangs_above_another_but_a_piece_of_it(above_m: float) -> None:
    """The wide end of a turned part was found too short, 9 mm above the thin one, which was surely 16 mm off."""
    wide, up = standing(0.03 + above_m, 0.06, 0.015), np.array([0.0, 0.0, -1.0])
    assert are_coaxial(BODY, wide, up) and are_coaxial(wide, BODY, up)
    assert not are_coaxial(BODY, standing(0.03 + above_m, 0.06, 0.015, x_m=0.003), up)
    assert not are_coaxial(BODY, BODY, up)


def test_what_is_open_of_where_they_are_is_open_of_their_axis() -> None:
    beside = standing(0.03, 0.02, 0.02, x_m=0.0015)
    assert are_coaxial(BODY, beside, open_m=0.001) and not are_coaxial(BODY, beside, open_m=0.0005)
    assert not are_coaxial(BODY, standing(0.03, 0.02, 0.02, x_m=0.002), open_m=0.01)


def test_rods_that_lie_in_a_row_are_not() -> None:
    up = np.array([0.0, -1.0, 0.0])  # as that of a wall on which they stand
    assert not are_coaxial(BODY, standing(0.04, 0.045, 0.03), up)


def test_a_step_that_is_found_as_two_cylinders_is_neither_surely() -> None:
    """They were 6 and 22 mm from the centre of it, with a sigma of tenths."""
    scored = evaluate_unknown.scored(("dark", "step", 9))
    assert all(surprise < CHI2_3[95] for surprise in scored.mahalanobis2)
