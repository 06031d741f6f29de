"""How far arcs lie off their solids, and what that says of how far light has moved them."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from stereo_pick.core.arrays import Floats
from stereo_pick.core.edges.arcs import Arcs, arc_sigmas_px, arcs_of
from stereo_pick.core.shapes.evidence import ARC_PX

POINTS = 120
UNKNOWNS = 7


def arcs(residual_px: Floats, trust: Floats | None = None, length_px: float = 12 * ARC_PX) -> Arcs:
    """Of one solid, with residuals (2, POINTS)."""
    everywhere = np.ones((1, 2, POINTS)) if trust is None else trust[None]
    return arcs_of(residual_px[None], everywhere, np.full((1, 2), length_px), UNKNOWNS)


def sigma_px(*solids: Arcs, shown: float = 1.0) -> Floats:
    """Of solids of one scene, each of its own kind."""
    return np.concatenate(arc_sigmas_px(solids, [np.full(len(each.number), shown) for each in solids]))


def scattered(by_px: float) -> Arcs:
    """24 arcs of which each lies off by so much, to either side."""
    return arcs(by_px * np.tile(np.repeat([1.0, -1.0], 10), (2, 6)))


def test_arcs_that_lie_off_count_as_far_as_they_do() -> None:
    found = scattered(0.1)
    assert found.number[0] == 24 and found.squares_px2[0] == pytest.approx(24 * 0.1**2)


def test_what_changes_within_an_arc_moves_none() -> None:
    found = arcs(np.tile([0.1, -0.1], (2, POINTS // 2)))
    assert found.number[0] == 24 and found.squares_px2[0] == pytest.approx(0.0, abs=1e-20)


@given(length_px=st.floats(30, 9000))
def test_there_are_as_many_as_fit_the_silhouettes_and_no_more_than_points(length_px: float) -> None:
    found = arcs(np.full((2, POINTS), 0.1), length_px=length_px)
    assert found.number[0] == 2 * min(max(1, round(length_px / ARC_PX)), POINTS)
    assert found.squares_px2[0] == pytest.approx(found.number[0] * 0.1**2)


def test_arcs_on_no_edge_do_not_count() -> None:
    trust = np.ones((2, POINTS))
    trust[0, :60] = 0
    residual_px = np.where(trust > 0, 0.1, 5.0)
    found = arcs(residual_px, trust)
    assert found.number[0] == 18 and found.squares_px2[0] == pytest.approx(18 * 0.1**2)


@given(st.floats(0, 0.3), st.floats(0, 0.3))
def test_the_farther_arcs_lie_off_the_less_sure_they_are(one_px: float, other_px: float) -> None:
    near, far = sorted((one_px, other_px))
    assert sigma_px(scattered(near))[0] <= sigma_px(scattered(far))[0]


def test_what_lies_off_in_a_scene_makes_all_of_it_less_sure() -> None:
    """The light is the same for all; but most of all it is the part's own."""
    alone = sigma_px(scattered(0.02))[0]
    smooth, rough = sigma_px(scattered(0.02), scattered(0.2))
    assert alone < smooth < rough


def test_of_many_arcs_what_is_usual_says_little() -> None:
    """From arcs moved by the same light, its sigma is the same, whatever the solids are like."""
    many = Arcs(np.full(50, 24 * 0.1**2), np.full(50, 24.0), UNKNOWNS)
    few = Arcs(np.array([6 * 0.1**2]), np.array([6.0]), UNKNOWNS)
    sigmas = sigma_px(many, few)
    assert sigmas == pytest.approx(np.full(51, sigmas[0]), rel=0.01)
    assert sigmas[0] == pytest.approx(2 * sigma_px(Arcs(many.squares_px2 / 4, many.number, UNKNOWNS), few)[0], rel=0.02)


def test_what_can_go_with_its_edges_is_less_sure() -> None:
    """A ball has no axes to turn about: what its arcs lie off it is most of what light has moved them by."""
    ball = scattered(0.1)._replace(unknowns=4)
    assert sigma_px(ball) == pytest.approx(4 / UNKNOWNS * sigma_px(scattered(0.1)))


def test_what_shows_half_of_itself_is_a_quarter_as_sure() -> None:
    assert sigma_px(scattered(0.1), shown=0.5) == pytest.approx(4 * sigma_px(scattered(0.1)))
