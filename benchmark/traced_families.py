"""Families of path-traced scenes: each has cameras of its own, parts of materials that reflect, and a room's light."""

from __future__ import annotations

import zlib
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from parts import MIXED, cylinder, mixed, tube, yaw
from path_tracing import Look, Room, Surface, Traced
from path_tracing.looks import Kind, speckled
from placing import NoRoomError, Table, footprint_gap_m
from rendering import Lamp, Sensor, Solid, lamp_at
from rendering.rigs import camera, looking_at, table_before

from stereo_pick.core.camera import Camera
from stereo_pick.core.rig import StereoRig

Random = np.random.Generator

_SCENE_TRIES = 60
_SIZES_PX = ((640, 480), (800, 600), (1024, 768), (960, 540))
_PLAIN: tuple[Kind, ...] = ("matte", "plastic", "lacquer")


@dataclass
class Staging:
    """What a family fills: a table before a rig, and what its parts are made of."""

    table: Table
    looks: list[Look]

    def add(self, part: Solid, surface: Surface, gap_px: float = 6.0) -> Solid:
        """Put the part where it finds room; raises NoRoomError."""
        placed = self.table.add(part, gap_px)
        self.look(surface)
        return placed

    def look(self, surface: Surface) -> None:
        """What the last part is made of; its edges are rounded as machined ones are."""
        self.looks.append(Look(surface, float(self.table.random.uniform(0.0002, 0.0012))))


Filling = Callable[[Random, Staging], Room]


def traced(family: str, seed: int) -> Traced:
    """Scene `seed` of a family."""
    random = np.random.default_rng([zlib.crc32(f"traced {family}".encode()), seed])
    for _ in range(_SCENE_TRIES):
        try:
            return _traced(random, TRACED[family])
        except NoRoomError:
            continue
    raise RuntimeError(f"{family} {seed}: the parts find no room")


def plain(random: Random, staging: Staging) -> Room:
    """Three to six parts, matte, of plastic or lacquered, on a plain darker table."""
    for part in mixed(random, int(random.integers(3, 7)), (0.45, 0.85)):
        staging.add(part, _of(random, _PLAIN, (0.45, 0.85)))
    return _room(random, (0.08, 0.25))


def crowd(random: Random, staging: Staging) -> Room:
    """Twelve parts close together, some hiding others."""
    for part in mixed(random, 12, (0.4, 0.85), scale=0.7):
        staging.add(part, _of(random, _PLAIN, (0.4, 0.85)), gap_px=1.0)
    return _room(random, (0.08, 0.25))


def grey(random: Random, staging: Staging) -> Room:
    """Parts little brighter or little darker than their table."""
    table = float(random.uniform(0.3, 0.5))
    for part in mixed(random, 5, (0.5, 0.5)):
        albedo = table * float(random.choice((random.uniform(0.5, 0.75), random.uniform(1.35, 1.8))))
        staging.add(part, _of(random, _PLAIN, (albedo, albedo)))
    return _room(random, (table, table))


def dark(random: Random, staging: Staging) -> Room:
    """Dark parts on a light table."""
    for part in mixed(random, 5, (0.04, 0.2)):
        staging.add(part, _of(random, _PLAIN, (0.04, 0.2)))
    return _room(random, (0.55, 0.8))


def black_tubes(random: Random, staging: Staging) -> Room:
    """Black tubes on light paper."""
    for _ in range(4):
        staging.add(tube(random, 0.05), _of(random, ("matte", "plastic"), (0.03, 0.1)))
    return _room(random, (0.6, 0.85))


def metal(random: Random, staging: Staging) -> Room:
    """Brushed metal that mirrors the room and its neighbours."""
    for part in mixed(random, 4, (0.7, 0.7)):
        staging.add(part, Surface("metal", float(random.uniform(0.5, 0.8)), float(random.uniform(0.15, 0.4))))
    return _room(random, (0.06, 0.2))


def stone(random: Random, staging: Staging) -> Room:
    """A table with grain."""
    for part in mixed(random, 5, (0.5, 0.85)):
        staging.add(part, _of(random, _PLAIN, (0.5, 0.85)))
    room = _room(random, (0.15, 0.3))
    contrast, grain_m = float(random.uniform(0.05, 0.2)), float(random.uniform(0.001, 0.006))
    picture = speckled(random, room.table.albedo, contrast, grain_m, room.table_m / 2)
    return Room(room.table, room.lamp, room.walls, picture, room.table_m / 2)


def polished(random: Random, staging: Staging) -> Room:
    """A lacquered table that mirrors what stands on it."""
    for part in mixed(random, 5, (0.45, 0.85)):
        staging.add(part, _of(random, _PLAIN, (0.45, 0.85)))
    room = _room(random, (0.05, 0.2))
    return Room(Surface("lacquer", room.table.albedo), room.lamp, room.walls)


def hard(random: Random, staging: Staging) -> Room:
    """One low lamp and a dark room."""
    for part in mixed(random, 5, (0.5, 0.85)):
        staging.add(part, _of(random, _PLAIN, (0.5, 0.85)))
    lamp = _lamp(random, (20, 45), 1.2, (0.01, 0.05))
    return Room(_of(random, ("matte", "plastic"), (0.1, 0.25)), lamp, float(random.uniform(0.08, 0.2)))


def contact(random: Random, staging: Staging) -> Room:
    """Two parts in contact or within a millimetre, and two that stand apart."""
    table = staging.table
    first = staging.add(cylinder(random, 0.7), _of(random, _PLAIN, (0.5, 0.85)))
    part, gap_m = MIXED[random.integers(len(MIXED))](random, 0.7), float(random.choice((0.0, 0.001)))
    second = table.beside(part, first, yaw(random), lambda moved: footprint_gap_m(moved, first) - gap_m - 0.0001)
    if not table.whole(second):
        raise NoRoomError
    table.parts.append(second)
    staging.look(_of(random, _PLAIN, (0.5, 0.85)))
    for part in mixed(random, 2, (0.5, 0.85)):
        staging.add(part, _of(random, _PLAIN, (0.5, 0.85)), gap_px=10)
    return _room(random, (0.08, 0.25))


TRACED: dict[str, Filling] = {
    family.__name__: family for family in (plain, crowd, grey, dark, black_tubes, metal, stone, polished, hard, contact)
}


def _traced(random: Random, fill: Filling) -> Traced:
    rig, px_per_m = _cameras(random)
    distance_m = rig.left.K[0, 0] / px_per_m
    elevation_deg, turn_deg = float(random.uniform(35, 80)), float(random.uniform(-40, 40))
    table = Table(rig, table_before(rig, distance_m, elevation_deg, turn_deg), random)
    staging = Staging(table, [])
    room = fill(random, staging)
    left, right = (_sensor(random) for _ in range(2))
    white, seed = float(random.uniform(0.7, 0.95)), int(random.integers(2**20))
    return Traced(rig, table.left_T_table, tuple(table.parts), tuple(staging.looks), room, left, right, white, seed)


def _cameras(random: Random) -> tuple[StereoRig, float]:
    """Two cameras of one make, parallel or verged, and how many pixels a metre of the table shall be."""
    width_px, height_px = _SIZES_PX[random.integers(len(_SIZES_PX))]
    focal_px, px_per_m = width_px * float(random.uniform(0.8, 1.8)), width_px * float(random.uniform(1.3, 2.0))
    distance_m = focal_px / px_per_m
    baseline_m = distance_m * float(random.uniform(0.12, 0.3))
    left, right = (_camera(random, name, focal_px, (width_px, height_px)) for name in ("left", "right"))
    centre = (baseline_m, *(float(each) for each in baseline_m * random.uniform(-0.05, 0.05, 2)))
    aim_m = distance_m if random.random() < 0.6 else 100.0
    target = (
        0.0 if aim_m == distance_m else baseline_m,
        *(float(each) for each in aim_m * random.uniform(-0.01, 0.01, 1)),
        aim_m,
    )
    return StereoRig.from_extrinsics(
        left, right, looking_at(centre, target, float(random.uniform(-1.5, 1.5)))
    ), px_per_m


def _camera(random: Random, name: str, focal_px: float, size_px: tuple[int, int]) -> Camera:
    focal = focal_px * float(random.uniform(0.99, 1.01))
    centre = ((size_px[0] - 1) / 2 + random.uniform(-15, 15), (size_px[1] - 1) / 2 + random.uniform(-15, 15))
    wide = size_px[0] / focal_px  # short lenses distort more
    D = (
        *(float(each) for each in random.uniform((-0.25, -0.05), (0.02, 0.1)) * min(wide, 1.0)),
        *(float(each) for each in random.uniform(-0.001, 0.001, 2)),
        0.0,
    )
    return camera(name, (focal, focal * float(random.uniform(0.998, 1.002))), centre, D, size_px=size_px)


def _of(random: Random, kinds: Sequence[Kind], albedos: tuple[float, float]) -> Surface:
    return Surface(
        kinds[random.integers(len(kinds))], float(random.uniform(*albedos)), float(random.uniform(0.15, 0.4))
    )


def _lamp(random: Random, elevation_deg: tuple[float, float], strength: float, radius_m: tuple[float, float]) -> Lamp:
    return lamp_at(
        random.uniform(*elevation_deg),
        random.uniform(0, 360),
        strength,
        random.uniform(1.2, 2.5),
        random.uniform(*radius_m),
    )


def _room(random: Random, albedos: tuple[float, float]) -> Room:
    """A large lamp above, and walls that give back a part of its light."""
    lamp = _lamp(random, (40, 80), float(random.uniform(0.4, 1.0)), (0.05, 0.4))
    return Room(_of(random, ("matte", "plastic"), albedos), lamp, float(random.uniform(0.2, 0.5)))


def _sensor(random: Random) -> Sensor:
    return Sensor(
        gain=float(random.uniform(0.93, 1.07)),
        offset_dn=float(random.uniform(1, 5)),
        blur_px=float(random.uniform(0.5, 0.9)),
        noise_dn=float(random.uniform(0.5, 1.2)),
        photon_dn=float(random.uniform(1.0, 2.5)),
        vignetting=float(random.uniform(0.05, 0.3)),
    )
