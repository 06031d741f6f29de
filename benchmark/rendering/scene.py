"""Parts, table and light; and how brightly what rays meet is lit."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from rendering.intervals import dot, taken
from rendering.lamps import Lamp
from rendering.rigs import rotation
from rendering.shadows import ShadowMap, visible_from
from rendering.solids import Solid, Tube
from rendering.tabletop import Paint, surface_texture
from stereo_pick.core.arrays import Floats, Ints
from stereo_pick.core.rig import StereoRig
from stereo_pick.core.transform import Transform

_FAR = 1e3
_SHININESS = 40
TABLE, FIRST = 0, 1  # labels: the table's, and that of the first part


def table(distance_m: float = 0.9, tilt_deg: float = 40.0) -> Transform:
    """`left_T_table` of a table at this distance before the left camera, tilted from facing it."""
    return Transform(rotation((np.pi - np.deg2rad(tilt_deg), 0, 0)), np.array([0, 0, distance_m]))


_TABLE = table()


class Surface(NamedTuple):
    """What N rays meet: label (N,), points (N, 3), normals (N, 3), and which are inner walls (N,)."""

    label: Ints
    points: Floats
    normal: Floats
    inner: Floats


@dataclass(frozen=True)
class Scene:
    """Parts on a table under lamps and the room's even light.

    ambient: share of the light that is the room's; sky: 0 where that comes from everywhere, 1 where from above only
    (and back from the table); shadows: whether parts shade the table and each other.
    """

    solids: tuple[Solid, ...]
    left_T_table: Transform = _TABLE
    table_albedo: float = 0.2
    table_gloss: float = 0.0
    paints: tuple[Paint, ...] = ()
    lamps: tuple[Lamp, ...] = (Lamp((0.1, -0.2, 0.97)),)
    ambient: float = 0.6
    sky: float = 0.0
    shadows: bool = False

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

    @cached_property
    def _shadow_map(self) -> ShadowMap:
        return ShadowMap.of(self.solids, self.lamps)

    def meet(self, origin: Floats, rays: Floats, near: tuple[Ints, ...]) -> Surface:
        """The first surface on each ray (N, 3) of the table's frame; near: for each part, the rays that may meet it."""
        with np.errstate(divide="ignore"):
            best = np.where(rays[:, 2] < 0, -origin[2] / rays[:, 2], _FAR)
        label = np.zeros(len(rays), np.int64)
        normal = np.zeros(rays.shape, order="F")
        normal[:, 2] = 1.0
        inner = np.zeros(len(rays))
        for number, (solid, rows) in enumerate(zip(self.solids, near), start=FIRST):
            hit = solid.hit(origin, taken(rays, rows))
            nearer = np.flatnonzero(hit.at < best[rows])
            rows = rows[nearer]
            best[rows], label[rows], inner[rows] = hit.at[nearer], number, hit.inside[nearer]
            normal[rows] = taken(hit.normal, nearer)
        return Surface(label, origin + best[:, None] * rays, normal, inner)

    def radiance(self, origin: Floats, rays: Floats, seen: Surface) -> Floats:
        """What N rays show of what they meet: (N,), 1 is white in full light."""
        light, shine = np.empty(len(rays)), np.empty(len(rays))
        on_table = np.flatnonzero(seen.label == TABLE)
        light[on_table], shine[on_table] = self._table_light(taken(seen.points, on_table), taken(rays, on_table))
        for number, solid in enumerate(self.solids, start=FIRST):
            rows = np.flatnonzero(seen.label == number)
            if len(rows):
                part = Surface(seen.label[rows], taken(seen.points, rows), taken(seen.normal, rows), seen.inner[rows])
                light[rows], shine[rows] = self._part_light(solid, part, taken(rays, rows))
        return self._albedo(seen) * light + shine

    def _albedo(self, seen: Surface) -> Floats:
        albedo = np.full(len(seen.label), self.table_albedo)
        for paint in self.paints:
            albedo = paint.over(seen.points[:, :2], albedo)
        for number, solid in enumerate(self.solids, start=FIRST):
            rows = np.flatnonzero(seen.label == number)
            albedo[rows] = solid.albedo
            if solid.texture and len(rows):
                albedo[rows] *= 1 + solid.texture * surface_texture(seen.points[rows])
        return albedo

    def _table_light(self, points: Floats, rays: Floats) -> tuple[Floats, Floats]:
        open_sky, lit = 1.0, [1.0] * len(self.lamps)
        if self.shadows and self.solids:
            open_sky, lit = self._shadow_map.at(points)
        up = np.array([[0.0, 0.0, 1.0]])
        return self._lit(points, up, rays, self.ambient * open_sky, lit, self.table_gloss)

    def _part_light(self, solid: Solid, seen: Surface, rays: Floats) -> tuple[Floats, Floats]:
        up = seen.normal[:, 2]
        from_room = 1 - self.sky + self.sky * ((1 + up) / 2 + self.table_albedo * (1 - up) / 2)
        lit = [np.ones(len(rays)) for _ in self.lamps]
        if self.shadows:
            others = [other for other in self.solids if other is not solid]
            lit = [visible_from(lamp, seen.points, solid, others) for lamp in self.lamps]
        inner = seen.inner > 0
        if isinstance(solid, Tube) and inner.any():
            from_room = np.where(inner, solid.openness(seen.points), from_room)
            lit = [
                seen_lamp * (~inner | solid.light_enters(seen.points, lamp.centre_m - seen.points))
                for lamp, seen_lamp in zip(self.lamps, lit)
            ]
        return self._lit(seen.points, seen.normal, rays, self.ambient * from_room, lit, solid.gloss)

    def _lit(
        self,
        points: Floats,
        normal: Floats,
        rays: Floats,
        ambient: Floats | float,
        lit: list[Floats] | list[float],
        gloss: float,
    ) -> tuple[Floats, Floats]:
        light = np.zeros(len(points)) + ambient
        shine = np.zeros(len(points))
        eye = -rays / np.linalg.norm(rays, axis=1, keepdims=True) if gloss else rays
        for lamp, visible in zip(self.lamps, lit):
            direction, strength = lamp.on(points)
            strength = strength * visible * (1 - self.ambient)
            light += strength * np.maximum(dot(direction, normal), 0)
            if gloss:
                half = direction + eye
                half /= np.linalg.norm(half, axis=1, keepdims=True)
                shine += gloss * strength * np.maximum(dot(half, normal), 0) ** _SHININESS
        if gloss:
            mirrored_up = 2 * dot(eye, normal) * normal[:, 2] - eye[:, 2]
            shine += gloss * self.ambient * 0.5 / (1 + np.exp(-8 * mirrored_up))
        return light, shine
