"""Lamps: round, at some distance, so that the table is lit unevenly and shadows have soft borders."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rendering.intervals import dot
from stereo_pick.core.arrays import Floats

_SAMPLES = 16
_GOLDEN_RAD = np.pi * (3 - np.sqrt(5))


@dataclass(frozen=True)
class Lamp:
    """A disc that faces the table's origin.

    towards: its direction from there; strength 1 makes a surface at the origin that faces it white, but for the room's
    share of the light.
    """

    towards: tuple[float, float, float]
    strength: float = 1.0
    distance_m: float = 100.0
    radius_m: float = 0.0

    @property
    def direction(self) -> Floats:
        return np.array(self.towards) / np.linalg.norm(self.towards)

    @property
    def centre_m(self) -> Floats:
        return self.direction * self.distance_m

    def points_m(self) -> Floats:
        """Points (N, 3) spread evenly over the disc."""
        if not self.radius_m:
            return self.centre_m[None]
        across = np.cross(self.direction, (0.0, 1.0, 0.0) if abs(self.direction[1]) < 0.9 else (1.0, 0.0, 0.0))
        across /= np.linalg.norm(across)
        number = np.arange(_SAMPLES)
        reach = self.radius_m * np.sqrt((number + 0.5) / _SAMPLES)[:, None]
        turn = (number * _GOLDEN_RAD)[:, None]
        return self.centre_m + reach * (np.cos(turn) * across + np.sin(turn) * np.cross(self.direction, across))

    def on(self, points: Floats) -> tuple[Floats, Floats]:
        """Unit directions (N, 3) to the lamp from points (N, 3), and how strongly (N,) it shines there."""
        way = self.centre_m - points
        distance2 = dot(way, way)
        return way / np.sqrt(distance2)[:, None], self.strength * self.distance_m**2 / distance2


def lamp_at(
    elevation_deg: float, azimuth_deg: float, strength: float = 1.0, distance_m: float = 1.5, radius_m: float = 0.05
) -> Lamp:
    """A lamp in that direction above the table."""
    e, a = np.deg2rad(elevation_deg), np.deg2rad(azimuth_deg)
    towards = (float(np.cos(e) * np.cos(a)), float(np.cos(e) * np.sin(a)), float(np.sin(e)))
    return Lamp(towards, strength, distance_m, radius_m)
