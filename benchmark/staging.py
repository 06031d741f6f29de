"""What families of scenes share: a rig and its table, parts in their places, a workshop's light, two cameras."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from parts import mixed, yaw
from placing import NoRoomError, Table, overlap
from rendering import Carton, Lamp, Paint, Planks, Scene, Sensor, Solid, Truth, lamp_at, render_with_truth
from rendering.rigs import BENCH_RIGS, DISTANCES_M, table_before

from stereo_pick.core.frames import StereoFrame
from stereo_pick.core.rig import StereoRig

Random = np.random.Generator
BRIGHT = (0.5, 0.85)


@dataclass(frozen=True)
class Staged:
    """All that makes one stereo pair."""

    rig_name: str
    scene: Scene
    left: Sensor
    right: Sensor
    noise_seed: int

    @property
    def rig(self) -> StereoRig:
        return BENCH_RIGS[self.rig_name]

    def taken(self) -> tuple[StereoFrame, Truth]:
        """The raw pair and its truth."""
        return render_with_truth(self.rig, self.scene, self.left, self.right, self.noise_seed)


def table_of(random: Random, elevation_deg: tuple[float, float], rig_name: str = "") -> tuple[str, Table]:
    name = rig_name or str(random.choice(list(BENCH_RIGS), p=(0.5, 0.25, 0.25)))
    placed = table_before(
        BENCH_RIGS[name],
        float(random.uniform(*DISTANCES_M[name])),
        float(random.uniform(*elevation_deg)),
        float(random.uniform(-30, 30)),
    )
    return name, Table(BENCH_RIGS[name], placed, random)


def with_mixed(
    random: Random,
    count: int = 0,
    albedos: tuple[float, float] = BRIGHT,
    elevation_deg: tuple[float, float] = (32, 75),
    gap_px: float = 6.0,
    **look: float,
) -> tuple[str, Table]:
    name, table = table_of(random, elevation_deg)
    for part in mixed(random, count or int(random.integers(4, 7)), albedos, **look):
        table.add(part, gap_px)
    return name, table


def workshop(random: Random, rig_name: str, table: Table, **of_scene: Any) -> Staged:
    """What the table shows in the light of a workshop, unless told otherwise, to two cameras of one make."""
    lamp: Lamp = lamp_at(
        random.uniform(40, 80), random.uniform(0, 360), 1.0, random.uniform(1.2, 3), random.uniform(0.05, 0.25)
    )
    scene = Scene(
        tuple(table.parts),
        table.left_T_table,
        **{
            "table_albedo": float(random.uniform(0.12, 0.26)),
            "lamps": (lamp,),
            "ambient": float(random.uniform(0.4, 0.65)),
            "sky": float(random.uniform(0.5, 1.0)),
            "shadows": True,
            **of_scene,
        },
    )
    brightest = max([scene.table_albedo, *(part.albedo * (1 + part.texture) for part in scene.solids)])
    exposure = float(random.uniform(0.75, 0.92)) / max(brightest, 0.5)
    left, right = (
        Sensor(
            gain=exposure * float(random.uniform(0.96, 1.04)),
            offset_dn=3.0,
            blur_px=float(random.uniform(0.55, 0.8)),
            noise_dn=0.6,
            photon_dn=2.2,
            vignetting=0.1,
        )
        for _ in range(2)
    )
    return Staged(rig_name, scene, left, right, int(random.integers(2**31)))


def patterns(random: Random) -> tuple[Paint, ...]:
    planks = Planks(
        width_m=float(random.uniform(0.06, 0.14)),
        joint_m=float(random.uniform(0.001, 0.004)),
        direction_rad=yaw(random),
        contrast=float(random.uniform(0.04, 0.12)),
        seed=int(random.integers(1000)),
    )
    cartons = tuple(
        Carton(
            *random.uniform(-0.2, 0.2, 2),
            *random.uniform(0.05, 0.16, 2),
            yaw_rad=yaw(random),
            albedo=float(random.uniform(0.3, 0.7)),
            ink=float(random.uniform(0.3, 0.7)),
        )
        for _ in range(random.integers(1, 4))
    )
    return (planks, *cartons)


def keep(table: Table, part: Solid, gap_px: float = 6.0) -> None:
    if not table.whole(part) or not table.apart(part, gap_px):
        raise NoRoomError
    table.parts.append(part)


def covered(table: Table, one: Solid, other: Solid) -> Sequence[float]:
    """The share of one part that the other's outline covers in the left and in the right image."""
    return [overlap(a, b) for a, b in zip(table.outlines(one), table.outlines(other))]
