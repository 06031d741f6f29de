"""What lies, stands or hangs among parts."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from parts import mixed, yaw
from placing import NoRoomError
from rendering import Box, Cylinder, Edge, Solid, Sphere
from staging import BRIGHT, Random, table_of, with_mixed, workshop

from surroundings.common import PARTS, TRIES, Surrounded, drawn, is_clear_of, near, place, towards, with_things


def thick_board(random: Random) -> Surrounded:
    """The same, but the board is 3 to 6 mm thick."""
    name, table = with_mixed(random, count=PARTS)
    thick_m, square_m = drawn(random, 0.003, 0.006), drawn(random, 0.015, 0.03)
    for _ in range(TRIES):
        (x, y), turn = place(random, 0.15), yaw(random)
        if is_clear_of(table, [Box(x, y, (10 * square_m, 8 * square_m, thick_m), turn)], 0.01):
            return with_things(random, name, table, _squares(x, y, turn, square_m, thick_m))
    raise NoRoomError


def cable(random: Random) -> Surrounded:
    """A cable lies across the table."""
    name, table = with_mixed(random, count=PARTS)
    thick_m, albedo = drawn(random, 0.004, 0.008), float(random.choice((0.08, 0.6)))
    for _ in range(TRIES):
        pieces = _bent(random, thick_m, albedo)
        if is_clear_of(table, pieces, 0.006):
            return with_things(random, name, table, pieces)
    raise NoRoomError


def swarf(random: Random) -> Surrounded:
    """Chips, 2 to 6 mm long."""
    name, table = with_mixed(random, count=PARTS)
    chips = [
        Box(
            *place(random, 0.3),
            (drawn(random, 0.002, 0.006), drawn(random, 0.001, 0.003), drawn(random, 0.0005, 0.002)),
            yaw(random),
            drawn(random, 0.1, 0.8),
        )
        for _ in range(60)
    ]
    return with_things(random, name, table, [each for each in chips if is_clear_of(table, [each], 0.001)])


def gripper(random: Random) -> Surrounded:
    """Two fingers and a wrist above the table."""
    name, table = with_mixed(random, count=PARTS)
    (x, y), turn, albedo, low = place(random, 0.15), yaw(random), drawn(random, 0.05, 0.7), drawn(random, 0.07, 0.15)
    ahead = 0.03 * towards(turn)
    fingers = [
        Box(x + side * ahead[0], y + side * ahead[1], (0.015, 0.025, 0.06), turn, albedo, base_m=low)
        for side in (-1, 1)
    ]
    wrist = Cylinder(x, y, (0.08, 0.08, 0.12), albedo=albedo, base_m=low + 0.06)
    return with_things(random, name, table, [*fingers, wrist])


def container(random: Random) -> Surrounded:
    """Parts within the four walls of a box without a lid."""
    name, table = with_mixed(random, count=PARTS)
    turn, high, albedo = drawn(random, -0.3, 0.3), drawn(random, 0.03, 0.06), drawn(random, 0.1, 0.7)
    along, across = towards(turn), towards(turn + np.pi / 2)
    hulls = np.concatenate([part.hull_m()[:, :2] for part in table.parts]) @ np.stack([along, across], axis=1)
    low, far = hulls.min(axis=0) - 0.03, hulls.max(axis=0) + 0.03
    middle = (low + far) / 2 @ np.stack([along, across])
    length, width = far - low
    walls = [
        Box(*(middle + side * length / 2 * along), (0.004, width + 0.004, high), turn, albedo) for side in (-1, 1)
    ] + [Box(*(middle + side * width / 2 * across), (length + 0.004, 0.004, high), turn, albedo) for side in (-1, 1)]
    return with_things(random, name, table, walls)


def rail(random: Random) -> Surrounded:
    """A square profile runs through the view."""
    name, table = with_mixed(random, count=PARTS)
    wide_m, albedo = drawn(random, 0.02, 0.045), drawn(random, 0.3, 0.7)
    for _ in range(TRIES):
        (x, y), turn = place(random, 0.3), yaw(random)
        ahead = 0.1 * towards(turn)
        pieces = [
            Box(float(x + k * ahead[0]), float(y + k * ahead[1]), (0.1, wide_m, wide_m), turn, albedo)
            for k in range(-8, 9)
        ]
        if is_clear_of(table, pieces, 0.04):
            return with_things(random, name, table, near(pieces))
    raise NoRoomError


def hand(random: Random) -> Surrounded:
    """Somebody's hand and arm reach into the view."""
    name, table = with_mixed(random, count=PARTS)
    for _ in range(TRIES):
        (x, y), turn = place(random, 0.15), yaw(random)
        pieces = _hand(random, x, y, turn, drawn(random, 0.3, 0.6))
        if is_clear_of(table, pieces, 0.01):
            return with_things(random, name, table, near(pieces))
    raise NoRoomError


def dividers(random: Random) -> Surrounded:
    """A tray whose thin walls divide it into cells, with a part in each of some."""
    name, table = table_of(random, (45, 80))
    turn, high, albedo = yaw(random), drawn(random, 0.008, 0.03), drawn(random, 0.1, 0.7)
    pitch, along, across = drawn(random, 0.085, 0.11), towards(turn), towards(turn + np.pi / 2)
    cells = random.permutation(np.stack(np.meshgrid((-1, 0, 1), (-1, 0, 1)), axis=-1).reshape(-1, 2))
    for (column, row), part in zip(cells, mixed(random, PARTS, BRIGHT)):
        x, y = (column * along + row * across) * pitch
        table.parts.append(replace(part, x_m=float(x), y_m=float(y)))
    if not all(table.whole(part) for part in table.parts):
        raise NoRoomError
    walls = [
        Box(*(float(each) for each in k * pitch * ahead), (0.002, 3 * pitch, high), direction, albedo)
        for ahead, direction in ((along, turn), (across, turn + np.pi / 2))
        for k in (-1.5, -0.5, 0.5, 1.5)
    ]
    return with_things(random, name, table, walls)


def belt(random: Random) -> Surrounded:
    """A dark belt between two rails, and a floor of another grey beside them."""
    name, table = with_mixed(random, count=PARTS)
    turn, albedo = drawn(random, -0.3, 0.3), drawn(random, 0.3, 0.7)
    along, across = towards(turn), towards(turn + np.pi / 2)
    wide_m = 2 * max(float(np.abs(part.hull_m()[:, :2] @ across).max()) for part in table.parts) + 0.02
    rails = [
        Box(*(float(each) for each in k * 0.1 * along + side * (wide_m / 2 + 0.01) * across), (0.1, 0.02, 0.03), turn,
            albedo)
        for k in range(-8, 9)
        for side in (-1, 1)
    ]  # fmt: skip
    floor = [Edge(wide_m / 2, turn + side * np.pi / 2, drawn(random, 0.02, 0.3)) for side in (-1, 1)]
    parts = len(table.parts)
    table.parts.extend(near(rails))
    return workshop(random, name, table, paints=tuple(floor), table_albedo=drawn(random, 0.04, 0.12)), parts


def crowd(random: Random) -> Surrounded:
    """Fourteen to twenty parts, half as large."""
    name, table = table_of(random, (45, 80))
    for part in mixed(random, int(random.integers(14, 21)), BRIGHT, 0.5):
        table.add(part)
    return workshop(random, name, table), len(table.parts)


def _bent(random: Random, thick_m: float, albedo: float) -> list[Solid]:
    """A cable as pieces of 2 cm, each a little turned from the one before it."""
    turn, bend = yaw(random), drawn(random, -2, 2)
    at = random.uniform(-0.15, 0.15, 2) - 0.5 * towards(turn)
    pieces: list[Solid] = []
    for k in range(50):
        ahead = 0.02 * towards(turn)
        x, y = at + ahead / 2
        pieces.append(Cylinder(float(x), float(y), (thick_m, thick_m, 0.0205), turn, albedo, lying=True))
        at = at + ahead
        turn += bend * float(0.02 + 0.075 * np.sin(k / 6))
    return near(pieces)


def _squares(x_m: float, y_m: float, yaw_rad: float, square_m: float, thick_m: float) -> list[Solid]:
    """A chessboard of 8 x 6 squares with a margin as wide as they are, as boxes."""
    along, across = square_m * towards(yaw_rad), square_m * towards(yaw_rad + np.pi / 2)
    size = (square_m, square_m, thick_m)
    found: list[Solid] = []
    for column, row in np.ndindex(10, 8):
        is_black = 0 < column < 9 and 0 < row < 7 and (column + row) % 2
        x, y = (column - 4.5) * along + (row - 3.5) * across + (x_m, y_m)
        found.append(Box(float(x), float(y), size, yaw_rad, 0.06 if is_black else 0.8))
    return found


def _hand(random: Random, x_m: float, y_m: float, yaw_rad: float, albedo: float) -> list[Solid]:
    """Fingers and an arm of cylinders with round ends, and a back of the hand, some centimetres above the table."""
    low_m, ahead = drawn(random, 0.01, 0.06), towards(yaw_rad)
    found: list[Solid] = [Box(x_m, y_m, (0.09, 0.08, 0.03), yaw_rad, albedo, base_m=low_m)]
    for k in range(4):
        turn = yaw_rad + (k - 1.5) * 0.12
        root = (x_m, y_m) + 0.045 * ahead + (k - 1.5) * 0.02 * towards(yaw_rad + np.pi / 2)
        middle, tip = root + 0.035 * towards(turn), root + 0.07 * towards(turn)
        found += [
            Cylinder(*map(float, middle), (0.017, 0.017, 0.07), turn, albedo, lying=True, base_m=low_m),
            Sphere(*map(float, tip), (0.017,) * 3, albedo=albedo, base_m=low_m),
        ]
    for k in range(5):
        x, y = (x_m, y_m) - (0.095 + 0.1 * k) * ahead
        found.append(Cylinder(float(x), float(y), (0.06, 0.06, 0.1), yaw_rad, albedo, lying=True, base_m=low_m))
    return found
