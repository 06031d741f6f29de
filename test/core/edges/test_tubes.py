"""Cylinders of which the side alone is seen: exact geometry."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from outlines import blank_pair, grey_image
from rigs import RIGS, rotation
from solid_outlines import Part, contours_px, disturbed, side_contours_px

from stereo_pick.core.arrays import Floats
from stereo_pick.core.camera import Camera
from stereo_pick.core.edges.hypotheses import Images
from stereo_pick.core.edges.tubes import tube_of
from stereo_pick.core.frames import RectifiedPair
from stereo_pick.core.shapes import Outline, fit_solid
from stereo_pick.core.shapes.fitting import Pair
from stereo_pick.core.shapes.table import Table

RIG = RIGS["verged"]
HALF_M = np.array([0.016, 0.034])


def tube(turn: float, tilt: float) -> Part:
    """A tube half a metre away; turn: of its axis from the rows [rad], tilt: of that out of the image plane [rad]."""
    axis = np.array([np.cos(turn), np.sin(turn), 0.0])
    lying = np.stack([[0.0, 0.0, 1.0], np.cross(axis, [0.0, 0.0, 1.0]), axis], axis=1)
    about = np.cross(axis, [0.0, 0.0, 1.0])
    return Part("cylinder", np.array([0.06, 0.02, 0.5]), rotation(tilt * about) @ lying, HALF_M)


def sides(part: Part, noise_px: float = 0.0, seed: int = 0) -> Pair:
    rng = np.random.default_rng(seed)
    contours = side_contours_px(part, RIG)
    left, right = (disturbed(each, noise_px, rng) if noise_px else each for each in contours)
    return Outline.from_contour(left), Outline.from_contour(right)


@settings(max_examples=20, deadline=None)
@given(st.floats(-1.5, 1.5), st.sampled_from([-0.45, -0.25, 0.0, 0.25, 0.45]))
def test_a_tube_is_where_its_side_says(turn: float, tilt: float) -> None:
    part = tube(turn, tilt)
    found = tube_of(Images(blank_pair(RIG)), sides(part))
    assert found is not None
    assert found.fit.kind == "cylinder"
    np.testing.assert_allclose(found.fit.centre_m, part.centre_m, atol=2e-4)
    np.testing.assert_allclose(found.fit.size_m, 2 * HALF_M[[0, 0, 1]], atol=4e-4)


@pytest.mark.parametrize("turn", [0.1, 0.8, -0.6])
def test_no_convex_solid_explains_an_end_that_looks_like_a_bite(turn: float) -> None:
    """Without tubes, the centre between the outlines would be taken: it is millimetres nearer."""
    assert fit_solid(*sides(tube(turn, 0.4)), RIG) is None


@pytest.mark.parametrize("turn", [0.1, 0.8, -0.6])
def test_a_rough_tube_is_as_unsure_as_it_is_rough(turn: float) -> None:
    """Taped: its outlines are off by half a pixel."""
    part, images = tube(turn, 0.3), Images(blank_pair(RIG))
    squares = []
    for seed in range(8):
        found = tube_of(images, sides(part, 0.5, seed))
        assert found is not None
        off_m = found.fit.centre_m - part.centre_m
        squares.append(float(off_m @ np.linalg.solve(found.fit.covariance + found.doubt, off_m)))
        assert np.linalg.norm(off_m) < 4e-3
    assert np.median(squares) < 7.81


def with_hidden_end(part: Part) -> Pair:
    """Its outlines, cut straight and across near the one end by something else."""
    left, right = (_cut(side, part, camera) for side, camera in zip(sides(part), (RIG.left, RIG.right)))
    return left, right


def _cut(side: Outline, part: Part, camera: Camera) -> Outline:
    ends = part.centre_m + part.half_m[1] * np.outer([-1, 1], part.rotation[:, 2])
    seen = np.c_[ends, np.ones(2)] @ camera.P.T
    first, last = seen[:, :2] / seen[:, 2:]
    gone = (side.points_px - first) @ (last - first) > 0.8 * (last - first) @ (last - first)
    before = np.flatnonzero(~gone & np.roll(gone, -1))[0]
    chord = (before + 1 + np.arange(gone.sum())) % len(gone)
    begin, end = side.points_px[before], side.points_px[(chord[-1] + 1) % len(gone)]
    points_px, weight = side.points_px.copy(), side.weight.copy()
    points_px[chord] = begin + np.linspace(0, 1, len(chord) + 2)[1:-1, None] * (end - begin)
    weight[chord] = 0
    return replace(side, points_px=points_px, weight=weight)


@pytest.mark.parametrize("tilt", [0.3, 0.0, -0.3])
@pytest.mark.parametrize("turn", [0.1, 0.8, -0.6])
def test_where_one_is_whose_end_is_hidden_is_not_known(turn: float, tilt: float) -> None:
    assert tube_of(Images(blank_pair(RIG)), with_hidden_end(tube(turn, tilt))) is None


def beside(part: Part, gap_m: float) -> Part:
    """A tube across the end of another that is cut off; gap_m: between them, or how much of the end it covers."""
    axis, across = part.rotation[:, 2], part.rotation[:, 1]
    away_m = part.half_m[1] + part.half_m[0] + gap_m
    return replace(
        part,
        centre_m=part.centre_m + away_m * axis,
        rotation=np.stack([np.cross(axis, across), axis, across], axis=1),
    )


def below(part: Part) -> Table:
    """What it lies on."""
    down = part.rotation[:, 0]
    return Table(-down, float(down @ part.centre_m + HALF_M[0]), 1e-4)


def shown(left: Sequence[Part], right: Sequence[Part]) -> Images:
    """What is dark on white paper in each view, the later before the earlier."""
    views = (drawn(parts, side) for side, parts in enumerate((left, right)))
    return Images(RectifiedPair(*(grey_image(view) for view in views), RIG))


def drawn(parts: Sequence[Part], side: int, finer: int = 8) -> Floats:
    light = np.full((RIG.left.height_px * finer, RIG.left.width_px * finer), 220.0, np.float32)
    for level, part in zip((60, 75), parts):
        contour = (side_contours_px(part, RIG)[side] + 0.5) * finer - 0.5
        cv2.fillPoly(light, [contour.round().astype(np.int32)], level)
    return cv2.resize(light, None, fx=1 / finer, fy=1 / finer, interpolation=cv2.INTER_AREA).astype(np.float64)


@pytest.mark.parametrize("tilt", [0.3, 0.0, -0.3])
@pytest.mark.parametrize("turn", [0.1, 0.8, -0.6])
def test_one_that_touches_another_ends_where_its_rim_is_seen(turn: float, tilt: float) -> None:
    part = tube(turn, tilt)
    both = [part, beside(part, 0.012)]
    found = tube_of(shown(both, both), with_hidden_end(part), below(part))
    assert found is not None
    np.testing.assert_allclose(found.fit.size_m, 2 * HALF_M[[0, 0, 1]], atol=6e-4)
    np.testing.assert_allclose(found.fit.centre_m, part.centre_m, atol=6e-4)


@pytest.mark.parametrize("views", ["both", "left", "right"])
@pytest.mark.parametrize("turn", [0.1, 0.8, -0.6])
def test_where_one_ends_is_not_known_unless_both_views_show_it(turn: float, views: str) -> None:
    part = tube(turn, 0.0)
    free, covered = [part, beside(part, 0.012)], [part, beside(part, -0.012)]
    images = shown(free if views == "right" else covered, free if views == "left" else covered)
    assert tube_of(images, with_hidden_end(part), below(part)) is None


@pytest.mark.parametrize("kind, half_m", [("box", (0.015, 0.02, 0.034)), ("sphere", (0.02,))])
def test_what_is_no_tube_is_none(kind: str, half_m: tuple[float, ...]) -> None:
    for turn in (0.2, 0.9, -0.7):
        part = Part(kind, np.array([0.06, 0.02, 0.5]), rotation(np.array([0.4, turn, turn])), np.array(half_m))
        left, right = (Outline.from_contour(each) for each in contours_px(part, RIG))
        assert tube_of(Images(blank_pair(RIG)), (left, right)) is None
