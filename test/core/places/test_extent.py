"""How a solid's axes become length, width and height."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from rigs import rotation

from stereo_pick.core.arrays import Floats
from stereo_pick.core.errors import ArrayError
from stereo_pick.core.places.extent import KINDS, Extent, extent_of
from stereo_pick.core.shapes import SolidFit

CENTRE = np.array([0.05, -0.03, 0.8])
UPRIGHT = rotation((np.deg2rad(140), 0.05, 0.0))
UP = UPRIGHT[:, 2]

anywhere = st.tuples(*[st.floats(-3, 3)] * 3)
yaw = st.floats(-3.1, 3.1)


def fit(kind: str, turn: Floats, size_m: tuple[float, float, float]) -> SolidFit:
    return SolidFit(kind, CENTRE, turn, np.array(size_m), 0.1, 1e-8 * np.eye(3))


def check_frame(extent: Extent, down: Floats) -> None:
    np.testing.assert_allclose(extent.rotation.T @ extent.rotation, np.eye(3), atol=1e-9)
    assert np.linalg.det(extent.rotation) == pytest.approx(1)
    np.testing.assert_allclose(extent.rotation[:, 2], down, atol=1e-9)


@given(yaw, st.permutations([0.03, 0.05, 0.08]), st.permutations(range(3)), st.integers(0, 7))
def test_a_box_has_its_longer_side_first_and_its_height_last(
    yaw_rad: float, sizes: list[float], order: list[int], flips: int
) -> None:
    """Whichever of its axes is called first, and whichever way each points."""
    stands = UPRIGHT @ rotation((0, 0, yaw_rad))
    signs = np.array([1 - 2 * (flips >> i & 1) for i in range(3)])
    axes = (stands * signs)[:, order]
    extent = extent_of(fit("box", axes, tuple(np.array(sizes)[order])), UP)
    np.testing.assert_allclose(extent.size_m, [max(sizes[:2]), min(sizes[:2]), sizes[2]])
    check_frame(extent, -UP)
    assert abs(extent.rotation[:, 0] @ stands[:, int(np.argmax(sizes[:2]))]) == pytest.approx(1)
    assert extent.rotation[0, 0] >= -1e-12


@given(yaw)
def test_a_lying_cylinders_length_is_its_axis(yaw_rad: float) -> None:
    lies = UPRIGHT @ rotation((0, 0, yaw_rad)) @ rotation((0, np.pi / 2, 0))
    extent = extent_of(fit("cylinder", lies, (0.03, 0.03, 0.02)), UP)  # even where it is shorter than thick
    np.testing.assert_allclose(extent.size_m, [0.02, 0.03, 0.03])
    check_frame(extent, -UP)
    assert abs(extent.rotation[:, 0] @ lies[:, 2]) == pytest.approx(1)


@given(yaw, st.booleans())
def test_a_standing_cylinder_looks_the_same_however_it_is_turned(yaw_rad: float, head_down: bool) -> None:
    stands = UPRIGHT @ rotation((0, 0, yaw_rad)) @ rotation((np.pi if head_down else 0, 0, 0))
    extent = extent_of(fit("cylinder", stands, (0.03, 0.03, 0.06)), UP)
    reference = extent_of(fit("cylinder", UPRIGHT, (0.03, 0.03, 0.06)), UP)
    np.testing.assert_allclose(extent.size_m, [0.03, 0.03, 0.06])
    np.testing.assert_allclose(extent.rotation, reference.rotation, atol=1e-9)
    check_frame(extent, -UP)


@given(yaw, st.integers(0, 5), st.booleans())
def test_a_standing_nuts_length_is_across_corners_and_its_width_across_flats(
    yaw_rad: float, sixth: int, head_down: bool
) -> None:
    """Whichever of its corners is taken for the first axis, and whichever end is up."""
    stands = UPRIGHT @ rotation((0, 0, yaw_rad))
    own = rotation((0, 0, sixth * np.pi / 3)) @ rotation((np.pi if head_down else 0, 0, 0))
    extent = extent_of(fit("hexprism", stands @ own, (0.0231, 0.02, 0.01)), UP)
    np.testing.assert_allclose(extent.size_m, [0.0231, 0.02, 0.01])
    check_frame(extent, -UP)
    corners = np.stack([stands @ rotation((0, 0, turn)) @ (1, 0, 0) for turn in np.arange(6) * np.pi / 3])
    assert (corners @ extent.rotation[:, 0]).max() == pytest.approx(1)


@given(yaw, st.sampled_from([1, 3, 5]))
def test_a_nut_that_lies_on_a_flat_is_as_high_as_it_is_across_flats(yaw_rad: float, sixth: int) -> None:
    on_flat = rotation((0, np.pi / 2, 0)) @ rotation((0, 0, sixth * np.pi / 6))
    extent = extent_of(fit("hexprism", UPRIGHT @ rotation((0, 0, yaw_rad)) @ on_flat, (0.0231, 0.02, 0.05)), UP)
    np.testing.assert_allclose(extent.size_m, [0.05, 0.0231, 0.02])
    check_frame(extent, -UP)


def test_the_codes_in_messages_keep_their_meaning() -> None:
    assert KINDS == ("", "sphere", "cylinder", "box", "hexprism")


@given(anywhere)
def test_a_balls_rotation_is_that_of_the_view_and_the_table(turn: tuple[float, float, float]) -> None:
    extent = extent_of(fit("sphere", rotation(turn), (0.04, 0.04, 0.04)), UP)
    check_frame(extent, -UP)
    across = np.cross(UP, (1.0, 0.0, 0.0))  # the length has no part across the rows
    assert extent.rotation[:, 0] @ across == pytest.approx(0, abs=1e-9) and extent.rotation[0, 0] > 0


@pytest.mark.parametrize("kind", KINDS[1:])
def test_without_a_table_down_is_away_from_the_camera(kind: str) -> None:
    extent = extent_of(fit(kind, UPRIGHT, (0.03, 0.03, 0.05)), None)
    away = CENTRE / np.linalg.norm(CENTRE)
    assert extent.rotation[:, 2] @ away > 0.7
    assert np.linalg.det(extent.rotation) == pytest.approx(1)


def test_what_cannot_be_is_not_made() -> None:
    with pytest.raises(ArrayError, match="kind is ''"):
        Extent("", np.eye(3), np.ones(3))
    with pytest.raises(ArrayError, match="size_m holds nan"):
        Extent("box", np.eye(3), np.array([1.0, np.nan, 1.0]))
