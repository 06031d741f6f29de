"""A scene traced: each pixel's rays go through its camera's own lens, so that no image is ever resampled."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from rendering import Scene, Sensor, Solid, Truth, lens, tables_T_camera, truth_of, views_of

from path_tracing.looks import Look, Room
from path_tracing.meshes import mesh
from stereo_pick.core.arrays import Floats
from stereo_pick.core.camera import Camera
from stereo_pick.core.frames import StereoFrame
from stereo_pick.core.rig import StereoRig
from stereo_pick.core.transform import Transform

_BOUNCES = 5
_AT_ONCE = 16  # samples of each pixel
_PASSES = 4
_BRIGHTEST = 4.0  # that a sample counts for, in what white paper gives back: a rare glint is no speckle then
_WHITE = 95.0  # percentile of what the left view shows, and of what the parts do there, that is exposed to `white`


@dataclass(frozen=True, eq=False)
class Traced:
    """All that makes one stereo pair; white: grey level, 1 being the highest, that what is bright comes to."""

    rig: StereoRig
    left_T_table: Transform
    parts: tuple[Solid, ...]
    looks: tuple[Look, ...]
    room: Room
    left: Sensor
    right: Sensor
    white: float
    noise_seed: int

    def taken(self) -> tuple[StereoFrame, Truth]:
        """The raw pair and its truth."""
        plain = Scene(self.parts, self.left_T_table, lamps=())
        placed, views = tables_T_camera(self.rig, plain), views_of(self.rig, plain)
        truth = truth_of(self.rig, plain, views, placed)
        scene = self._loaded()
        cameras = (self.rig.left, self.rig.right)
        lights = [
            _traced(scene, camera, T, 2 * self.noise_seed + number)
            for number, (camera, T) in enumerate(zip(cameras, placed))
        ]
        parts = lights[0][views[0].labels > 0]
        gain = self.white / max(float(np.percentile(shown, _WHITE)) for shown in (lights[0], parts))
        noise = np.random.default_rng(self.noise_seed)
        left, right = (
            replace(sensor, gain=sensor.gain * gain).expose(light, noise)
            for sensor, light in zip((self.left, self.right), lights)
        )
        return StereoFrame(left, right), truth

    def _loaded(self) -> Any:
        import mitsuba as mi

        mi.set_variant("llvm_ad_mono")
        described: dict[str, Any] = {
            "type": "scene",
            "table": _table(self.room),
            **self.room.described_light(),
        }
        for number, (part, look) in enumerate(zip(self.parts, self.looks)):
            described[f"part{number}"] = _part(part, look)
        return mi.load_dict(described)


def _table(room: Room) -> dict[str, Any]:
    import mitsuba as mi

    picture = None
    if room.picture is not None:
        bitmap = mi.Bitmap(room.picture.astype(np.float32)[..., None])
        picture = {"type": "bitmap", "bitmap": bitmap, "raw": True, "wrap_mode": "mirror"}
    return {
        "type": "rectangle",
        "to_world": mi.ScalarTransform4f().scale(room.table_m / 2),
        "bsdf": {"type": "twosided", "nested": room.table.described(picture)},
    }


def _part(part: Solid, look: Look) -> Any:
    import mitsuba as mi

    points, normals, triangles = mesh(part, look.edge_radius_m)
    bsdf = mi.load_dict({"type": "twosided", "nested": look.surface.described()})
    properties = mi.Properties()
    properties["bsdf"] = bsdf
    shape = mi.Mesh("part", len(points), len(triangles), has_vertex_normals=True, props=properties)
    parameters = mi.traverse(shape)
    parameters["vertex_positions"] = mi.Float(points.ravel().astype(np.float32))
    parameters["vertex_normals"] = mi.Float(normals.ravel().astype(np.float32))
    parameters["faces"] = mi.UInt32(triangles.ravel().astype(np.uint32))
    parameters.update()
    return shape


def _traced(scene: Any, camera: Camera, table_T_camera: Transform, seed: int) -> Floats:
    """The light (H, W) that falls on each pixel."""
    import mitsuba as mi

    rays, per_column, per_row = lens(camera)
    count, random = len(rays), np.random.default_rng(seed)
    integrator, sampler = mi.load_dict({"type": "path", "max_depth": _BOUNCES}), mi.load_dict({"type": "independent"})
    origin = mi.Point3f(*(float(each) for each in table_T_camera.translation))
    light = np.zeros(count)
    for number in range(_PASSES):
        jitter = random.uniform(-0.5, 0.5, (2, _AT_ONCE, count, 1)).astype(np.float32)
        ahead = (rays + jitter[0] * per_column + jitter[1] * per_row) @ table_T_camera.rotation.T
        ahead /= np.linalg.norm(ahead, axis=-1, keepdims=True)
        sampler.seed(seed * _PASSES + number, count * _AT_ONCE)
        direction = mi.Vector3f(*(mi.Float(ahead[..., axis].ravel().astype(np.float32)) for axis in range(3)))
        shown, _, _ = integrator.sample(scene, sampler, mi.RayDifferential3f(origin, direction))
        light += np.minimum(np.array(shown[0]), _BRIGHTEST).reshape(_AT_ONCE, count).mean(axis=0)
    return (light / _PASSES).reshape(camera.height_px, camera.width_px)
