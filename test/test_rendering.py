"""The renderer against closed forms: a test tool that is wrong would make the truth wrong."""

from __future__ import annotations

import numpy as np
import pytest
from outlines import PARALLEL
from rendering import Box, Cylinder, Scene, Sensor, Solid, balls, render
from rigs import RIGS

from stereo_pick.core.arrays import Floats, Image
from stereo_pick.core.camera import Camera
from stereo_pick.core.rig import StereoRig

IDEAL = Sensor(blur_px=0, noise_dn=0)


def coverage(image: Image) -> Floats:
    """How much of each pixel (H, W) an evenly lit part covers."""
    grey = image.astype(np.float64)
    return (grey - np.median(grey)) / (grey.max() - np.median(grey))


def centroid(weight: Floats) -> Floats:
    v, u = np.mgrid[: weight.shape[0], : weight.shape[1]]
    return np.array([(u * weight).sum(), (v * weight).sum()]) / weight.sum()


def ball_scene(x_m: float) -> Scene:
    return Scene(balls((x_m, 0.03, 0.05)), ambient=1.0)


@pytest.mark.parametrize("x_m", [-0.1, 0.0, 0.08])
def test_a_sphere_is_the_ellipse_of_the_closed_form(x_m: float) -> None:
    scene = ball_scene(x_m)
    x, y, z = scene.positions_m()[0]
    focal, radius = PARALLEL.left.K[0, 0], 0.025
    centre = focal * np.array([x * z, y * z]) / (z**2 - radius**2) + PARALLEL.left.K[:2, 2]
    distance2 = x**2 + y**2 + z**2
    area = np.pi * focal**2 * radius**2 * np.sqrt(distance2 - radius**2) / (z**2 - radius**2) ** 1.5
    covered = coverage(render(PARALLEL, scene, IDEAL, IDEAL).left)
    np.testing.assert_allclose(centroid(covered), centre, atol=0.02)
    assert covered.sum() == pytest.approx(area, rel=0.003)


@pytest.mark.parametrize("name", RIGS)
def test_lens_and_place_of_both_cameras_are_those_of_the_rig(name: str) -> None:
    rig, scene = RIGS[name], ball_scene(0.02)
    frame = render(rig, scene, IDEAL, IDEAL)
    in_right = rig.right_T_left.apply(scene.positions_m())
    for image, camera, centre in (
        (frame.left, rig.left, scene.positions_m()[0]),
        (frame.right, rig.right, in_right[0]),
    ):
        np.testing.assert_allclose(centroid(coverage(image)), projected_limb_centre(camera, centre), atol=0.03)


def projected_limb_centre(camera: Camera, centre: Floats, radius: float = 0.025) -> Floats:
    """Centroid of the polygon of a sphere's limb in the raw image."""
    distance = np.linalg.norm(centre)
    axis = centre / distance
    across = np.cross(axis, (0, 1, 0)) / np.linalg.norm(np.cross(axis, (0, 1, 0)))
    angle = np.linspace(0, 2 * np.pi, 400, endpoint=False)[:, None]
    circle = np.cos(angle) * across + np.sin(angle) * np.cross(axis, across)
    limb = axis * (distance - radius**2 / distance) + circle * radius * np.sqrt(1 - (radius / distance) ** 2)
    x, y = camera.project(limb).T
    cross = x * np.roll(y, -1) - np.roll(x, -1) * y
    return np.array([((x + np.roll(x, -1)) * cross).sum(), ((y + np.roll(y, -1)) * cross).sum()]) / (3 * cross.sum())


@pytest.mark.parametrize(
    "solid", [Box(0.02, 0.01, (0.06, 0.04, 0.05), yaw_rad=0.5), Cylinder(-0.05, 0.02, (0.05, 0.05, 0.06))]
)
def test_a_part_fills_the_bounds_of_its_projection(solid: Solid) -> None:
    scene = Scene((solid,), ambient=1.0)
    rows, columns = np.nonzero(coverage(render(PARALLEL, scene, IDEAL, IDEAL).left) > 0.5)
    outline = PARALLEL.left.project(scene.left_T_table.apply(extremes_m(solid)))
    np.testing.assert_allclose([columns.min(), rows.min()], outline.min(axis=0), atol=1)
    np.testing.assert_allclose([columns.max(), rows.max()], outline.max(axis=0), atol=1)


def extremes_m(solid: Solid) -> Floats:
    if isinstance(solid, Box):
        return solid.corners_m()
    angle = np.linspace(0, 2 * np.pi, 200)
    rim = np.stack([np.cos(angle), np.sin(angle), np.zeros(200)], axis=1) * solid.size_m[0] / 2
    return np.concatenate([solid.centre_m + rim + (0, 0, end * solid.size_m[2] / 2) for end in (-1, 1)])


def test_the_nearer_part_hides_the_farther() -> None:
    rig: StereoRig = PARALLEL
    ball = balls((0.0, 0.0, 0.04))[0]
    wall = Box(0.0, -0.05, (0.2, 0.01, 0.15), albedo=0.5)
    pixel = np.round(rig.left.project(Scene((ball,)).positions_m())[0]).astype(int)
    shown = [
        int(render(rig, Scene(parts, ambient=1.0), IDEAL, IDEAL).left[pixel[1], pixel[0]])
        for parts in ((ball, wall), (wall, ball), (ball,))
    ]
    assert shown[0] == shown[1] == round(255 * 0.5) and shown[2] == round(255 * 0.85)
