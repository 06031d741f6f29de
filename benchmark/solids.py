"""The solids of the rendered scenes, and where a ray from the left camera first meets them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from stereo_pick.core.arrays import Floats

Interval = tuple[float, float]
_MISSED: Interval = (np.inf, -np.inf)


@dataclass(frozen=True, eq=False)
class Solid:
    """A convex body; camera_T_solid: (4, 4) [mm], its origin is the centre of the volume, its z axis the axis."""

    shape: str
    dimensions_mm: Mapping[str, float]
    camera_T_solid: Floats

    def first_hit_mm(self, ray: Floats) -> Floats | None:
        """The point (3,), in the camera's frame, where a ray (3,) from the camera enters; None where it misses."""
        rotation, translation = self.camera_T_solid[:3, :3], self.camera_T_solid[:3, 3]
        inside = self._inside(-rotation.T @ translation, rotation.T @ ray)
        enters, leaves = max(near for near, _ in inside), min(far for _, far in inside)
        return ray * enters if enters <= leaves else None

    def _inside(self, origin: Floats, ray: Floats) -> list[Interval]:
        """For which multiples of the ray it is inside each of the bodies that the solid is the intersection of."""
        size = self.dimensions_mm
        if self.shape == "sphere":
            return [_round(origin, ray, size["diameter"] / 2)]
        if self.shape == "box":
            return [_slab(origin, ray, axis, size[name]) for axis, name in zip(np.eye(3), ("lx", "ly", "lz"))]
        ends = _slab(origin, ray, np.array([0.0, 0.0, 1.0]), size["height"])
        if self.shape == "cylinder":
            return [ends, _round(origin[:2], ray[:2], size["diameter"] / 2)]
        if self.shape == "hexprism":
            normals = [np.array([np.cos(a), np.sin(a), 0.0]) for a in np.deg2rad([30, 90, 150])]
            return [ends, *(_slab(origin, ray, normal, size["across_flats"]) for normal in normals)]
        raise ValueError(f"unknown shape {self.shape!r}")


def _slab(origin: Floats, ray: Floats, normal: Floats, thickness_mm: float) -> Interval:
    height, climb = float(normal @ origin), float(normal @ ray)
    if climb == 0.0:
        return (-np.inf, np.inf) if abs(height) <= thickness_mm / 2 else _MISSED
    one, other = (-thickness_mm / 2 - height) / climb, (thickness_mm / 2 - height) / climb
    return min(one, other), max(one, other)


def _round(origin: Floats, ray: Floats, radius_mm: float) -> Interval:
    """A sphere (3-D vectors) or an endless cylinder (the two coordinates across its axis)."""
    a, b, c = float(ray @ ray), float(ray @ origin), float(origin @ origin) - radius_mm**2
    root = b * b - a * c
    if root < 0:
        return _MISSED
    return (-b - np.sqrt(root)) / a, (-b + np.sqrt(root)) / a
