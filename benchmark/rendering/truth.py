"""What is exactly true of a rendered scene."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from rendering.scene import FIRST, Scene
from rendering.solids import Solid
from rendering.view import View, silhouette_px
from stereo_pick.core.arrays import Floats
from stereo_pick.core.rig import StereoRig
from stereo_pick.core.transform import Transform

REQUIRED_VISIBLE = 0.75


@dataclass(frozen=True, eq=False)
class TrueObject:
    """One part, in the left camera's raw optical frame [m].

    centre_m, top_m: (3,), of its volume and of its top face; visible_m: (3,), mean of the surface that the left view's
    pixels show, None where they show none; extent_m: along its yaw direction, across it, and up; yaw_rad: about the
    table's normal; yaw_period_rad: the turn after which it looks the same, 0 if always; visible: share of its
    silhouette that the left and the right image show.
    """

    shape: str
    lying: bool
    centre_m: Floats
    top_m: Floats
    visible_m: Floats | None
    extent_m: tuple[float, float, float]
    yaw_rad: float
    yaw_period_rad: float
    visible: tuple[float, float]

    @property
    def required(self) -> bool:
        return min(self.visible) >= REQUIRED_VISIBLE


@dataclass(frozen=True, eq=False)
class Truth:
    """The parts, and the table: its z axis is the normal, its plane z = 0."""

    objects: tuple[TrueObject, ...]
    left_T_table: Transform

    @property
    def centres_m(self) -> Floats:
        return np.array([each.centre_m for each in self.objects]).reshape(-1, 3)


def truth_of(rig: StereoRig, scene: Scene, views: Sequence[View], tables_T_camera: Sequence[Transform]) -> Truth:
    """The truth of a scene that the rig's two cameras have seen so."""
    objects = []
    for number, solid in enumerate(scene.solids, start=FIRST):
        shown = [(seen.labels == number) for seen in views]
        visible = [
            min(1.0, float(mask.sum()) / max(1, silhouette_px(camera, solid, table_T_camera)))
            for mask, camera, table_T_camera in zip(shown, (rig.left, rig.right), tables_T_camera)
        ]
        objects.append(_object(scene, solid, (visible[0], visible[1]), views[0].points_m[shown[0]]))
    return Truth(tuple(objects), scene.left_T_table)


def _object(scene: Scene, solid: Solid, visible: tuple[float, float], surface_m: Floats) -> TrueObject:
    in_left = scene.left_T_table.apply
    return TrueObject(
        shape=type(solid).__name__.lower(),
        lying=solid.lying,
        centre_m=in_left(solid.centre_m),
        top_m=in_left(solid.top_m),
        visible_m=in_left(surface_m.mean(axis=0)) if len(surface_m) else None,
        extent_m=solid.extent_m,
        yaw_rad=solid.yaw_rad,
        yaw_period_rad=solid.yaw_period_rad,
        visible=visible,
    )
