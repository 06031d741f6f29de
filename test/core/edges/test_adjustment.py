"""Solids and their table adjusted together, to rendered scenes with exact truth."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import cache

import cv2
import numpy as np
import pytest
from rendered_solids import FROM_ABOVE, PARTS, PLACED, RIG, centre_m, rectified, solid_of
from rendering import Cylinder, Lamp, Scene, Sensor, Solid, render
from rigs import rotation

from stereo_pick.core.arrays import Floats, Image
from stereo_pick.core.camera import Camera
from stereo_pick.core.edges.adjusted import Adjusted
from stereo_pick.core.edges.adjustment import adjusted
from stereo_pick.core.edges.hypotheses import Images
from stereo_pick.core.rectification import Rectifier
from stereo_pick.core.rig import StereoRig
from stereo_pick.core.shapes import SolidFit
from stereo_pick.core.shapes.table import Table
from stereo_pick.core.transform import Transform

ALL = tuple(PARTS.values())
SCENE = Scene(ALL, PLACED, ambient=0.6)
NORMAL = RIG.left.R @ PLACED.rotation[:, 2]
TRUE = Table(NORMAL, -float(NORMAL @ RIG.left.R @ PLACED.translation), 1e-3)


@cache
def images() -> Images:
    return Images(rectified(RIG, SCENE))


def fits(random: np.random.Generator, off_m: float, off_deg: float, parts: Sequence[Solid] = ALL) -> list[SolidFit]:
    """The parts as solids, moved and turned by so much in directions at random."""
    found = []
    for part in parts:
        axis, shift = random.normal(size=(2, 3))
        solid = solid_of(RIG, SCENE, part, turned=rotation(tuple(axis * np.deg2rad(off_deg) / np.linalg.norm(axis))))
        place = solid.centre_m[0] + shift * off_m / np.linalg.norm(shift)
        size_m = solid.size_m()[0]
        found.append(SolidFit(solid.kind.name, place, solid.rotation[0], size_m, 0.1, 1e-8 * np.eye(3)))
    return found


def tilted(table: Table, off_deg: float, off_m: float) -> Table:
    normal = rotation((np.deg2rad(off_deg), 0, 0)) @ table.normal
    middle = RIG.left.R @ PLACED.translation
    return Table(normal, -float(normal @ middle) - off_m, table.sigma_m)


def off_m(found: Sequence[Adjusted], parts: Sequence[Solid] = ALL) -> Floats:
    truth = [centre_m(RIG, SCENE, part) for part in parts]
    return np.linalg.norm([each.fit.centre_m - place for each, place in zip(found, truth)], axis=1)


def off_deg(table: Table | None) -> float:
    assert table is not None
    return float(np.rad2deg(np.arccos(min(1.0, float(table.normal @ NORMAL)))))


@pytest.mark.parametrize("seed", range(4))
def test_from_1_mm_and_1_degree_off_parts_and_table_are_found(seed: int) -> None:
    start = fits(np.random.default_rng(seed), 1e-3, 1.0)
    found, table = adjusted(start, images().maps, RIG, tilted(TRUE, 0.5, 1e-3))
    assert off_m(found).max() < 2.5e-4
    assert off_deg(table) < 0.1
    assert all(each.shown > 0.9 and each.creased > 0.5 and each.fit.residual_px < 0.15 for each in found)


@pytest.mark.parametrize("seed", range(4))
def test_rods_in_a_line_leave_open_which_way_their_table_lies_and_do_not_turn_it(seed: int) -> None:
    """Two strokes of a print turned it until the cameras hardly saw it."""
    along = np.array([np.cos(0.4), np.sin(0.4)])
    rods = [Cylinder(*(x_m * along), (0.004, 0.004, 0.02), yaw_rad=0.4, lying=True) for x_m in (-0.02, 0.02)]
    pair = rectified(RIG, Scene(tuple(rods), PLACED, ambient=0.6))
    start = fits(np.random.default_rng(seed), 2e-4, 0.5, rods)
    _, table = adjusted(start, Images(pair).maps, RIG, TRUE)
    assert off_deg(table) < 1.5


@pytest.mark.parametrize("seed", range(4))
def test_without_a_table_parts_hardly_tell_of_one_another(seed: int) -> None:
    """Of the cameras only: how these stand towards each other is the same for all."""
    start = fits(np.random.default_rng(seed), 1e-3, 1.0)
    together, table = adjusted(start, images().maps, RIG, None)
    assert table is None and off_m(together).max() < 5e-4
    alone = [adjusted([fit], images().maps, RIG, None)[0][0] for fit in start]
    for one, other in zip(together, alone):
        np.testing.assert_allclose(one.fit.centre_m, other.fit.centre_m, atol=1.5e-4)


@pytest.mark.parametrize("turn_rad", [(-2e-4, 0, 3e-4), (2e-4, 0, -3e-4)])
def test_a_camera_that_has_turned_a_little_is_told_from_parts_that_lie_elsewhere(turn_rad: Sequence[float]) -> None:
    turned = Transform(rotation(turn_rad), np.zeros(3)) @ RIG.right_T_left
    stale = StereoRig.from_extrinsics(RIG.left, RIG.right, turned)
    views = Images(Rectifier(stale).rectify(render(RIG, SCENE, Sensor(), Sensor(), 0))).maps
    start = [_seen_by(stale, each) for each in fits(np.random.default_rng(7), 2e-4, 0.2)]
    found, _ = adjusted(start, views, stale, Table(_turned(stale, TRUE.normal), TRUE.offset_m, TRUE.sigma_m))
    truth = np.array([centre_m(stale, SCENE, part) for part in ALL])
    off = np.array([each.fit.centre_m for each in found]) - truth
    assert np.abs(off[:, 2] - off[:, 2].mean()).max() < 1e-4 and np.linalg.norm(off, axis=1).max() < 2e-4


def _turned(stale: StereoRig, direction: Floats) -> Floats:
    """From the rectified left frame of the rig as it is to that of its old calibration."""
    return np.asarray(stale.left.R @ RIG.left.R.T @ direction)


def _seen_by(stale: StereoRig, fit: SolidFit) -> SolidFit:
    return replace(fit, centre_m=_turned(stale, fit.centre_m), rotation=_turned(stale, fit.rotation))


def test_the_order_of_parts_makes_no_difference() -> None:
    start = fits(np.random.default_rng(1), 0.5e-3, 0.5)
    forward, _ = adjusted(start, images().maps, RIG, TRUE)
    backward, _ = adjusted(start[::-1], images().maps, RIG, TRUE)
    for one, other in zip(forward, backward[::-1]):
        assert one.fit.kind == other.fit.kind
        np.testing.assert_allclose(one.fit.centre_m, other.fit.centre_m, atol=1e-9)


@pytest.mark.parametrize("off_mm", [0.3, -0.3, 1.0])
def test_a_table_that_is_known_moves_within_its_sigma_only(off_mm: float) -> None:
    """Given to 0.1 mm it stays nearly as it is given, and to 5 mm as the parts show it."""
    start, given = fits(np.random.default_rng(2), 0.3e-3, 0.3), tilted(TRUE, 0.0, off_mm * 1e-3)
    moved_m = []
    for sigma_m in (1e-5, 5e-3):
        _, table = adjusted(start, images().maps, RIG, replace(given, sigma_m=sigma_m), known=True)
        assert table is not None
        moved_m.append(float(table.height_m(RIG.left.R @ PLACED.translation)) - off_mm * -1e-3)
    assert abs(moved_m[0]) < 0.15 * abs(off_mm) * 1e-3
    assert abs(moved_m[1] - off_mm * 1e-3) < 0.3e-3


def test_what_hangs_above_the_table_is_not_pulled_down() -> None:
    start = fits(np.random.default_rng(3), 0.0, 0.0)
    lower = tilted(TRUE, 0.0, -0.02)
    found, _ = adjusted(start, images().maps, RIG, lower)
    assert off_m(found).max() < 5e-4


@pytest.mark.parametrize("light", [FROM_ABOVE, Lamp((0.5, -0.6, 0.6)), Lamp((-0.6, 0.5, 0.6))])
def test_a_part_whose_edge_is_not_sharp_is_found_as_well(light: Lamp) -> None:
    """Stepped by half a millimetre: whether the edge appears at the inner or at the outer rim, the light decides."""
    step_m, radius_m, height_m = 5e-4, 0.02, 0.05
    body = Cylinder(-0.07, 0.0, (2 * radius_m, 2 * radius_m, height_m))
    below = replace(body, size_m=(2 * radius_m, 2 * radius_m, height_m - step_m))
    top = Cylinder(-0.07, 0.0, (2 * (radius_m - step_m), 2 * (radius_m - step_m), step_m), base_m=height_m - step_m)
    scene = Scene((below, top, *ALL[1:]), PLACED, ambient=0.5, lamps=(light,))
    start = fits(np.random.default_rng(5), 0.0, 0.0, (body, *ALL[1:]))
    found, _ = adjusted(start, Images(rectified(RIG, scene)).maps, RIG, TRUE)
    assert off_m(found, (body, *ALL[1:])).max() < 4e-4


@pytest.mark.parametrize("name", PARTS)
def test_what_is_rounded_lies_within_a_covariance_that_knows_it(name: str) -> None:
    assert mahalanobis2(name, radius_m=2e-3, known_m=2e-3) < 7.81


def test_to_one_that_does_not_a_rounded_cylinder_lies_elsewhere() -> None:
    """Two millimetres nearer than it is."""
    assert mahalanobis2("lying", radius_m=2e-3, known_m=0.0) > 20


def test_a_ball_has_no_edges_to_be_rounded() -> None:
    assert mahalanobis2("sphere", 0.0, known_m=2e-3) == pytest.approx(mahalanobis2("sphere", 0.0, known_m=0.0))


def mahalanobis2(name: str, radius_m: float, known_m: float) -> float:
    """Of a part alone on nothing, drawn with rounded edges, from its true place, adjusted to exact edges."""
    (start,) = fits(np.random.default_rng(0), 0.0, 0.0, [PARTS[name]])
    pair = rectified(RIG, SCENE)
    left, right = (drawn(camera, pair.left.shape, PARTS[name], radius_m) for camera in (RIG.left, RIG.right))
    views = Images(replace(pair, left=left, right=right)).exact_maps
    (found,), _ = adjusted([start], views, RIG, None, edge_radius_m=known_m)
    off = found.fit.centre_m - start.centre_m
    return float(off @ np.linalg.solve(found.fit.covariance, off))


def drawn(camera: Camera, shape: tuple[int, ...], part: Solid, radius_m: float) -> Image:
    """White on dark, with edges rounded so far: balls around a solid that is smaller by as much."""
    solid, finer = solid_of(RIG, SCENE, part), 8
    number = np.arange(4000) + 0.5
    z, angle = 1 - number / 2000, number * np.pi * (1 + np.sqrt(5))  # spread evenly (Fibonacci)
    ball = np.stack([np.sqrt(1 - z * z) * np.cos(angle), np.sqrt(1 - z * z) * np.sin(angle), z], axis=-1)
    own = solid.kind.touch(ball[None], solid.half_m - radius_m)[0] + radius_m * ball
    points = (own @ solid.rotation[0].T + solid.centre_m[0]) @ camera.P[:, :3].T + camera.P[:, 3]
    outline = cv2.convexHull((points[:, :2] / points[:, 2:]).astype(np.float32))[:, 0]
    large = np.zeros((shape[0] * finer, shape[1] * finer), np.uint8)
    cv2.fillPoly(large, [np.round(((outline + 0.5) * finer - 0.5) * 16).astype(np.int32)], (255,), shift=4)
    light = cv2.resize(large.astype(np.float32), shape[::-1], interpolation=cv2.INTER_AREA) / 255
    return Sensor(gain=0.6, offset_dn=40.0, blur_px=0.8).expose(light, np.random.default_rng(1))
