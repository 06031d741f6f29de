"""Stereo pairs of parts on a table, ray-cast, with exact truth: what tests and benchmark compare the package with."""

from __future__ import annotations

import numpy as np

from rendering.lamps import Lamp, lamp_at
from rendering.scene import Scene, table
from rendering.sensor import CLEAN, Sensor
from rendering.solids import Box, Cylinder, HexPrism, Solid, Sphere, Tube, balls, hex_prism_size
from rendering.tabletop import Carton, Edge, Label, Paint, Planks
from rendering.truth import TrueObject, Truth, truth_of
from rendering.view import View, lens, view
from stereo_pick.core.frames import StereoFrame
from stereo_pick.core.rig import StereoRig
from stereo_pick.core.transform import Transform

__all__ = [
    "CLEAN", "Box", "Carton", "Cylinder", "Edge", "HexPrism", "Label", "Lamp", "Paint", "Planks", "Scene", "Sensor",
    "Solid", "Sphere", "TrueObject", "Truth", "Tube", "View", "balls", "hex_prism_size", "lamp_at", "lens", "render",
    "render_with_truth", "table", "tables_T_camera", "truth_of", "views_of",
]  # fmt: skip


def render(rig: StereoRig, scene: Scene, left: Sensor = CLEAN, right: Sensor = CLEAN, seed: int = 0) -> StereoFrame:
    """The raw pair that the rig takes of the scene."""
    return _exposed(views_of(rig, scene), left, right, seed)


def render_with_truth(
    rig: StereoRig, scene: Scene, left: Sensor = CLEAN, right: Sensor = CLEAN, seed: int = 0
) -> tuple[StereoFrame, Truth]:
    """The same, and what is true of it."""
    views = views_of(rig, scene)
    return _exposed(views, left, right, seed), truth_of(rig, scene, views, tables_T_camera(rig, scene))


def views_of(rig: StereoRig, scene: Scene) -> tuple[View, View]:
    """What the left and the right camera see, before their sensors."""
    left, right = tables_T_camera(rig, scene)
    return view(rig.left, scene, left), view(rig.right, scene, right)


def _exposed(views: tuple[View, View], left: Sensor, right: Sensor, seed: int) -> StereoFrame:
    noise = np.random.default_rng(seed)
    return StereoFrame(left.expose(views[0].light, noise), right.expose(views[1].light, noise))


def tables_T_camera(rig: StereoRig, scene: Scene) -> tuple[Transform, Transform]:
    """Where the left and the right camera are before the table."""
    table_T_left = scene.left_T_table.inverse()
    return table_T_left, table_T_left @ rig.right_T_left.inverse()
