"""Random parts for the families of scenes; each is put in its place later."""

from __future__ import annotations

import numpy as np
from rendering import Box, Cylinder, HexPrism, Solid, Sphere, Tube, hex_prism_size

Random = np.random.Generator


def cylinder(random: Random, albedo: float, scale: float = 1.0, **look: float) -> Solid:
    diameter, height = random.uniform(0.038, 0.052) * scale, random.uniform(0.04, 0.065) * scale
    return Cylinder(0, 0, (diameter, diameter, height), albedo=albedo, **look)


def lying_cylinder(random: Random, albedo: float, scale: float = 1.0, **look: float) -> Solid:
    diameter, length = random.uniform(0.025, 0.045) * scale, random.uniform(0.05, 0.09) * scale
    return Cylinder(0, 0, (diameter, diameter, length), yaw(random), albedo, lying=True, **look)


def box(random: Random, albedo: float, scale: float = 1.0, **look: float) -> Solid:
    length, ratio = random.uniform(0.04, 0.075) * scale, random.uniform(0.55, 1.0)
    return Box(0, 0, (length, length * ratio, random.uniform(0.025, 0.06) * scale), yaw(random), albedo, **look)


def sphere(random: Random, albedo: float, scale: float = 1.0, **look: float) -> Solid:
    diameter = random.uniform(0.035, 0.055) * scale
    return Sphere(0, 0, (diameter,) * 3, albedo=albedo, **look)


def hex_prism(random: Random, albedo: float, scale: float = 1.0, **look: float) -> Solid:
    size = hex_prism_size(random.uniform(0.035, 0.05) * scale, random.uniform(0.025, 0.055) * scale)
    return HexPrism(0, 0, size, yaw(random), albedo, **look)


def tube(random: Random, albedo: float, scale: float = 1.0, **look: float) -> Solid:
    diameter, length = random.uniform(0.025, 0.04) * scale, random.uniform(0.055, 0.08) * scale
    lying = bool(random.random() < 0.7)
    return Tube(0, 0, (diameter, diameter, length), yaw(random), albedo, lying=lying, bore=0.8, **look)


def footprint(random: Random, albedo: float) -> Solid:
    """Where a label lies."""
    length, ratio = random.uniform(0.006, 0.06), random.uniform(0.4, 1.0)
    return Box(0, 0, (length, length * ratio, 0.0), yaw(random), albedo * random.uniform(0.8, 1.15))


MIXED = (cylinder, lying_cylinder, box, sphere, hex_prism)


def mixed(random: Random, count: int, albedos: tuple[float, float], scale: float = 1.0, **look: float) -> list[Solid]:
    """Parts of all shapes, each of its own albedo."""
    kinds = random.permutation(np.arange(count) % len(MIXED))
    return [MIXED[kind](random, float(random.uniform(*albedos)), scale, **look) for kind in kinds]


def yaw(random: Random) -> float:
    return float(random.uniform(-np.pi, np.pi))
