"""Rendered parts as the solids that they are, in the rectified left frame."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

import numpy as np
from rendering import Box, Cylinder, HexPrism, Lamp, Scene, Sensor, Solid, Sphere, render
from rendering.rigs import table_before
from rigs import RIGS, rotation

from stereo_pick.core.arrays import Floats
from stereo_pick.core.frames import RectifiedPair
from stereo_pick.core.rectification import Rectifier
from stereo_pick.core.rig import StereoRig
from stereo_pick.core.shapes import SolidFit
from stereo_pick.core.shapes.kinds import KINDS
from stereo_pick.core.shapes.solids import Solids
from stereo_pick.core.shapes.table import Table
from stereo_pick.core.transform import Transform

FROM_ABOVE = Lamp((0.0, 0.0, 1.0))
RIG = RIGS["thesis"]
PLACED = table_before(RIG, 0.9, elevation_deg=50)
PARTS: dict[str, Solid] = {
    "standing": Cylinder(-0.07, 0.0, (0.04, 0.04, 0.05)),
    "box": Box(0.05, 0.0, (0.05, 0.036, 0.045), yaw_rad=0.4),
    "sphere": Sphere(0.0, 0.07, (0.04, 0.04, 0.04)),
    "lying": Cylinder(0.0, -0.06, (0.03, 0.03, 0.06), yaw_rad=0.5, lying=True),
}
"""One part of each kind, and one lying, apart from each other on a table before a rig."""

PATTERNED: dict[str, Solid] = {
    "standing": Cylinder(0.0, 0.0, (0.05, 0.05, 0.06), texture=1.0),
    "lying": Cylinder(0.0, 0.0, (0.05, 0.05, 0.08), yaw_rad=0.5, lying=True, texture=1.0),
    "box": Box(0.0, 0.0, (0.05, 0.06, 0.05), yaw_rad=0.4, texture=1.0),
    "hexprism": HexPrism(0.0, 0.0, (0.05, 0.05 * 2 / 3**0.5, 0.06), yaw_rad=0.2, texture=1.0),
    "sphere": Sphere(0.0, 0.0, (0.06,) * 3, texture=1.0),
}
"""One part of each kind, and one lying, with a pattern all over, all at one place."""


def half_lit_scene(parts: Sequence[Solid], left_T_table: Transform, sides: float) -> Scene:
    """White parts with bright tops, the sides of which differ from the table by so much light (1 is white)."""
    table, albedo = 0.2, parts[0].albedo
    return Scene(tuple(parts), left_T_table, table, lamps=(FROM_ABOVE,), ambient=(table + sides) / albedo)


@lru_cache(maxsize=16)  # tests of one file look at the same few scenes again and again
def rectified(rig: StereoRig, scene: Scene, noise_dn: float = 1.0, seed: int = 0) -> RectifiedPair:
    sensor = Sensor(noise_dn=noise_dn)
    return Rectifier(rig).rectify(render(rig, scene, sensor, sensor, seed))


def centre_m(rig: StereoRig, scene: Scene, part: Solid) -> Floats:
    return np.asarray(rig.left.R @ scene.left_T_table.apply(part.centre_m))


def table_of(rig: StereoRig, left_T_table: Transform) -> Table:
    """The plane that parts stand on, in the rectified left frame."""
    normal = rig.left.R @ left_T_table.rotation[:, 2]
    return Table(normal, -float(normal @ rig.left.R @ left_T_table.translation), 5e-4)


def solid_of(
    rig: StereoRig, scene: Scene, part: Solid, height_m: float | None = None, turned: Floats | None = None
) -> Solids:
    """The part as a solid (S = 1) that may be turned; with height_m, only so much of it below its top.

    turned: (3, 3), a rotation of it about its own axes.
    """
    kind = KINDS[type(part).__name__.lower()]
    to_rectified = rig.left.R @ scene.left_T_table.rotation
    size, centre = np.array(part.size_m), centre_m(rig, scene, part)
    if height_m is not None:
        centre = centre + to_rectified[:, 2] * (part.height_m - height_m) / 2
        size[0 if part.lying else 2] = height_m
    half = np.array([[size[kind.axes.index(i)] / 2 for i in range(kind.sizes)]])
    axes = to_rectified @ part.axes @ (np.eye(3) if turned is None else turned)
    return Solids(kind, centre[None], axes[None], half, np.eye(3)[None][:, :, list(kind.turns)])


def true_fit(rig: StereoRig, scene: Scene, part: Solid) -> SolidFit:
    """The part as if it had been found where it is; the prism's first axis runs to a corner, and the renderer's to a
    flat side."""
    turned = rotation((0.0, 0.0, np.pi / 6)) if isinstance(part, HexPrism) else None
    solid = solid_of(rig, scene, part, turned=turned)
    kind = solid.kind.name
    return SolidFit(kind, solid.centre_m[0], solid.rotation[0], solid.size_m()[0], 0.1, 1e-8 * np.eye(3))
