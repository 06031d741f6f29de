"""Lamps, shadows and sensors of the renderer against geometry."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from outlines import PARALLEL
from rendering import Box, Edge, Lamp, Scene, Sensor, Solid, lamp_at, render, views_of
from rendering.shadows import ShadowMap, visible_from
from test_rendering_solids import every_solid

from stereo_pick.core.arrays import Floats

LOW_LAMP = lamp_at(30, 20, radius_m=0)
IDEAL = Sensor(blur_px=0, noise_dn=0)


def on_table(x: Floats, y: Floats | float) -> Floats:
    return np.stack([x, np.broadcast_to(y, x.shape), np.zeros(x.shape)], axis=-1)


@every_solid
def test_the_shadow_map_is_what_shadow_rays_find(solid: Solid) -> None:
    random = np.random.default_rng(1)
    points = on_table(*random.uniform(-0.2, 0.2, (2, 4000)))
    _, (lit,) = ShadowMap.of([solid], [LOW_LAMP]).at(points)
    dark = solid.blocks(points, LOW_LAMP.centre_m - points)
    assert 20 < dark.sum() < 3000
    assert np.abs(lit - ~dark).mean() < 0.25 * dark.mean() / np.sqrt(dark.sum()) + 0.005


def test_a_shadow_is_as_long_as_the_lamp_is_low() -> None:
    """A lamp far away, 30 degrees above the table: 1.73 times the height."""
    box, lamp = Box(0, 0, (0.04, 0.04, 0.05)), lamp_at(30, 180, distance_m=1000, radius_m=0)
    x = np.array([0.021, 0.02 + 0.05 * 1.732 - 0.001, 0.02 + 0.05 * 1.732 + 0.001, -0.021])
    _, (lit,) = ShadowMap.of([box], [lamp]).at(on_table(x, 0.0))
    np.testing.assert_allclose(lit, [0, 0, 1, 1], atol=0.01)


def test_a_large_lamp_makes_a_soft_border_as_wide_as_similar_triangles_say() -> None:
    box, lamp = Box(0, 0, (0.04, 0.2, 0.05)), Lamp((-1.0, 0, 1.0), distance_m=1.0, radius_m=0.1)
    edge = np.array([0.02, 0, 0.05])
    rays = edge - lamp.points_m()
    borders = (edge + rays * (edge[2] / -rays[:, 2])[:, None])[:, 0]
    x = np.linspace(borders.min() - 0.002, borders.max() + 0.002, 200)
    _, (lit,) = ShadowMap.of([box], [lamp]).at(on_table(x, 0.0))
    assert lit[0] == 0 and lit[-1] == 1
    assert (np.diff(lit) >= -1e-6).all()
    np.testing.assert_allclose(lit, (borders[:, None] < x).mean(axis=0), atol=0.13)


def test_a_part_shades_another_one() -> None:
    near, far = Box(-0.05, 0, (0.02, 0.1, 0.1)), Box(0.05, 0, (0.04, 0.04, 0.04))
    low, high = (lamp_at(elevation, 180, distance_m=50, radius_m=0) for elevation in (20, 60))
    top = far.top_m[None]
    assert visible_from(low, top, far, [near])[0] == 0
    assert visible_from(high, top, far, [near])[0] == 1


def test_a_lambert_surface_shows_the_cosine_of_the_light() -> None:
    """On the table, without a room's light: albedo times the sine of the lamp's elevation."""
    for elevation in (30.0, 60.0, 90.0):
        lamp = lamp_at(elevation, 0, distance_m=1000, radius_m=0)
        scene = Scene((), table_albedo=0.5, lamps=(lamp,), ambient=0.0)
        image = render(PARALLEL, scene, IDEAL, IDEAL).left
        assert int(np.median(image)) == pytest.approx(255 * 0.5 * np.sin(np.deg2rad(elevation)), abs=0.6)


def test_both_views_show_the_same_shadow_where_it_is() -> None:
    """A point of the table in shadow is dark in both images, beside it lit."""
    scene = Scene((Box(0, 0, (0.04, 0.04, 0.05)),), lamps=(lamp_at(30, 180, radius_m=0),), shadows=True)
    shaded, lit = on_table(np.array([0.06]), 0.0), on_table(np.array([-0.06]), 0.0)
    for camera, camera_T_left, seen in zip(
        (PARALLEL.left, PARALLEL.right), (None, PARALLEL.right_T_left), views_of(PARALLEL, scene)
    ):
        levels = []
        for point in (shaded, lit):
            in_left = scene.left_T_table.apply(point)
            column, row = np.round(
                camera.project(camera_T_left.apply(in_left) if camera_T_left else in_left)[0]
            ).astype(int)
            levels.append(seen.light[row, column])
        assert levels[0] < 0.75 * levels[1]


def test_the_edge_of_the_table_is_a_straight_line_where_it_was_put() -> None:
    scene = Scene((), ambient=1.0, table_albedo=0.5, paints=(Edge(0.05, 0.0, 0.1),))
    seen = views_of(PARALLEL, scene)[0]
    beyond = seen.points_m[..., 0] > 0.05
    inner = np.abs(seen.points_m[..., 0] - 0.05) > 0.002
    np.testing.assert_allclose(seen.light[inner], np.where(beyond, 0.1, 0.5)[inner])


def test_gain_offset_and_noise_are_as_told() -> None:
    scene = Scene((), ambient=1.0, table_albedo=0.4)
    plain = render(PARALLEL, scene, IDEAL, replace(IDEAL, gain=0.6, offset_dn=20))
    assert np.unique(plain.left).tolist() == [102] and np.unique(plain.right).tolist() == [round(0.6 * 102 + 20)]
    noisy = render(PARALLEL, scene, replace(IDEAL, noise_dn=1.0, photon_dn=3.0), IDEAL).left
    assert noisy.std() == pytest.approx(np.sqrt(1 + 9 * 0.4 + 1 / 12), rel=0.02)
