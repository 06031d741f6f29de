"""Cylinders whose outlines leave out an end: exact geometry."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from rigs import RIGS, rotation
from solid_outlines import Part, contours_px, disturbed, side_contours_px

from stereo_pick.core.arrays import Floats
from stereo_pick.core.edges.rims import to_rims
from stereo_pick.core.shapes import SolidFit

RIG = RIGS["verged"]
RADIUS_M, HALF_M = 0.018, 0.03


def lying(turn: float, tilt: float) -> Part:
    """A cylinder half a metre away that shows each camera its side, and one of its ends a little."""
    return Part(
        "cylinder",
        np.array([0.06, 0.02, 0.5]),
        rotation(np.array([tilt, 0.0, 0.0])) @ _axis(turn),
        np.array([RADIUS_M, HALF_M]),
    )


def _axis(turn: float) -> Floats:
    """Axes of which the third lies in the image plane, turned by so much from the rows."""
    third = np.array([np.cos(turn), np.sin(turn), 0.0])
    first = np.array([0.0, 0.0, 1.0])
    return np.stack([first, np.cross(third, first), third], axis=1)


def side_px(part: Part, noise_px: float = 0.0) -> list[Floats]:
    """What each view shows of the round side alone."""
    rng = np.random.default_rng(0)
    outlines = side_contours_px(part, RIG)
    return [disturbed(each, noise_px, rng) for each in outlines] if noise_px else list(outlines)


def fit_of(part: Part, low_m: float = -HALF_M, high_m: float = HALF_M) -> SolidFit:
    """The part as a fit, with its ends at these places on its axis."""
    size_m = np.array([2 * RADIUS_M, 2 * RADIUS_M, high_m - low_m])
    centre_m = part.centre_m + part.rotation[:, 2] * (low_m + high_m) / 2
    return SolidFit("cylinder", centre_m, part.rotation, size_m, 0.1, np.eye(3) * 1e-8)


@given(
    st.floats(-1.5, 1.5), st.sampled_from([-0.5, -0.35, 0.35, 0.5]), st.floats(0.1, 0.35), st.sampled_from([-1.0, 1.0])
)
def test_an_end_that_is_not_seen_is_found_by_its_rim(turn: float, tilt: float, short: float, end: float) -> None:
    part = lying(turn, tilt)
    cut = [-HALF_M * (1 - short * (end < 0)), HALF_M * (1 - short * (end > 0))]
    found = to_rims(fit_of(part, *cut), RIG, side_px(part))
    np.testing.assert_allclose(found.size_m[2], 2 * HALF_M, atol=3e-4)
    np.testing.assert_allclose(found.centre_m, part.centre_m, atol=2e-4)


@pytest.mark.parametrize("lit", [slice(0, 75), slice(75, 150)], ids=["one side", "the other"])
@pytest.mark.parametrize("turn", [0.2, 1.0, -0.7])
def test_half_of_a_rim_is_enough(turn: float, lit: slice) -> None:
    """The side turns away from the light, until it is as dark as the end."""
    part = lying(turn, 0.4)
    outlines = [np.concatenate([seen[:150][lit], seen[150:][::-1][lit]]) for seen in side_px(part)]
    found = to_rims(fit_of(part, high_m=0.7 * HALF_M), RIG, outlines)
    np.testing.assert_allclose(found.size_m[2], 2 * HALF_M, atol=3e-4)


@pytest.mark.parametrize("turn", [0.2, 1.0, -0.7])
def test_rough_edges_move_it_by_no_more_than_they_are_rough(turn: float) -> None:
    part = lying(turn, 0.4)
    found = to_rims(fit_of(part, high_m=0.75 * HALF_M), RIG, side_px(part, noise_px=0.2))
    pixel_m = 0.5 / RIG.focal_px
    assert abs(found.size_m[2] - 2 * HALF_M) < 2 * 0.2 * pixel_m / np.cos(0.4)


@given(st.floats(-1.5, 1.5), st.floats(-0.6, 0.6))
def test_a_cylinder_that_its_outlines_show_whole_stays(turn: float, tilt: float) -> None:
    part = lying(turn, tilt)
    fit = fit_of(part)
    assert to_rims(fit, RIG, list(contours_px(part, RIG))) is fit


def test_a_rim_in_one_view_only_is_not_believed() -> None:
    part = lying(0.3, 0.4)
    short = fit_of(part, high_m=0.7 * HALF_M)
    seen = side_px(part)
    for view in (0, 1):
        without = [seen[view], np.zeros((0, 2))]
        assert to_rims(short, RIG, without if view == 0 else without[::-1]) is short


def test_a_solid_of_no_outline_stays() -> None:
    fit = fit_of(lying(0.0, 0.3))
    assert to_rims(fit, RIG, [np.zeros((0, 2)), np.zeros((0, 2))]) is fit
