"""Stereo pairs of parts on a table, ray-cast, with exact truth: what the tests compare the package with."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, replace

import cv2
import numpy as np
from rigs import rotation

from stereo_pick.core.arrays import Floats, Image
from stereo_pick.core.camera import Camera
from stereo_pick.core.frames import StereoFrame
from stereo_pick.core.rig import StereoRig
from stereo_pick.core.transform import Transform

_SUBSAMPLES = 4  # each way
_FLAT = 0.03  # change of light between neighbours below which one ray a pixel will do
_MARGIN_PX = 3


@dataclass(frozen=True)
class Solid(ABC):
    """A convex part that stands on the table at (x, y) [m] of the table's frame, whose z axis points up."""

    x_m: float
    y_m: float
    size_m: tuple[float, float, float]
    yaw_rad: float = 0.0
    albedo: float = 0.85
    texture: float = 0.0

    @property
    def centre_m(self) -> Floats:
        return np.array([self.x_m, self.y_m, self.size_m[2] / 2])

    @property
    def axes(self) -> Floats:
        c, s = np.cos(self.yaw_rad), np.sin(self.yaw_rad)
        return np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])

    def hit(self, origin: Floats, rays: Floats) -> tuple[Floats, Floats]:
        """How far (N,) along its ray each of N rays meets the part, inf where it does not, and the normal (N, 3)."""
        start, ahead = (origin - self.centre_m) @ self.axes, rays @ self.axes
        near, far, normal = self._interval(start, ahead)
        return np.where((near < far) & (near > 0), near, np.inf), normal @ self.axes.T

    @abstractmethod
    def _interval(self, start: Floats, ahead: Floats) -> tuple[Floats, Floats, Floats]: ...

    def corners_m(self) -> Floats:
        unit = np.stack(np.meshgrid(*[(-0.5, 0.5)] * 3), axis=-1).reshape(-1, 3)
        return (unit * self.size_m) @ self.axes.T + self.centre_m


class Box(Solid):
    def _interval(self, start: Floats, ahead: Floats) -> tuple[Floats, Floats, Floats]:
        near, far = _slab(start, ahead, np.array(self.size_m) / 2)
        axis = near.argmax(axis=1)
        normal = -np.sign(ahead) * (np.arange(3) == axis[:, None])
        return near.max(axis=1), far.min(axis=1), normal


class Cylinder(Solid):
    """Upright; the first two sizes are its diameter."""

    def _interval(self, start: Floats, ahead: Floats) -> tuple[Floats, Floats, Floats]:
        near, far = _slab(start[2:], ahead[:, 2:], np.array(self.size_m[2:]) / 2)
        side_near, side_far = _ball(start[:2], ahead[:, :2], self.size_m[0] / 2)
        side = (start + ahead * np.where(np.isfinite(side_near), side_near, 0)[:, None]) * (1, 1, 0)
        side /= self.size_m[0] / 2
        on_side = side_near > near[:, 0]
        normal = np.where(on_side[:, None], side, (0.0, 0.0, 1.0))
        return np.maximum(near[:, 0], side_near), np.minimum(far[:, 0], side_far), normal


class Sphere(Solid):
    """All three sizes are its diameter."""

    def _interval(self, start: Floats, ahead: Floats) -> tuple[Floats, Floats, Floats]:
        near, far = _ball(start, ahead, self.size_m[0] / 2)
        at = np.where(np.isfinite(near), near, 0)[:, None]
        return near, far, (start + ahead * at) / (self.size_m[0] / 2)


def table(distance_m: float = 0.9, tilt_deg: float = 40.0) -> Transform:
    """`left_T_table` of a table at this distance before the left camera, tilted from facing it."""
    return Transform(rotation((np.pi - np.deg2rad(tilt_deg), 0, 0)), np.array([0, 0, distance_m]))


_TABLE = table()


@dataclass(frozen=True)
class Scene:
    """Parts on a matte table, lit by a distant lamp."""

    solids: tuple[Solid, ...]
    left_T_table: Transform = _TABLE
    table_albedo: float = 0.2
    falloff_per_m: float = 0.0
    light: tuple[float, float, float] = (0.1, -0.2, 0.97)
    ambient: float = 0.6

    def positions_m(self) -> Floats:
        """Centres (N, 3) of the parts in the left optical frame."""
        return self.left_T_table.apply(np.array([solid.centre_m for solid in self.solids]).reshape(-1, 3))

    def silhouette_points_m(self, rig: StereoRig) -> Floats:
        """Where the centroids of spheres' silhouettes in the rectified views triangulate to, (N, 3), left frame.

        The silhouette of a sphere at (X, Y, Z) with radius r is an ellipse around (X Z, Y Z) / (Z² - r²).
        """
        rectified = self.positions_m() @ rig.left.R.T
        radius = np.array([solid.size_m[0] / 2 for solid in self.solids])
        rectified[:, 2] -= radius**2 / rectified[:, 2]
        return rectified @ rig.left.R

    def radiance(self, origin: Floats, rays: Floats) -> Floats:
        """What N rays (N, 3) of the table's frame show: (N,), 1 is white in full light."""
        with np.errstate(divide="ignore"):
            best = np.where(rays[:, 2] < 0, -origin[2] / rays[:, 2], 1e6)
        albedo = self.table_albedo * np.exp(self.falloff_per_m * np.clip(origin[0] + best * rays[:, 0], -2, 2))
        normal = np.broadcast_to((0.0, 0.0, 1.0), rays.shape)
        for solid in self.solids:
            at, its_normal = solid.hit(origin, rays)
            nearer = at < best
            best = np.where(nearer, at, best)
            paint = np.full(len(rays), solid.albedo)
            if solid.texture:
                paint[nearer] *= 1 + solid.texture * _pattern(origin + rays[nearer] * at[nearer, None])
            albedo = np.where(nearer, paint, albedo)
            normal = np.where(nearer[:, None], its_normal, normal)
        lamp = np.array(self.light) / np.linalg.norm(self.light)
        return albedo * (self.ambient + (1 - self.ambient) * np.clip(normal @ lamp, 0, None))


@dataclass(frozen=True)
class Sensor:
    """How radiance becomes grey levels."""

    gain: float = 1.0
    offset_dn: float = 0.0
    blur_px: float = 0.7
    noise_dn: float = 1.0


CLEAN = Sensor()


def render(rig: StereoRig, scene: Scene, left: Sensor = CLEAN, right: Sensor = CLEAN, seed: int = 0) -> StereoFrame:
    """The raw pair that the rig takes of the scene."""
    noise = np.random.default_rng(seed)
    table_T_left = scene.left_T_table.inverse()
    table_T_right = table_T_left @ rig.right_T_left.inverse()
    return StereoFrame(
        _expose(rig.left, scene, table_T_left, left, noise), _expose(rig.right, scene, table_T_right, right, noise)
    )


def _expose(
    camera: Camera, scene: Scene, table_T_camera: Transform, sensor: Sensor, noise: np.random.Generator
) -> Image:
    """Rays through undistorted pixel coordinates: no image is ever resampled. More a pixel where the light changes."""
    v, u = np.mgrid[: camera.height_px, : camera.width_px]
    bare = replace(scene, solids=())
    light = _cast(camera, bare, table_T_camera, np.stack([u, v], axis=-1).reshape(-1, 2)).reshape(u.shape)
    near = np.zeros(u.shape, bool)
    for solid in scene.solids:
        corners = camera.project(table_T_camera.inverse().apply(solid.corners_m()))
        low, high = np.floor(corners.min(axis=0)) - _MARGIN_PX, np.ceil(corners.max(axis=0)) + _MARGIN_PX
        near |= (u >= low[0]) & (u <= high[0]) & (v >= low[1]) & (v <= high[1])
    light[near] = _cast(camera, scene, table_T_camera, np.stack([u[near], v[near]], axis=-1))
    around = np.ones((3, 3), np.uint8)
    near &= cv2.dilate(light, around) - cv2.erode(light, around) > _FLAT
    step = (np.arange(_SUBSAMPLES) + 0.5) / _SUBSAMPLES - 0.5
    inside_pixel = np.stack(np.meshgrid(step, step), axis=-1).reshape(1, -1, 2)
    fine = np.stack([u[near], v[near]], axis=-1)[:, None] + inside_pixel
    if len(fine):
        light[near] = _cast(camera, scene, table_T_camera, fine.reshape(-1, 2)).reshape(len(fine), -1).mean(axis=1)
    if sensor.blur_px:
        light = cv2.GaussianBlur(light, (0, 0), sensor.blur_px)
    grey = 255 * sensor.gain * light + sensor.offset_dn + noise.normal(0, sensor.noise_dn, light.shape)
    return np.clip(np.round(grey), 0, 255).astype(np.uint8)


def _cast(camera: Camera, scene: Scene, table_T_camera: Transform, raw_px: Floats) -> Floats:
    rays = np.c_[camera.normalized(raw_px), np.ones(len(raw_px))] @ table_T_camera.rotation.T
    return scene.radiance(table_T_camera.translation, rays)


def balls(*places: tuple[float, float, float], albedo: float = 0.85, texture: float = 0.0) -> tuple[Solid, ...]:
    """Spheres from x, y and diameter [m]."""
    return tuple(Sphere(x, y, (size, size, size), albedo=albedo, texture=texture) for x, y, size in places)


def _slab(start: Floats, ahead: Floats, half: Floats) -> tuple[Floats, Floats]:
    with np.errstate(divide="ignore", invalid="ignore"):
        one, other = (-half - start) / ahead, (half - start) / ahead
    return np.minimum(one, other), np.maximum(one, other)


def _ball(start: Floats, ahead: Floats, radius: float) -> tuple[Floats, Floats]:
    a, b, c = (ahead**2).sum(axis=1), ahead @ start, float(start @ start) - radius**2
    with np.errstate(divide="ignore", invalid="ignore"):
        root = np.sqrt(b * b - a * c)
        near, far = (-b - root) / a, (-b + root) / a
    missed = ~np.isfinite(near)
    return np.where(missed, np.inf, near), np.where(missed, -np.inf, far)


def _pattern(points_m: Floats) -> Floats:
    """A paint that belongs to the surface, -1 to 1: waves of 5 to 12 mm through space."""
    waves = np.random.default_rng(7)
    directions = waves.normal(size=(12, 3))
    directions *= (2 * np.pi / waves.uniform(0.005, 0.012, 12) / np.linalg.norm(directions, axis=1))[:, None]
    return np.tanh(np.cos(points_m @ directions.T + waves.uniform(0, 6.3, 12)).sum(axis=1) / 2.5)
