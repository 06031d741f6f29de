"""How solids touch a table, against what moving them, or the table, changes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from rigs import rotation
from solids_on_table import LYING, MIDDLE_M, MIXED, NUTS, UPRIGHT, Standing, part_on_table, table_of

from stereo_pick.core.arrays import Floats
from stereo_pick.core.edges.flush import Touching, touching
from stereo_pick.core.shapes.kinds import KINDS
from stereo_pick.core.shapes.refinement import moved
from stereo_pick.core.shapes.solids import Solids
from stereo_pick.core.shapes.table import Table

TILT_DEG = 40.0
TABLE = table_of(TILT_DEG)
ACROSS = np.linalg.svd(TABLE.normal[None])[2][1:]
EVERY = (*MIXED, *LYING, *NUTS, *UPRIGHT)
LEAST = np.array([1e-4])


def solid_of(standing: Standing, lifted_m: float = 0.0) -> Solids:
    part = part_on_table(TILT_DEG, standing, lifted_m)
    kind = KINDS[part.kind]
    solid = Solids(kind, part.centre_m[None], part.rotation[None], part.half_m[None], np.zeros((1, 3, 0)))
    return solid.turning_freely()


def touch(solid: Solids, table: Table = TABLE) -> Touching:
    return touching(solid, table, ACROSS, MIDDLE_M)


def tilted(step: Floats) -> Table:
    """The table tilted [rad] towards two directions, and lifted [m], at MIDDLE_M."""
    normal = TABLE.normal + step[:2] @ ACROSS
    offset_m = (TABLE.normal - normal) @ MIDDLE_M + TABLE.offset_m + step[2]
    length = float(np.linalg.norm(normal))
    return Table(normal / length, float(offset_m) / length, TABLE.sigma_m)


@pytest.mark.parametrize("standing", EVERY)
def test_what_stands_or_lies_on_the_table_is_off_by_nothing(standing: Standing) -> None:
    np.testing.assert_allclose(touch(solid_of(standing)).off, 0.0, atol=1e-6)


@pytest.mark.parametrize("standing", EVERY)
def test_what_is_lifted_is_off_by_that_alone(standing: Standing) -> None:
    one, two = (touch(solid_of(standing, lifted_m)).off[0] for lifted_m in (1e-3, 2e-3))
    assert one[0] > 0 and two[0] == pytest.approx(2 * one[0])
    np.testing.assert_allclose([*one[1:], *two[1:]], 0.0, atol=1e-6)


@pytest.mark.parametrize("standing", EVERY)
@given(seed=st.integers(0, 2**31))
def test_the_derivatives_are_what_small_steps_change(standing: Standing, seed: int) -> None:
    random = np.random.default_rng(seed)
    turn = rotation(tuple(np.deg2rad(random.uniform(-1, 1, 3))))
    solid = solid_of(standing)
    solid = replace(solid, rotation=turn @ solid.rotation, centre_m=solid.centre_m + random.normal(scale=1e-3, size=3))
    before, step = touch(solid), random.normal(size=(1, touch(solid).by_solid.shape[2]))
    small = 1e-7
    after = touch(moved(solid, small * step, LEAST)).off
    scale = np.abs(before.by_solid).max() * np.abs(step).max()
    np.testing.assert_allclose((after - before.off) / small, before.by_solid @ step[0], atol=1e-3 * scale)
    tilt = random.normal(size=3) * (1.0, 1.0, 0.1)
    after = touch(solid, tilted(small * tilt)).off
    scale = np.abs(before.by_table).max() * np.abs(tilt).max()
    np.testing.assert_allclose((after - before.off) / small, before.by_table @ tilt, atol=1e-3 * scale)
