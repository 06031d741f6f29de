"""Contours resampled for fitting."""

from __future__ import annotations

import numpy as np
import pytest

from stereo_pick.core.arrays import Floats
from stereo_pick.core.errors import ArrayError
from stereo_pick.core.shapes import Outline

MIDDLE = np.array([200.0, 150.0])


def circle(radius_px: float, points: int = 400) -> Floats:
    angle = np.linspace(0, 2 * np.pi, points, endpoint=False)
    return MIDDLE + radius_px * np.stack([np.cos(angle), np.sin(angle)], axis=1)


def square(half_px: float) -> Floats:
    t = np.linspace(-half_px, half_px, 60, endpoint=False)
    full = np.full(60, half_px)
    return MIDDLE + np.concatenate([np.c_[t, -full], np.c_[full, t], np.c_[-t, full], np.c_[-full, -t]])


@pytest.mark.parametrize("radius_px", [6.0, 20.0, 80.0])
@pytest.mark.parametrize("step", [1, -1])
def test_a_circle_stays_as_large_as_it_is_and_its_normals_point_outwards(radius_px: float, step: int) -> None:
    outline = Outline.from_contour(circle(radius_px)[::step])
    out = outline.points_px - MIDDLE
    np.testing.assert_allclose(np.linalg.norm(out, axis=1), radius_px, rtol=3e-5)
    np.testing.assert_allclose(outline.normals, out / radius_px, atol=1e-3)
    assert outline.weight.all() and not outline.corner.any()


def test_points_lie_at_equal_distances_however_the_contour_was_sampled() -> None:
    angle = 2 * np.pi * np.linspace(0, 1, 500, endpoint=False) ** 2
    outline = Outline.from_contour(MIDDLE + 30 * np.stack([np.cos(angle), np.sin(angle)], axis=1))
    gaps = np.linalg.norm(np.roll(outline.points_px, -1, axis=0) - outline.points_px, axis=1)
    np.testing.assert_allclose(gaps, gaps.mean(), rtol=2e-3)


def test_corners_are_marked_and_everything_else_lies_on_the_sides() -> None:
    outline = Outline.from_contour(square(30.0))
    sides = outline.corner == 0
    assert 4 <= (~sides).sum() <= 12
    np.testing.assert_allclose(np.abs(outline.points_px[sides] - MIDDLE).max(axis=1), 30.0, atol=1e-9)
    np.testing.assert_allclose(np.abs(outline.normals[sides]).max(axis=1), 1.0, atol=1e-9)


def test_what_is_not_the_objects_edge_has_no_weight() -> None:
    contour = circle(25.0)
    own = contour[:, 0] > MIDDLE[0]
    for step in (1, -1):
        outline = Outline.from_contour(contour[::step], own[::step])
        right = outline.points_px[:, 0] - MIDDLE[0]
        assert outline.weight[right > 4].all() and not outline.weight[right < 0].any()


def test_a_contour_without_extent_is_refused() -> None:
    with pytest.raises(ArrayError, match="no length"):
        Outline.from_contour(np.tile(MIDDLE, (5, 1)))
