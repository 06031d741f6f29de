"""Parts that do not stand on the table: on each other, on a plate, aslant."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from parts import box, cylinder, hex_prism, mixed, yaw
from placing import NoRoomError
from rendering import Box, Cylinder, Solid
from staging import BRIGHT, Random, table_of, with_mixed

from surroundings.common import TRIES, Surrounded, drawn, is_clear_of, place, towards, with_things


def stacked(random: Random) -> Surrounded:
    """A part on another, and three that stand alone."""
    name, table = table_of(random, (32, 75))
    lower = replace((box, cylinder, hex_prism)[random.integers(3)](random, drawn(random, *BRIGHT)), **table.somewhere())
    upper = replace(mixed(random, 1, BRIGHT, 0.6)[0], x_m=lower.x_m, y_m=lower.y_m, base_m=lower.height_m)
    wide_m = 1.3 * max(lower.size_m[:2])
    bound = Cylinder(lower.x_m, lower.y_m, (wide_m, wide_m, lower.height_m + upper.height_m))
    if not table.whole(bound):
        raise NoRoomError
    table.parts.append(bound)
    for part in mixed(random, 3, BRIGHT):
        table.add(part)
    del table.parts[0]
    return with_things(random, name, table, [lower, upper])


def platform(random: Random) -> Surrounded:
    """Three parts on the table, and two on a plate that lies on it."""
    name, table = with_mixed(random, count=3)
    raised, thick_m, albedo = mixed(random, 2, BRIGHT), drawn(random, 0.004, 0.02), drawn(random, 0.1, 0.5)
    for _ in range(TRIES):
        (x, y), turn = place(random, 0.2), yaw(random)
        plate, ahead = Box(x, y, (0.2, 0.12, thick_m), turn, albedo), 0.05 * towards(turn)
        on_it = [
            replace(part, x_m=x + float(side * ahead[0]), y_m=y + float(side * ahead[1]), base_m=thick_m)
            for side, part in zip((-1, 1), raised)
        ]
        is_whole = all(table.whole(each) for each in (plate, *on_it))
        if is_whole and is_clear_of(table, [plate], 0.01) and all(table.apart(part, 6) for part in on_it):
            return with_things(random, name, table, [plate, *on_it])
    raise NoRoomError


def terrace(random: Random) -> Surrounded:
    """Two tables side by side, one 3 to 10 cm higher, with three parts on the lower and two on the higher one."""
    name, table = with_mixed(random, count=3)
    raised, high_m, albedo = mixed(random, 2, BRIGHT), drawn(random, 0.03, 0.1), drawn(random, 0.12, 0.4)
    for _ in range(TRIES):
        turn = yaw(random)
        ahead, across = towards(turn), towards(turn + np.pi / 2)
        begins_m = drawn(random, 0.0, 0.15)
        step = Box(*map(float, (begins_m + 0.2) * ahead), (0.4, 0.8, high_m), turn, albedo)
        on_it = [
            replace(part, x_m=float(x), y_m=float(y), base_m=high_m)
            for part, (x, y) in zip(raised, ((begins_m + 0.06) * ahead + side * 0.05 * across for side in (-1, 1)))
        ]
        if is_clear_of(table, [step], 0.01) and all(table.whole(part) and table.apart(part, 6) for part in on_it):
            return with_things(random, name, table, [step, *on_it])
    raise NoRoomError


def propped(random: Random) -> Surrounded:
    """Three parts that stand, and two that lie on a chip or a wire: 3 to 15 degrees out of level."""
    name, table = with_mixed(random, count=3)
    slanted = [_tilted(table.add(part), drawn(random, 3, 15)) for part in mixed(random, 2, BRIGHT)]
    table.parts = table.parts[:3]
    return with_things(random, name, table, slanted)


def leaning(random: Random) -> Surrounded:
    """Three parts that stand, and a bar that leans against one of them."""
    name, table = with_mixed(random, count=3)
    turn, thick_m, long_m = yaw(random), drawn(random, 0.01, 0.02), drawn(random, 0.07, 0.11)
    block = box(random, drawn(random, *BRIGHT))
    slope_rad = drawn(random, np.arcsin(min(0.95, block.height_m / long_m)), 1.2)
    for _ in range(TRIES):
        block = replace(block, **table.somewhere(), yaw_rad=turn)
        from_m = block.size_m[0] / 2 + block.height_m / np.tan(slope_rad)
        middle_m = long_m / 2 * np.cos(slope_rad) - thick_m / 2 * np.sin(slope_rad) - from_m
        x, y = (block.x_m, block.y_m) + middle_m * towards(turn)
        bar = Box(float(x), float(y), (long_m, 1.5 * thick_m, thick_m), turn, drawn(random, *BRIGHT))
        bar = _tilted(bar, -np.degrees(slope_rad))
        if all(table.whole(each) and table.apart(each, 6) for each in (block, bar)):
            return with_things(random, name, table, [block, bar])
    raise NoRoomError


def _tilted(part: Solid, tilt_deg: float) -> Solid:
    """The same, turned about its level axis, its lowest point on the table."""
    tilted = replace(part, tilt_rad=float(np.radians(tilt_deg)))
    return replace(tilted, base_m=-float(tilted.hull_m()[:, 2].min()))
