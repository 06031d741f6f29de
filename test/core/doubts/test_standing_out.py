"""What is seen before the surface of a solid is more than that solid."""

from __future__ import annotations

import cv2
import numpy as np
import pytest
from rendered_solids import PLACED, RIG, rectified, solid_of
from rendering import Box, Cylinder, HexPrism, Scene, Solid, Sphere
from rendering.rigs import table_before

from stereo_pick.core.correspondence.feature import Feature
from stereo_pick.core.doubts.standing_out import stands_out
from stereo_pick.core.pipeline import Steps
from stereo_pick.core.shapes import SolidFit
from stereo_pick.core.windows.warped_surface import WarpedSurface

BODIES: dict[str, Solid] = {
    "cylinder": Cylinder(0.0, 0.0, (0.05, 0.05, 0.04)),
    "box": Box(0.0, 0.0, (0.05, 0.06, 0.04), yaw_rad=0.4),
    "hexprism": HexPrism(0.0, 0.0, (0.05, 0.05 * 2 / 3**0.5, 0.04), yaw_rad=0.2),
}
BESIDE = Cylinder(0.12, 0.03, (0.045, 0.045, 0.05))


def on_top(height_m: float, offset_m: float = 0.0) -> Solid:
    return Cylinder(offset_m, 0.0, (0.018, 0.018, height_m), base_m=0.04, albedo=0.6)


def fitted(scene: Scene, part: Solid) -> SolidFit:
    solid = solid_of(RIG, scene, part)
    name = solid.kind.name
    return SolidFit(name, solid.centre_m[0], solid.rotation[0], solid.size_m()[0], 0.1, 1e-8 * np.eye(3))


@pytest.mark.parametrize("height_m", [0.012, 0.02])
@pytest.mark.parametrize("name", sorted(BODIES))
def test_a_knob_on_top_of_a_part_stands_out_unless_it_is_known(name: str, height_m: float) -> None:
    knob = on_top(height_m)
    scene = Scene((BODIES[name], knob), PLACED, ambient=0.6)
    pair = rectified(RIG, scene)
    body = fitted(scene, BODIES[name])
    assert stands_out(pair, body, [])
    assert not stands_out(pair, body, [fitted(scene, knob)])


@pytest.mark.parametrize("texture", [0.0, 1.0])
@pytest.mark.parametrize("gloss", [0.0, 1.0])
@pytest.mark.parametrize("name", [*sorted(BODIES), "sphere", "lying"])
def test_nothing_stands_out_of_a_part_that_is_all_there_is(name: str, gloss: float, texture: float) -> None:
    """Neither patterns, which are on it, nor highlights, which lie behind it."""
    extra = {"sphere": Sphere(0.0, 0.0, (0.05,) * 3), "lying": Cylinder(0.0, 0.0, (0.04, 0.04, 0.07), 0.5, lying=True)}
    part = {**BODIES, **extra}[name]
    part = type(part)(
        part.x_m, part.y_m, part.size_m, part.yaw_rad, 0.6, texture=texture, gloss=gloss, lying=part.lying
    )
    scene = Scene((part,), PLACED, ambient=0.5)
    assert not stands_out(rectified(RIG, scene), fitted(scene, part), [])


@pytest.mark.parametrize("off_px", [-3.0, 0.0, 1.5, 6.5])
def test_few_windows_are_as_alike_as_all_of_them_are_there(off_px: float) -> None:
    part = Box(0.0, 0.0, (0.05, 0.06, 0.04), yaw_rad=0.4, texture=1.0)
    scene = Scene((part,), PLACED, ambient=0.5)
    surface = WarpedSurface.of(rectified(RIG, scene), fitted(scene, part), [])
    assert surface is not None
    every = surface.alike(off_px)
    rows, columns = np.nonzero(surface.usable)
    some = np.stack([columns, rows], axis=1)[:: max(1, len(rows) // 40)]
    few = surface.alike_at(some, off_px)
    assert len(some) * 121 < every.size and (few > -1).any()
    assert few == pytest.approx(every[some[:, 1], some[:, 0]], abs=1e-3)


def test_a_ball_that_is_a_shaft_with_a_step_stands_out() -> None:
    """From above its outline is nearly round; its upper end is nearer than any of a ball."""
    shaft = (
        Cylinder(0.0, 0.0, (0.07, 0.07, 0.03), albedo=0.6),
        Cylinder(0.0, 0.0, (0.04, 0.04, 0.06), base_m=0.03, albedo=0.6),
    )
    scene = Scene(shaft, table_before(RIG, 0.9, elevation_deg=80), ambient=0.6)
    ball = fitted(scene, Sphere(0.0, 0.0, (0.07,) * 3))
    assert stands_out(rectified(RIG, scene), ball, [])


def test_a_bottle_from_above_is_no_cylinder() -> None:
    """Its neck is seen before its body, not beside it."""
    neck = Cylinder(0.0, 0.0, (0.016, 0.016, 0.02), base_m=0.04, albedo=0.8)
    scene = Scene((BODIES["cylinder"], neck, BESIDE), PLACED, ambient=0.6)
    steps = Steps(method=Feature())
    _, matches = steps.correspond(rectified(RIG, scene))
    poses = steps.locate(matches, RIG, 0)
    off_m = np.linalg.norm(poses.xyz[:, None] - scene.positions_m(), axis=2)
    assert off_m[:, 2].min() < 1e-3
    sigma_m = np.sqrt(np.trace(poses.covariance, axis1=1, axis2=2) / 3)
    assert (sigma_m[off_m[:, :2].min(axis=1) < 0.03] > 2e-3).all()


def test_a_small_or_a_dark_view_says_nothing() -> None:
    scene = Scene((BODIES["box"],), PLACED, ambient=0.5)
    pair = rectified(RIG, scene)
    tiny = fitted(scene, Cylinder(0.0, 0.0, (0.008, 0.008, 0.008)))
    assert not stands_out(pair, tiny, [])
    blurred = type(pair)(*(cv2.GaussianBlur(view, (0, 0), 20) for view in (pair.left, pair.right)), pair.rig)
    assert not stands_out(blurred, fitted(scene, BODIES["box"]), [])
