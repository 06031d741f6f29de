"""Measures of an outline."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from outlines import disc
from rigs import rotation

from stereo_pick.core.arrays import Floats
from stereo_pick.core.errors import ArrayError
from stereo_pick.core.objects import Blob, Blobs
from stereo_pick.core.objects.blob import CUT

SIZES = st.floats(8, 80)
ANGLES = st.floats(-1.5, 1.5)
SHIFTS = st.floats(-300, 300)


def rectangle(length: float, width: float, angle: float, x: float = 0.0, y: float = 0.0) -> Floats:
    corners = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)]) * (length / 2, width / 2)
    return corners @ rotation((0, 0, angle))[:2, :2].T + (x, y)


@given(SIZES, SIZES, ANGLES, SHIFTS, SHIFTS)
def test_a_rectangle_has_its_area_and_centre(a: float, b: float, angle: float, x: float, y: float) -> None:
    blob = Blob(rectangle(a, b, angle, x, y), contrast=1.0)
    assert blob.area_px2 == pytest.approx(a * b)
    np.testing.assert_allclose(blob.centroid_px, (x, y), atol=1e-6)


@given(SIZES, SIZES, ANGLES, SHIFTS, SHIFTS)
def test_length_width_and_direction_are_those_of_the_rectangle(
    a: float, b: float, angle: float, x: float, y: float
) -> None:
    assume(a > 1.05 * b)
    length, width, direction = Blob(rectangle(a, b, angle, x, y), contrast=1.0).rectangle
    assert (length, width) == pytest.approx((a, b), rel=1e-3)
    assert np.sin(direction - angle) == pytest.approx(0, abs=0.01)
    assert -np.pi / 2 <= direction < np.pi / 2


@given(SIZES, SIZES, ANGLES)
def test_the_sense_of_the_outline_does_not_matter(a: float, b: float, angle: float) -> None:
    contour = rectangle(a, b, angle, 50, 60)
    one, other = Blob(contour, 1.0), Blob(contour[::-1], 1.0)
    assert one.area_px2 == pytest.approx(other.area_px2)
    np.testing.assert_allclose(one.centroid_px, other.centroid_px)


def test_a_triangle_has_its_centroid_not_that_of_its_corners_box() -> None:
    np.testing.assert_allclose(Blob(np.array([(0, 0), (9, 0), (0, 3)]), 1.0).centroid_px, (3, 1))


def test_an_outline_without_area_has_the_centroid_of_its_points() -> None:
    line = np.array([[3.0, 4.0], [5.0, 4.0], [7.0, 4.0], [5.0, 4.0]])
    assert Blob(line, 10.0).centroid_px.tolist() == [5.0, 4.0]


def test_rows_are_those_of_the_topmost_and_the_lowest_point() -> None:
    assert disc(50, 70, 20).rows_px == pytest.approx((50, 90))


@given(SIZES, SIZES, ANGLES)
def test_a_convex_outline_has_no_notch(a: float, b: float, angle: float) -> None:
    assert Blob(rectangle(a, b, angle, 100, 100), 1.0).concavity < 0.02


@given(st.floats(0.1, 0.9))
def test_a_notch_counts_as_a_part_of_the_width(part: float) -> None:
    notched = np.array([(0, 0), (45, 0), (50, 40 * part), (55, 0), (100, 0), (100, 40), (0, 40)])
    assert Blob(notched, 1.0).concavity == pytest.approx(part, abs=0.02)


@given(st.floats(0.1, 0.9))
def test_shade_beside_a_cut_is_no_notch(part: float) -> None:
    notched = np.array([(0, 0), (45, 0), (50, 40 * part), (55, 0), (100, 0), (100, 40), (50, 40), (0, 40)])
    soft, cut = np.array([1.0, 1.0, 0.0, 1.0, 1.0, 1.0, 1.0, 1.0]), 6
    sharpness = {"soft": soft, "sharp": np.ones(8)}
    uncut = {name: Blob(notched, 1.0, sharpness=each).concavity for name, each in sharpness.items()}
    for each in sharpness.values():
        each[cut] = CUT
    beside = {name: Blob(notched, 1.0, sharpness=each).concavity for name, each in sharpness.items()}
    assert beside["soft"] < 0.02
    assert [uncut["soft"], uncut["sharp"], beside["sharp"]] == pytest.approx([part] * 3, abs=0.02)


@pytest.mark.parametrize(("cut", "share"), [(None, 1 / 8), (1, 0.0), (6, 1 / 8)], ids=["none", "beside it", "far"])
def test_light_that_fades_in_a_notch_counts_unless_beside_a_cut(cut: int | None, share: float) -> None:
    notched = np.array([(0, 0), (45, 0), (50, 8), (55, 0), (100, 0), (100, 40), (50, 40), (0, 40)])
    sharpness = np.ones(8)
    sharpness[2] = 0.0
    if cut is not None:
        sharpness[cut] = CUT
    assert Blob(notched, 1.0, sharpness=sharpness).fading_notch == pytest.approx(share)


@given(st.floats(0.1, 0.9), st.booleans())
def test_all_but_the_points_of_a_notch_are_on_the_hull(part: float, backwards: bool) -> None:
    notched = np.array([(0, 0), (45, 0), (50, 40 * part), (55, 0), (100, 0), (100, 40), (0, 40)])
    order = slice(None, None, -1 if backwards else 1)
    assert Blob(notched[order], 1.0).on_hull.tolist() == [True, True, False, True, True, True, True][order]


@given(SIZES, SIZES, ANGLES)
def test_all_points_of_a_convex_outline_are_on_its_hull(a: float, b: float, angle: float) -> None:
    assert Blob(rectangle(a, b, angle, 100, 100), 1.0).on_hull.all()


@pytest.mark.parametrize(
    "contour", [np.zeros((2, 2)), np.zeros((5, 3)), np.full((4, 2), np.nan)], ids=["2", "3d", "nan"]
)
def test_what_is_no_outline_is_refused(contour: Floats) -> None:
    with pytest.raises(ArrayError, match="contour_px"):
        Blob(contour, 1.0)


def test_sound_objects_are_those_without_a_fault() -> None:
    good, bad = disc(10, 10), disc(60, 10, fault="merged")
    left, right = Blobs((good, bad), (bad,), "bright").sound()
    assert left == [good] and right == []
