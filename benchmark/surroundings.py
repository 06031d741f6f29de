"""Scenes with more in them than parts: what is printed, lies, stands or hangs where robots work.

From a seed comes a scene, and how many of its solids, the first ones, are parts that must be found.
"""

from __future__ import annotations

import zlib
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
from parts import box, cylinder, hex_prism, mixed, yaw
from placing import NoRoomError, Table, footprint_gap_m
from rendering import Box, Cylinder, Paint, Solid
from rendering.printed import Board, Holes, Lines, Marker, Spot, Text
from staging import BRIGHT, Random, Staged, table_of, with_mixed, workshop

Surrounded = tuple[Staged, int]
_PARTS = 4
_SCENE_TRIES, _TRIES = 200, 400
_LENSES_M = 0.42  # from the table's origin: what is further away lenses may not be good for


def staged(family: str, seed: int) -> Surrounded:
    """Scene `seed` of a family."""
    random = np.random.default_rng([zlib.crc32(f"surroundings {family}".encode()), seed])
    for _ in range(_SCENE_TRIES):
        try:
            return SURROUNDINGS[family](random)
        except NoRoomError:
            continue
    raise RuntimeError(f"{family} {seed}: the parts find no room")


def breadboard(random: Random) -> Surrounded:
    """An optical table: threaded holes every 25 mm."""
    return _on(random, [Holes(0.025, _from(random, 0.005, 0.008), yaw(random), _from(random, 0.15, 0.5))])


def cutting_mat(random: Random) -> Surrounded:
    """A grid of lines every 10 mm."""
    return _on(random, [Lines(0.01, _from(random, 0.0004, 0.001), yaw(random), _from(random, 1.4, 2.2))])


def chessboard(random: Random) -> Surrounded:
    """The board of the calibration was left lying."""
    return _on(random, [Board(*_place(random, 0.12), yaw(random), _from(random, 0.015, 0.03))])


def thick_board(random: Random) -> Surrounded:
    """The same, but the board is 3 to 6 mm thick."""
    name, table = with_mixed(random, count=_PARTS)
    thick_m, square_m = _from(random, 0.003, 0.006), _from(random, 0.015, 0.03)
    for _ in range(_TRIES):
        (x, y), turn = _place(random, 0.15), yaw(random)
        if _is_clear_of(table, [Box(x, y, (10 * square_m, 8 * square_m, thick_m), turn)], 0.01):
            return _with(random, name, table, _squares(x, y, turn, square_m, thick_m))
    raise NoRoomError


def markers(random: Random) -> Surrounded:
    """Three to six square markers."""
    count = random.integers(3, 7)
    return _on(
        random,
        [Marker(*_place(random, 0.25), yaw(random), _from(random, 0.025, 0.06), _seed(random)) for _ in range(count)],
    )


def newspaper(random: Random) -> Surrounded:
    """A table covered with print."""
    ink = Text(_from(random, 0.003, 0.006), yaw(random), _from(random, 0.3, 0.6), _seed(random))
    return _on(random, [ink], table=(0.3, 0.45), parts=(0.65, 0.95))


def stains(random: Random) -> Surrounded:
    """Spots of oil and of paint, some with soft edges."""
    softness_m = (0.0005, 0.004, 0.015)
    spots = [
        Spot(
            *_place(random, 0.25),
            _from(random, 0.01, 0.05),
            _from(random, 0.5, 1.6),
            float(random.choice(softness_m)),
            _seed(random),
        )
        for _ in range(random.integers(4, 10))
    ]
    return _on(random, spots)


def stacked(random: Random) -> Surrounded:
    """A part on another, and three that stand alone."""
    name, table = table_of(random, (32, 75))
    lower = replace((box, cylinder, hex_prism)[random.integers(3)](random, _from(random, *BRIGHT)), **table.somewhere())
    upper = replace(mixed(random, 1, BRIGHT, 0.6)[0], x_m=lower.x_m, y_m=lower.y_m, base_m=lower.height_m)
    wide_m = 1.3 * max(lower.size_m[:2])
    bound = Cylinder(lower.x_m, lower.y_m, (wide_m, wide_m, lower.height_m + upper.height_m))
    if not table.whole(bound):
        raise NoRoomError
    table.parts.append(bound)
    for part in mixed(random, 3, BRIGHT):
        table.add(part)
    del table.parts[0]
    return _with(random, name, table, [lower, upper])


def cable(random: Random) -> Surrounded:
    """A cable lies across the table."""
    name, table = with_mixed(random, count=_PARTS)
    thick_m, albedo = _from(random, 0.004, 0.008), float(random.choice((0.08, 0.6)))
    for _ in range(_TRIES):
        pieces = _bent(random, thick_m, albedo)
        if _is_clear_of(table, pieces, 0.006):
            return _with(random, name, table, pieces)
    raise NoRoomError


def swarf(random: Random) -> Surrounded:
    """Chips, 2 to 6 mm long."""
    name, table = with_mixed(random, count=_PARTS)
    chips = [
        Box(
            *_place(random, 0.3),
            (_from(random, 0.002, 0.006), _from(random, 0.001, 0.003), _from(random, 0.0005, 0.002)),
            yaw(random),
            _from(random, 0.1, 0.8),
        )
        for _ in range(60)
    ]
    return _with(random, name, table, [each for each in chips if _is_clear_of(table, [each], 0.001)])


def gripper(random: Random) -> Surrounded:
    """Two fingers and a wrist above the table."""
    name, table = with_mixed(random, count=_PARTS)
    (x, y), turn, albedo, low = _place(random, 0.15), yaw(random), _from(random, 0.05, 0.7), _from(random, 0.07, 0.15)
    ahead = 0.03 * _towards(turn)
    fingers = [
        Box(x + side * ahead[0], y + side * ahead[1], (0.015, 0.025, 0.06), turn, albedo, base_m=low)
        for side in (-1, 1)
    ]
    return _with(random, name, table, [*fingers, Cylinder(x, y, (0.08, 0.08, 0.12), albedo=albedo, base_m=low + 0.06)])


def container(random: Random) -> Surrounded:
    """Parts within the four walls of a box without a lid."""
    name, table = with_mixed(random, count=_PARTS)
    turn, high, albedo = _from(random, -0.3, 0.3), _from(random, 0.03, 0.06), _from(random, 0.1, 0.7)
    along, across = _towards(turn), _towards(turn + np.pi / 2)
    hulls = np.concatenate([part.hull_m()[:, :2] for part in table.parts]) @ np.stack([along, across], axis=1)
    low, far = hulls.min(axis=0) - 0.03, hulls.max(axis=0) + 0.03
    middle = (low + far) / 2 @ np.stack([along, across])
    length, width = far - low
    walls = [
        Box(*(middle + side * length / 2 * along), (0.004, width + 0.004, high), turn, albedo) for side in (-1, 1)
    ] + [Box(*(middle + side * width / 2 * across), (length + 0.004, 0.004, high), turn, albedo) for side in (-1, 1)]
    return _with(random, name, table, walls)


def platform(random: Random) -> Surrounded:
    """Three parts on the table, and two on a plate that lies on it."""
    name, table = with_mixed(random, count=3)
    raised, thick_m, albedo = mixed(random, 2, BRIGHT), _from(random, 0.004, 0.02), _from(random, 0.1, 0.5)
    for _ in range(_TRIES):
        (x, y), turn = _place(random, 0.2), yaw(random)
        plate, ahead = Box(x, y, (0.2, 0.12, thick_m), turn, albedo), 0.05 * _towards(turn)
        on_it = [
            replace(part, x_m=x + float(side * ahead[0]), y_m=y + float(side * ahead[1]), base_m=thick_m)
            for side, part in zip((-1, 1), raised)
        ]
        is_whole = all(table.whole(each) for each in (plate, *on_it))
        if is_whole and _is_clear_of(table, [plate], 0.01) and all(table.apart(part, 6) for part in on_it):
            return _with(random, name, table, [plate, *on_it])
    raise NoRoomError


def rail(random: Random) -> Surrounded:
    """A square profile runs through the view."""
    name, table = with_mixed(random, count=_PARTS)
    wide_m, albedo = _from(random, 0.02, 0.045), _from(random, 0.3, 0.7)
    for _ in range(_TRIES):
        (x, y), turn = _place(random, 0.3), yaw(random)
        ahead = 0.1 * _towards(turn)
        pieces = [
            Box(float(x + k * ahead[0]), float(y + k * ahead[1]), (0.1, wide_m, wide_m), turn, albedo)
            for k in range(-8, 9)
        ]
        if _is_clear_of(table, pieces, 0.04):
            return _with(random, name, table, _near(pieces))
    raise NoRoomError


SURROUNDINGS: dict[str, Callable[[Random], Surrounded]] = {
    each.__name__: each
    for each in (
        breadboard, cutting_mat, chessboard, thick_board, markers, newspaper, stains, stacked, cable, swarf, gripper,
        container, platform, rail,
    )
}  # fmt: skip


def _on(
    random: Random,
    paints: Sequence[Paint],
    table: tuple[float, float] = (0.15, 0.35),
    parts: tuple[float, float] = BRIGHT,
) -> Surrounded:
    name, placed = with_mixed(random, albedos=parts)
    staged = workshop(random, name, placed, paints=tuple(paints), table_albedo=_from(random, *table))
    return staged, len(placed.parts)


def _with(random: Random, name: str, table: Table, others: Sequence[Solid]) -> Surrounded:
    parts = len(table.parts)
    table.parts.extend(others)
    return workshop(random, name, table), parts


def _is_clear_of(table: Table, pieces: Sequence[Solid], gap_m: float) -> bool:
    return all(footprint_gap_m(each, part) > gap_m for each in pieces for part in table.parts)


def _bent(random: Random, thick_m: float, albedo: float) -> list[Solid]:
    """A cable as pieces of 2 cm, each a little turned from the one before it."""
    turn, bend = yaw(random), _from(random, -2, 2)
    at = random.uniform(-0.15, 0.15, 2) - 0.5 * _towards(turn)
    pieces: list[Solid] = []
    for k in range(50):
        ahead = 0.02 * _towards(turn)
        x, y = at + ahead / 2
        pieces.append(Cylinder(float(x), float(y), (thick_m, thick_m, 0.0205), turn, albedo, lying=True))
        at = at + ahead
        turn += bend * float(0.02 + 0.075 * np.sin(k / 6))
    return _near(pieces)


def _squares(x_m: float, y_m: float, yaw_rad: float, square_m: float, thick_m: float) -> list[Solid]:
    """A chessboard of 8 x 6 squares with a margin as wide as they are, as boxes."""
    along, across = square_m * _towards(yaw_rad), square_m * _towards(yaw_rad + np.pi / 2)
    size = (square_m, square_m, thick_m)
    found: list[Solid] = []
    for column, row in np.ndindex(10, 8):
        is_black = 0 < column < 9 and 0 < row < 7 and (column + row) % 2
        x, y = (column - 4.5) * along + (row - 3.5) * across + (x_m, y_m)
        found.append(Box(float(x), float(y), size, yaw_rad, 0.06 if is_black else 0.8))
    return found


def _near(pieces: Sequence[Solid]) -> list[Solid]:
    return [each for each in pieces if np.hypot(each.x_m, each.y_m) < _LENSES_M]


def _towards(direction_rad: float) -> np.ndarray:
    return np.array([np.cos(direction_rad), np.sin(direction_rad)])


def _place(random: Random, reach_m: float) -> tuple[float, float]:
    x, y = random.uniform(-reach_m, reach_m, 2)
    return float(x), float(y)


def _from(random: Random, low: float, high: float) -> float:
    return float(random.uniform(low, high))


def _seed(random: Random) -> int:
    return int(random.integers(1000))
