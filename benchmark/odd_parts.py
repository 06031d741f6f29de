"""Parts of shapes that the package does not know, and that no solids that it knows make up."""

from __future__ import annotations

from collections.abc import Callable

from composites import Composite
from parts import Random, yaw
from rendering import Solid
from rendering.odd_solids import Cone, Egg, HalfRound, Pyramid, Wedge


def cone(random: Random, albedo: float) -> Composite:
    """A cone without its tip."""
    below, height = float(random.uniform(0.038, 0.052)), float(random.uniform(0.03, 0.06))
    return _one(Cone(0, 0, (below, below, height), albedo=albedo, above=float(random.uniform(0.4, 0.85))))


def cup(random: Random, albedo: float) -> Composite:
    """The same, on its narrow end."""
    above, height = float(random.uniform(0.042, 0.056)), float(random.uniform(0.03, 0.06))
    narrow = float(random.uniform(0.6, 0.9))
    return _one(Cone(0, 0, (above, above, height), albedo=albedo, below=narrow, above=1.0))


def pyramid(random: Random, albedo: float) -> Composite:
    """A pyramid without its tip, on its base."""
    long, ratio, height = (float(random.uniform(*each)) for each in ((0.04, 0.065), (0.6, 1.0), (0.025, 0.05)))
    return _one(
        Pyramid(0, 0, (long, long * ratio, height), yaw(random), albedo, taper=float(random.uniform(0.4, 0.85)))
    )


def wedge(random: Random, albedo: float) -> Composite:
    """Half of a box that is cut along a diagonal."""
    size = tuple(float(random.uniform(*each)) for each in ((0.04, 0.065), (0.03, 0.05), (0.025, 0.05)))
    return _one(Wedge(0, 0, (size[0], size[1], size[2]), yaw(random), albedo))


def half_round(random: Random, albedo: float) -> Composite:
    """Half a cylinder, on its flat side."""
    radius, length = float(random.uniform(0.016, 0.028)), float(random.uniform(0.045, 0.075))
    return _one(HalfRound(0, 0, (radius, 2 * radius, length), yaw(random), albedo, lying=True))


def egg(random: Random, albedo: float) -> Composite:
    """An ellipsoid, lying."""
    long, ratio, flat = (float(random.uniform(*each)) for each in ((0.045, 0.06), (0.65, 0.9), (0.8, 1.0)))
    return _one(Egg(0, 0, (long, long * ratio, long * ratio * flat), yaw(random), albedo))


ODD_PARTS: dict[str, Callable[[Random, float], Composite]] = {
    each.__name__: each for each in (cone, cup, pyramid, wedge, half_round, egg)
}


def _one(solid: Solid) -> Composite:
    return Composite((solid,), (1.0,), solid.centre_m[None])
