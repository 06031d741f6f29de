"""Each solid of the renderer against what is known of it by other ways."""

from __future__ import annotations

from dataclasses import replace

import cv2
import numpy as np
import pytest
from outlines import PARALLEL
from rendering import Box, Cylinder, HexPrism, Scene, Solid, Sphere, Tube, hex_prism_size, render_with_truth, table
from rendering.odd_solids import Cone, Egg, HalfRound, Pyramid, Wedge
from rendering.view import silhouette_px

from stereo_pick.core.arrays import Floats
from stereo_pick.core.transform import Transform

SOLIDS: dict[str, Solid] = {
    "box": Box(0.02, 0.01, (0.06, 0.04, 0.05), yaw_rad=0.5),
    "cylinder": Cylinder(-0.05, 0.02, (0.05, 0.05, 0.06)),
    "lying cylinder": Cylinder(-0.03, 0.02, (0.03, 0.03, 0.08), yaw_rad=0.7, lying=True),
    "tube": Tube(0.01, 0.0, (0.04, 0.04, 0.06)),
    "lying tube": Tube(0.03, 0.0, (0.04, 0.04, 0.06), yaw_rad=-1.0, lying=True),
    "prism": HexPrism(0.0, 0.03, hex_prism_size(0.04, 0.05), yaw_rad=0.2),
    "lying prism": HexPrism(0.0, 0.03, hex_prism_size(0.04, 0.07), yaw_rad=2.0, lying=True),
    "sphere": Sphere(0.05, -0.02, (0.05, 0.05, 0.05)),
}
ODD: dict[str, Solid] = {
    "cone": Cone(0.02, 0.01, (0.05, 0.05, 0.06), above=0.5),
    "cup": Cone(0.02, -0.01, (0.05, 0.05, 0.05), below=0.6, above=1.0),
    "flat cone": Cone(0.0, 0.0, (0.08, 0.08, 0.02), above=0.2),
    "pyramid": Pyramid(-0.02, 0.01, (0.06, 0.04, 0.05), yaw_rad=0.4, taper=0.5),
    "wedge": Wedge(0.03, 0.0, (0.06, 0.04, 0.03), yaw_rad=2.0),
    "half round": HalfRound(0.0, 0.02, (0.02, 0.04, 0.07), yaw_rad=0.7, lying=True),
    "egg": Egg(0.01, 0.01, (0.04, 0.03, 0.05), yaw_rad=0.3),
}
ASLANT: dict[str, Solid] = {f"{name} aslant": replace(solid, tilt_rad=0.4) for name, solid in SOLIDS.items()}
_SHIFTS = ((0, 0, 0), (1e-6, 0, 0), (0, 1e-6, 1e-6))
TABLE_T_LEFT = table().inverse()
every_solid = pytest.mark.parametrize("solid", SOLIDS.values(), ids=list(SOLIDS))
every_one = pytest.mark.parametrize(
    "solid", [*SOLIDS.values(), *ASLANT.values(), *ODD.values()], ids=[*SOLIDS, *ASLANT, *ODD]
)
every_odd_one = pytest.mark.parametrize("solid", ODD.values(), ids=list(ODD))


def rays_at(solid: Solid, count: int = 3000) -> tuple[Floats, Floats]:
    """The camera's place and rays towards the solid and around it, in the table's frame."""
    camera = TABLE_T_LEFT.translation
    aims = solid.centre_m + np.random.default_rng(0).uniform(-1, 1, (count, 3)) * solid.radius_m
    return camera, aims - camera


@every_one
def test_the_silhouette_is_that_of_the_projected_hull(solid: Solid) -> None:
    outline = PARALLEL.left.project(TABLE_T_LEFT.inverse().apply(solid.hull_m())).astype(np.float32)
    area = cv2.contourArea(cv2.convexHull(outline))
    assert silhouette_px(PARALLEL.left, solid, TABLE_T_LEFT) == pytest.approx(area, rel=0.01)


@every_one
def test_normals_are_those_of_the_surface(solid: Solid) -> None:
    """Three rays close together span the surface's tangent plane."""
    camera, rays = rays_at(solid)
    here, right, down = (solid.hit(camera, rays + shift) for shift in _SHIFTS)
    on_one_face = np.isfinite(here.at) & (np.abs(right.normal - here.normal) < 1e-3).all(axis=1)
    on_one_face &= (np.abs(down.normal - here.normal) < 1e-3).all(axis=1) & np.isfinite(right.at) & np.isfinite(down.at)
    assert on_one_face.sum() > 500
    points = [
        hit.at[on_one_face, None] * (rays + shift)[on_one_face] for hit, shift in zip((here, right, down), _SHIFTS)
    ]
    across = np.cross(points[1] - points[0], points[2] - points[0])
    across /= np.linalg.norm(across, axis=1, keepdims=True)
    along = np.abs(np.einsum("ij,ij->i", across, here.normal[on_one_face]))
    np.testing.assert_allclose(along, 1, atol=2e-3)
    facing = np.einsum("ij,ij->i", rays, here.normal)[np.isfinite(here.at)]
    assert (facing < 1e-9).all()


@every_solid
def test_it_stands_on_the_table_and_is_as_large_as_it_says(solid: Solid) -> None:
    hull = solid.hull_m()
    c, s = np.cos(solid.yaw_rad), np.sin(solid.yaw_rad)
    along = hull @ np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    assert hull[:, 2].min() == pytest.approx(0, abs=1e-9)
    np.testing.assert_allclose(np.ptp(along, axis=0), solid.extent_m, rtol=0.01)
    np.testing.assert_allclose((hull.max(axis=0) + hull.min(axis=0)) / 2, solid.centre_m, atol=3e-4)
    assert hull[:, 2].max() == pytest.approx(solid.top_m[2])


@every_odd_one
def test_an_odd_one_stands_on_the_table_in_the_box_around_it(solid: Solid) -> None:
    hull = solid.hull_m()
    own = (hull - solid.centre_m) @ solid.axes
    assert hull[:, 2].min() == pytest.approx(0, abs=1e-9)
    assert hull[:, 2].max() == pytest.approx(solid.top_m[2])
    corners = (solid.corners_m() - solid.centre_m) @ solid.axes
    np.testing.assert_allclose(own.max(axis=0), corners.max(axis=0), atol=1e-4)
    np.testing.assert_allclose(own.min(axis=0), corners.min(axis=0), atol=1e-4)
    np.testing.assert_allclose(np.ptp(own, axis=0), solid.size_m, rtol=0.01)


@every_odd_one
def test_the_centre_of_an_odd_ones_volume_is_that_of_the_points_within_it(solid: Solid) -> None:
    """A ray of no length from a point within it is blocked."""
    random = np.random.default_rng(0)
    points = solid.centre_m + random.uniform(-1, 1, (400_000, 3)) * solid.radius_m
    within = points[solid.blocks(points, random.normal(size=points.shape) * 1e-9)]
    np.testing.assert_allclose(within.mean(axis=0), solid.centre_m, atol=4e-4)


@every_solid
def test_after_its_period_it_looks_as_before(solid: Solid) -> None:
    period = solid.yaw_period_rad or 1.0
    turned = type(solid)(solid.x_m, solid.y_m, solid.size_m, solid.yaw_rad + period, lying=solid.lying)
    camera, rays = rays_at(solid)
    np.testing.assert_allclose(turned.hit(camera, rays).at, solid.hit(camera, rays).at, atol=1e-9)


@every_solid
def test_aslant_it_is_turned_about_its_level_axis_and_its_centre(solid: Solid) -> None:
    c, s = np.cos(0.4), np.sin(0.4)
    own = (solid.hull_m() - solid.centre_m) @ solid.axes @ np.array([[c, 0, -s], [0, 1, 0], [s, 0, c]])
    tilted = replace(solid, tilt_rad=0.4)
    np.testing.assert_allclose(tilted.hull_m(), own @ solid.axes.T + solid.centre_m, atol=1e-9)
    assert tilted.axes[2, 1] == pytest.approx(0)


def test_one_sees_through_a_tube() -> None:
    """Along its axis, whether it stands or lies; and its wall beside that."""
    for tube in (Tube(0, 0, (0.04, 0.04, 0.06), bore=0.8), Tube(0, 0, (0.04, 0.04, 0.06), lying=True, bore=0.8)):
        way = np.array([-1.0, 0, 0]) if tube.lying else np.array([0, 0, -1.0])
        aside = np.linspace(-0.021, 0.021, 85)
        starts = tube.centre_m - way + aside[:, None] * (0.0, 1.0, 0.0)
        seen = np.isfinite(tube.hit(starts, np.tile(way, (85, 1))).at)
        np.testing.assert_array_equal(seen, (np.abs(aside) < 0.02) & (np.abs(aside) >= 0.016))


def test_a_tube_shows_its_inner_wall_where_it_is() -> None:
    tube = Tube(0, 0, (0.04, 0.04, 0.06), bore=0.5)
    slanting = np.array([[0.3, 0.0, -1.0]])
    hit = tube.hit(np.array([[-0.005, 0.0, 0.061]]), slanting)
    np.testing.assert_allclose(hit.at * slanting[0] + (-0.005, 0, 0.061), [0.01, 0, 0.011], atol=1e-12)
    np.testing.assert_allclose(hit.normal, [[-1, 0, 0]], atol=1e-12)
    assert hit.inside.all()


@every_solid
def test_truth_lies_where_the_part_is_seen(solid: Solid) -> None:
    _, truth = render_with_truth(PARALLEL, Scene((solid,)))
    part = truth.objects[0]
    assert part.required and part.visible == (1.0, 1.0)
    np.testing.assert_allclose(part.centre_m, table().apply(solid.centre_m))
    assert part.visible_m is not None
    nearer = np.linalg.norm(part.centre_m) - np.linalg.norm(part.visible_m)
    assert 0 < nearer < solid.radius_m


def test_what_the_border_cuts_is_not_visible() -> None:
    """A ball whose centre projects to the left border shows the half of itself."""
    facing = Transform(np.diag([1.0, -1.0, -1.0]), np.array([0.0, 0, 0.9]))
    depth, focal = 0.9 - 0.02, PARALLEL.left.K[0, 0]
    ball = Sphere(-(PARALLEL.left.K[0, 2] + 0.5) * depth / focal, 0.0, (0.04,) * 3)
    _, truth = render_with_truth(PARALLEL, Scene((ball,), facing))
    assert truth.objects[0].visible[0] == pytest.approx(0.5, abs=0.02)
    assert truth.objects[0].visible[1] == 0
    assert not truth.objects[0].required


def test_what_another_part_hides_is_not_visible() -> None:
    """Seen from above, a high narrow box hides the middle of a flat wide one: the ratio of their areas there."""
    facing = Transform(np.diag([1.0, -1.0, -1.0]), np.array([0.0, 0, 0.9]))
    flat, high = Box(0, 0, (0.08, 0.08, 0.01), 0.4), Box(0, 0, (0.04, 0.04, 0.09), 0.4, base_m=0.01)
    _, truth = render_with_truth(PARALLEL, Scene((flat, high), facing))
    hidden = (0.04 / (0.9 - 0.1)) ** 2 / (0.08 / (0.9 - 0.01)) ** 2
    assert truth.objects[0].visible[0] == pytest.approx(1 - hidden, abs=0.01)
    assert truth.objects[1].visible == (1.0, 1.0)
