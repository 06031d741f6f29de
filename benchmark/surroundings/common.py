"""What scenes with surroundings share: parts on a table, and things among them or on it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from placing import Table, footprint_gap_m
from rendering import Paint, Solid
from staging import BRIGHT, Random, Staged, with_mixed, workshop

from stereo_pick.core.arrays import Floats

Surrounded = tuple[Staged, int]  # a scene, and how many of its solids, the first ones, must be found
PARTS = 4
TRIES = 400
_LENSES_M = 0.42  # from the table's origin: what is further away lenses may not be good for


def on(
    random: Random,
    paints: Sequence[Paint],
    table: tuple[float, float] = (0.15, 0.35),
    parts: tuple[float, float] = BRIGHT,
) -> Surrounded:
    name, placed = with_mixed(random, albedos=parts)
    staged = workshop(random, name, placed, paints=tuple(paints), table_albedo=drawn(random, *table))
    return staged, len(placed.parts)


def with_things(random: Random, name: str, table: Table, others: Sequence[Solid]) -> Surrounded:
    parts = len(table.parts)
    table.parts.extend(others)
    return workshop(random, name, table), parts


def is_clear_of(table: Table, pieces: Sequence[Solid], gap_m: float) -> bool:
    return all(footprint_gap_m(each, part) > gap_m for each in pieces for part in table.parts)


def near(pieces: Sequence[Solid]) -> list[Solid]:
    return [each for each in pieces if np.hypot(each.x_m, each.y_m) < _LENSES_M]


def towards(direction_rad: float) -> Floats:
    return np.array([np.cos(direction_rad), np.sin(direction_rad)])


def place(random: Random, reach_m: float) -> tuple[float, float]:
    x, y = random.uniform(-reach_m, reach_m, 2)
    return float(x), float(y)


def drawn(random: Random, low: float, high: float) -> float:
    return float(random.uniform(low, high))


def seed(random: Random) -> int:
    return int(random.integers(1000))
