"""Predicted silhouettes and points along them."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from rigs import RIGS
from solid_outlines import any_part, contours_px, distances_px

from stereo_pick.core.arrays import Floats
from stereo_pick.core.shapes import SolidFit
from stereo_pick.core.shapes.kinds import KINDS
from stereo_pick.core.shapes.predicted import along_polygon, silhouettes, values_along

RIG = RIGS["verged"]
EYES = np.array([[0.0, 0.0, 0.0], [RIG.baseline_m, 0.0, 0.0]])
DRAWN = ("sphere", "cylinder", "box")


def signed_area(corners: Floats) -> float:
    x, y = corners.T
    return 0.5 * float(x @ np.roll(y, -1) - y @ np.roll(x, -1))


@pytest.mark.parametrize("kind", DRAWN)
@pytest.mark.parametrize("seed", range(6))
def test_a_silhouette_lies_on_the_hull_of_the_projected_solid_and_covers_it(kind: str, seed: int) -> None:
    part = any_part(kind, RIG, np.random.default_rng(seed))
    size_m = 2 * part.half_m[list(KINDS[kind].axes)]
    solid = SolidFit(kind, part.centre_m, part.rotation, size_m, 0.1, np.eye(3)).solid
    for polygon, camera, contour in zip(silhouettes(solid, EYES)[0], (RIG.left, RIG.right), contours_px(part, RIG)):
        polygon_px = polygon * RIG.focal_px + camera.P[:2, 2]
        assert np.abs(distances_px(polygon_px, contour)).max() < 0.05
        area = abs(signed_area(contour))
        assert 0.98 * area < signed_area(polygon_px) < 1.001 * area  # positive: it turns from x towards y


@pytest.mark.parametrize("count", [7, 40, 72])
def test_points_along_a_polygon_are_even_and_their_normals_point_outwards(count: int) -> None:
    rng = np.random.default_rng(count)
    angle = np.sort(rng.uniform(0, 2 * np.pi, (3, 9)), axis=1)
    corners = np.stack([np.cos(angle), 0.4 * np.sin(angle)], axis=2) + rng.normal(size=(3, 1, 2))
    points, normals = along_polygon(corners, count)
    assert points.shape == normals.shape == (3, count, 2)
    np.testing.assert_allclose(np.linalg.norm(normals, axis=2), 1, atol=1e-6)
    for polygon, at, outward in zip(corners, points, normals):
        ahead = np.roll(polygon, -1, axis=0) - polygon
        length = np.linalg.norm(ahead, axis=1)
        along = [place_along(point, polygon, ahead, length) for point in at]
        np.testing.assert_allclose(along, (np.arange(count) + 0.5) / count * length.sum(), atol=1e-6)
        inside = distances_px(1000 * (at - 1e-3 * outward), 1000 * polygon)
        outside = distances_px(1000 * (at + 1e-3 * outward), 1000 * polygon)
        assert (inside[inside != 0] > 0).mean() > 0.9 and (outside < 0).all()


def place_along(point: Floats, polygon: Floats, ahead: Floats, length: Floats) -> float:
    """How far along the polygon a point on it lies."""
    part = np.clip(((point - polygon) * ahead).sum(axis=1) / length**2, 0, 1)
    off = np.linalg.norm(polygon + part[:, None] * ahead - point, axis=1)
    side = int(off.argmin())
    assert off[side] < 1e-9
    return float(length[:side].sum() + part[side] * length[side])


@given(st.integers(1, 300))
def test_what_changes_evenly_from_corner_to_corner_does_so_at_points_between(count: int) -> None:
    random = np.random.default_rng(count)
    angles = np.sort(random.uniform(0, 2 * np.pi, 12))
    corners = np.stack([np.cos(angles), np.sin(angles)], axis=1)[None]
    points, _ = along_polygon(corners, count)
    slope, level = random.normal(size=2), random.normal()
    np.testing.assert_allclose(values_along(corners, corners @ slope + level, count), points @ slope + level, atol=1e-9)
