"""What parts and tables are made of, and the room they are in."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

import cv2
import numpy as np
from rendering import Lamp

from stereo_pick.core.arrays import Floats

Kind = Literal["matte", "plastic", "lacquer", "metal"]


@dataclass(frozen=True)
class Surface:
    """A material: rough plastic, smooth lacquer and brushed or polished metal reflect the room.

    roughness: of its highlights, 0 a mirror's.
    """

    kind: Kind
    albedo: float
    roughness: float = 0.2

    def described(self, albedo: Any = None) -> dict[str, Any]:
        """As Mitsuba wants it; albedo: a texture in place of the number."""
        colour = albedo or {"type": "rgb", "value": self.albedo}
        if self.kind == "matte":
            return {"type": "diffuse", "reflectance": colour}
        if self.kind == "plastic":
            return {"type": "roughplastic", "diffuse_reflectance": colour, "alpha": self.roughness}
        if self.kind == "lacquer":
            return {"type": "plastic", "diffuse_reflectance": colour}
        return {
            "type": "roughconductor", "material": "none", "specular_reflectance": colour, "alpha": self.roughness,
        }  # fmt: skip


@dataclass(frozen=True)
class Look:
    """A part's surface, and the radius to which its edges are rounded."""

    surface: Surface
    edge_radius_m: float = 0.0005


@dataclass(frozen=True, eq=False)
class Room:
    """The table's surface, its picture (H, W) of albedos over `table_m` by `table_m` if it has one, and the light.

    lamp: its light on a surface that faces it is about its strength; walls: how bright the room around is.
    """

    table: Surface
    lamp: Lamp
    walls: float = 0.4
    picture: Floats | None = None
    table_m: float = 4.0

    def described_light(self) -> dict[str, Any]:
        """As Mitsuba wants it. What is sampled of the room is what surfaces reflect: half of the noise is gone."""
        walls = {"type": "constant", "radiance": {"type": "rgb", "value": self.walls}, "sampling_weight": 0.0}
        return {"walls": walls, "lamp": _disc(self.lamp)}


def _disc(lamp: Lamp) -> dict[str, Any]:
    import mitsuba as mi

    centre, radius_m = lamp.centre_m, max(lamp.radius_m, 0.01)
    radiance = lamp.strength * lamp.distance_m**2 / radius_m**2
    up = [0.0, 1.0, 0.0] if abs(lamp.direction[1]) < 0.9 else [1.0, 0.0, 0.0]
    to_world = mi.ScalarTransform4f().look_at(origin=centre.tolist(), target=[0, 0, 0], up=up)
    return {
        "type": "disk",
        "to_world": to_world @ mi.ScalarTransform4f().scale(radius_m),
        "emitter": {"type": "area", "radiance": {"type": "rgb", "value": float(radiance)}},
        "bsdf": {"type": "diffuse", "reflectance": {"type": "rgb", "value": 0.0}},
    }


def speckled(random: np.random.Generator, albedo: float, contrast: float, grain_m: float, size_m: float) -> Floats:
    """Albedos of a table with grain, as stone or board has."""
    count = 2048
    noise = cv2.GaussianBlur(random.standard_normal((count, count)), (0, 0), max(grain_m / size_m * count, 0.5))
    return np.clip(albedo * (1 + contrast * noise / noise.std()), 0.01, 0.95)
