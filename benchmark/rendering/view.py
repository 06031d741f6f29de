"""What one camera sees of a scene, ray by ray through its own lens: no image is ever resampled."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import cv2
import numpy as np

from rendering.intervals import taken, turned
from rendering.scene import Scene
from rendering.solids import Solid
from stereo_pick.core.arrays import Floats, Ints
from stereo_pick.core.camera import Camera
from stereo_pick.core.transform import Transform

_SUBSAMPLES = 4  # each way
_FLAT = 0.02  # change of light between neighbours below which one ray a pixel will do
_MARGIN_PX = 3


@dataclass(frozen=True, eq=False)
class View:
    """The light (H, W) of each pixel, the part (1, 2, ...; 0 the table) at its centre, and the point there (H, W, 3).

    points_m: in the table's frame.
    """

    light: Floats
    labels: Ints
    points_m: Floats


def view(camera: Camera, scene: Scene, table_T_camera: Transform) -> View:
    """One ray a pixel, and 16 where the light changes."""
    rays, per_column, per_row = lens(camera)
    shape = (camera.height_px, camera.width_px)
    v, u = (each.ravel() for each in np.indices(shape))
    turn = table_T_camera.rotation.T
    bounds = [image_box(camera, solid, table_T_camera) for solid in scene.solids]
    ahead = turned(rays, turn)
    seen = scene.meet(table_T_camera.translation, ahead, _inside(bounds, u, v))
    light = scene.radiance(table_T_camera.translation, ahead, seen).reshape(shape)
    around = np.ones((3, 3), np.uint8)
    uneven = np.flatnonzero(cv2.dilate(light, around) - cv2.erode(light, around) > _FLAT)
    if len(uneven):
        step = (np.arange(_SUBSAMPLES) + 0.5) / _SUBSAMPLES - 0.5
        du, dv = (each.ravel() for each in np.meshgrid(step, step))
        middle, column, row = (taken(each, uneven).T[..., None] for each in (rays, per_column, per_row))
        fine = turned((middle + du * column + dv * row).reshape(3, -1).T, turn)
        near = tuple(_subsamples(rows) for rows in _inside(bounds, u[uneven], v[uneven]))
        finely = scene.meet(table_T_camera.translation, fine, near)
        light.flat[uneven] = (
            scene.radiance(table_T_camera.translation, fine, finely).reshape(len(uneven), -1).mean(axis=1)
        )
    return View(light, seen.label.reshape(shape), seen.points.reshape(*shape, 3))


def silhouette_px(camera: Camera, solid: Solid, table_T_camera: Transform) -> int:
    """How many pixels the part would cover alone, in an image without borders."""
    low, high = image_box(camera, solid, table_T_camera)
    v, u = np.mgrid[low[1] : high[1] + 1, low[0] : high[0] + 1]
    rays = _rays(camera, np.stack([u, v], axis=-1).reshape(-1, 2).astype(np.float64)) @ table_T_camera.rotation.T
    return int(np.isfinite(solid.hit(table_T_camera.translation, rays).at).sum())


def image_box(camera: Camera, solid: Solid, table_T_camera: Transform) -> tuple[Ints, Ints]:
    """The lowest and the highest pixel (2,) that may show the part; may lie outside the image."""
    corners = camera.project(table_T_camera.inverse().apply(solid.corners_m()))
    low, high = np.floor(corners.min(axis=0)) - _MARGIN_PX, np.ceil(corners.max(axis=0)) + _MARGIN_PX
    return low.astype(int), high.astype(int)


def _inside(bounds: list[tuple[Ints, Ints]], u: Ints, v: Ints) -> tuple[Ints, ...]:
    return tuple(
        np.flatnonzero((u >= low[0]) & (u <= high[0]) & (v >= low[1]) & (v <= high[1])) for low, high in bounds
    )


def _subsamples(pixels: Ints) -> Ints:
    return (pixels[:, None] * _SUBSAMPLES**2 + np.arange(_SUBSAMPLES**2)).ravel()


@lru_cache(maxsize=8)
def lens(camera: Camera) -> tuple[Floats, Floats, Floats]:
    """Rays (N, 3) of all pixels, row by row, and by how much they change from one column and one row to the next."""
    v, u = np.mgrid[: camera.height_px, : camera.width_px].astype(np.float64)
    rays = _rays(camera, np.stack([u, v], axis=-1).reshape(-1, 2))
    grid = rays.reshape(*u.shape, 3)
    steps = (np.gradient(grid, axis=axis).reshape(-1, 3) for axis in (1, 0))
    return np.asfortranarray(rays), *(np.asfortranarray(step) for step in steps)


def _rays(camera: Camera, raw_px: Floats) -> Floats:
    return np.c_[camera.normalized(raw_px), np.ones(len(raw_px))]
