"""Families of scenes: from a seed a rig, a scene and two sensors; no scene depends on another's seed."""

from __future__ import annotations

import zlib
from collections.abc import Callable
from dataclasses import replace

import numpy as np
from parts import cylinder, footprint, mixed, tube, yaw
from placing import NoRoomError, footprint_gap_m, shifted
from rendering import Edge, Label, lamp_at
from staging import BRIGHT, Random, Staged, covered, keep, patterns, table_of, with_mixed, workshop

_SCENE_TRIES = 60

Family = Callable[[Random], Staged]


def staged(family: str, seed: int) -> Staged:
    """Scene `seed` of a family."""
    random = np.random.default_rng([zlib.crc32(family.encode()), seed])
    for _ in range(_SCENE_TRIES):
        try:
            return FAMILIES[family](random)
        except NoRoomError:
            continue
    raise RuntimeError(f"{family} {seed}: the parts find no room")


def two_cylinders(random: Random) -> Staged:
    """Identical, their depths differing by 35 to 240 mm, as in the thesis's table 3.14."""
    name, table = table_of(random, (30, 45), "thesis")
    part = cylinder(random, float(random.uniform(*BRIGHT)))
    first = table.add(part)
    slope = table.left_T_table.rotation[2, :2]
    depth_m = random.uniform(0.035, 0.24) * random.choice((-1, 1))
    along = depth_m * slope / (slope @ slope) + random.uniform(-0.2, 0.2) * np.array([-slope[1], slope[0]])
    second = replace(part, x_m=first.x_m + float(along[0]), y_m=first.y_m + float(along[1]))
    keep(table, second)
    return workshop(random, name, table)


def four_cylinders(random: Random) -> Staged:
    """Identical, anywhere."""
    name, table = table_of(random, (30, 60), "thesis")
    part = cylinder(random, float(random.uniform(*BRIGHT)))
    for _ in range(4):
        table.add(part)
    return workshop(random, name, table)


def mixed_shapes(random: Random) -> Staged:
    """Four to six boxes, hexagonal prisms, balls, and cylinders standing and lying."""
    return workshop(random, *with_mixed(random))


def light_differences(random: Random) -> Staged:
    """The right camera darker, with an offset; gradients that differ between the cameras."""
    scene = workshop(random, *with_mixed(random))
    gradients = random.uniform(-0.3, 0.3, (2, 2))
    left = replace(scene.left, gradient=tuple(gradients[0]))
    right = replace(scene.right, gain=0.6, offset_dn=20.0, gradient=tuple(gradients[1]))
    return replace(scene, left=left, right=right)


def low_contrast(random: Random) -> Staged:
    """Grey parts on a little darker table."""
    table_albedo = float(random.uniform(0.3, 0.45))
    name, table = with_mixed(random, albedos=(table_albedo * 1.35, table_albedo * 1.8))
    ambient, sky = float(random.uniform(0.6, 0.75)), float(random.uniform(0, 0.6))
    return workshop(random, name, table, table_albedo=table_albedo, ambient=ambient, sky=sky)


def elevation_30_to_90(random: Random) -> Staged:
    """From a low camera to one overhead."""
    return workshop(random, *with_mixed(random, elevation_deg=(30, 90)))


def side_light(random: Random) -> Staged:
    """A low lamp: long shadows, and sides darker than the table."""
    lamp = lamp_at(random.uniform(14, 30), random.uniform(0, 360), 1.5, 1.5, random.uniform(0.01, 0.08))
    name, table = with_mixed(random)
    return workshop(random, name, table, lamps=(lamp,), ambient=float(random.uniform(0.25, 0.45)))


def touching(random: Random) -> Staged:
    """Two parts whose images are 0 to 3 pixels apart in one view or in both, or which are in contact; and a third."""
    name, table = table_of(random, (32, 70))
    kinds = mixed(random, 2, BRIGHT) if random.random() < 0.4 else [cylinder(random, 0.7)] * 2
    first, direction, gap_px = table.add(kinds[0]), yaw(random), float(random.uniform(0, 3))
    mode = random.integers(3)
    wanted = (
        lambda part: footprint_gap_m(part, first) - 0.0001,
        lambda part: min(table.gaps_px(part, first)) - gap_px,
        lambda part: max(table.gaps_px(part, first)) - gap_px,
    )[mode]
    second = table.beside(kinds[1], first, direction, wanted)
    if not table.whole(second) or footprint_gap_m(second, first) < 0 or min(covered(table, first, second)) > 0.2:
        raise NoRoomError
    table.parts.append(second)
    table.add(cylinder(random, 0.7), gap_px=10)
    return workshop(random, name, table)


def occluded(random: Random) -> Staged:
    """One part hides a part of another in one view and none of it in the other; two more stand apart."""
    name, table = table_of(random, (30, 50))
    hidden, hider = mixed(random, 2, BRIGHT)
    hidden = table.add(hidden)
    for _ in range(200):
        placed = shifted(hider, hidden, yaw(random), random.uniform(0.04, 0.15))
        if not table.whole(placed) or footprint_gap_m(placed, hidden) < 0.003:
            continue
        one, other = sorted(zip(covered(table, hidden, placed), table.gaps_px(hidden, placed)))
        if one[1] > 4 and 0.05 < other[0] < 0.5:
            table.parts.append(placed)
            break
    else:
        raise NoRoomError
    for part in mixed(random, 2, BRIGHT):
        table.add(part)
    return workshop(random, name, table)


def many_small(random: Random) -> Staged:
    """Twenty of half the size."""
    return workshop(random, *with_mixed(random, count=20, scale=0.5, gap_px=4.0, elevation_deg=(40, 75)))


def dark_on_light(random: Random) -> Staged:
    """Dark parts on light paper."""
    name, table = with_mixed(random, albedos=(0.05, 0.25))
    return workshop(random, name, table, table_albedo=float(random.uniform(0.65, 0.85)))


def bright_and_dark(random: Random) -> Staged:
    """Bright and dark parts on a grey table."""
    name, table = table_of(random, (32, 75))
    for part in [*mixed(random, 3, (0.04, 0.12)), *mixed(random, 3, (0.65, 0.9))]:
        table.add(part)
    return workshop(random, name, table, table_albedo=float(random.uniform(0.25, 0.4)))


def glossy(random: Random) -> Staged:
    """Metal: high lights and reflections of the room."""
    name, table = with_mixed(random, albedos=(0.25, 0.5), gloss=float(random.uniform(0.3, 0.7)))
    return workshop(random, name, table, table_gloss=float(random.uniform(0, 0.1)))


def planks_and_prints(random: Random) -> Staged:
    """A table of planks, with printed cartons lying on it."""
    name, table = with_mixed(random, albedos=(0.55, 0.9))
    return workshop(random, name, table, table_albedo=float(random.uniform(0.2, 0.35)), paints=patterns(random))


def table_edge(random: Random) -> Staged:
    """The table ends within the image."""
    name, table = with_mixed(random, count=4)
    direction = yaw(random)
    ahead = np.array([np.cos(direction), np.sin(direction)])
    reach = max(float((part.hull_m()[:, :2] @ ahead).max()) for part in table.parts)
    beyond = float(random.choice((random.uniform(0.03, 0.1), random.uniform(0.35, 0.6))))
    return workshop(random, name, table, paints=(Edge(reach + 0.015, direction, beyond),))


def textured_parts(random: Random) -> Staged:
    """Parts with a pattern of their own."""
    return workshop(random, *with_mixed(random, albedos=(0.5, 0.65), texture=float(random.uniform(0.15, 0.4))))


def tubes(random: Random) -> Staged:
    """Black tubes on white paper, most of them lying."""
    name, table = table_of(random, (40, 75))
    for _ in range(4):
        table.add(tube(random, float(random.uniform(0.04, 0.12))))
    return workshop(random, name, table, table_albedo=float(random.uniform(0.6, 0.8)))


def labels(random: Random) -> Staged:
    """One to five labels, round or square, on a plain table or on planks, and up to two parts beside them."""
    name, table = table_of(random, (30, 90))
    for part in mixed(random, 5, BRIGHT)[: random.integers(3)]:
        table.add(part)
    count, albedo = len(table.parts), float(random.uniform(0.4, 0.8))
    for _ in range(random.integers(1, 6)):
        table.add(footprint(random, albedo))
    sheets = tuple(
        Label(each.x_m, each.y_m, *each.size_m[:2], each.yaw_rad, each.albedo, is_round=bool(random.random() < 0.5))
        for each in table.parts[count:]
    )
    del table.parts[count:]
    planks = patterns(random)[:1] if random.random() < 0.4 else ()
    return workshop(random, name, table, paints=planks + sheets)


def empty(random: Random) -> Staged:
    """Nothing on the table, which may be plain, patterned, or end within the image."""
    name, table = table_of(random, (30, 90))
    edge = (Edge(float(random.uniform(0.05, 0.2)), yaw(random), float(random.uniform(0.03, 0.6))),)
    paints = ((), (), patterns(random), edge)[random.integers(4)]
    return workshop(random, name, table, table_albedo=float(random.uniform(0.1, 0.7)), paints=paints)


FAMILIES: dict[str, Family] = {
    family.__name__: family
    for family in (
        two_cylinders, four_cylinders, mixed_shapes, light_differences, low_contrast, elevation_30_to_90, side_light,
        touching, occluded, many_small, dark_on_light, bright_and_dark, glossy, planks_and_prints, table_edge,
        textured_parts, tubes, labels, empty,
    )
}  # fmt: skip
