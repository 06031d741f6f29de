"""The table as a plane that touches solids."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from rigs import RIGS, rotation
from solid_outlines import any_part

from stereo_pick.core.arrays import Floats
from stereo_pick.core.errors import ArrayError
from stereo_pick.core.shapes.kinds import KINDS
from stereo_pick.core.shapes.solids import Solids
from stereo_pick.core.shapes.table import Table

TABLE = Table(rotation((np.deg2rad(130), 0.1, 0)) @ (0, 0, 1), 0.61, 5e-4)
STEP = 1e-6


def any_solids(kind: str, seed: int) -> Solids:
    part = any_part(kind, RIGS["verged"], np.random.default_rng(seed))
    found = Solids(KINDS[kind], part.centre_m[None], part.rotation[None], part.half_m[None], np.zeros((1, 3, 0)))
    return found.turning_freely()


def lowest_m(solids: Solids) -> float:
    """Of many points on the surface."""
    directions = np.random.default_rng(0).normal(size=(1, 20000, 3))
    directions = np.concatenate([directions, (-TABLE.normal @ solids.rotation)[:, None]], axis=1)
    points = solids.kind.touch(directions, solids.half_m)[0] @ solids.rotation[0].T + solids.centre_m[0]
    return float(TABLE.height_m(points).min())


@given(st.sampled_from(list(KINDS)), st.integers(0, 10**6))
def test_the_lowest_point_is_the_lowest_of_all(kind: str, seed: int) -> None:
    solids = any_solids(kind, seed)
    np.testing.assert_allclose(TABLE.under(solids)[0], lowest_m(solids), atol=1e-9)


@given(st.sampled_from(list(KINDS)), st.integers(0, 10**6))
def test_derivatives_are_those_of_the_height(kind: str, seed: int) -> None:
    solids = any_solids(kind, seed)
    height_m, gradient = TABLE.under(solids)
    turning = solids.turns.shape[2]
    steps = np.eye(gradient.shape[1]) * STEP
    moved = [stepped(solids, each[:3], each[3 : 3 + turning], each[3 + turning :]) for each in steps]
    slopes = [(TABLE.under(each)[0] - height_m)[0] / STEP for each in moved]
    np.testing.assert_allclose(gradient[0], slopes, atol=1e-4)


def stepped(solids: Solids, centre_m: Floats, turns: Floats, half_m: Floats) -> Solids:
    turned = solids.rotation @ rotation(tuple(solids.turns[0] @ turns)) if len(turns) else solids.rotation
    return replace(solids, centre_m=solids.centre_m + centre_m, rotation=turned, half_m=solids.half_m + half_m)


@given(st.sampled_from(list(KINDS)), st.integers(0, 10**6))
def test_what_is_put_down_touches_and_moves_along_the_normal(kind: str, seed: int) -> None:
    solids = any_solids(kind, seed)
    down = TABLE.put_down(solids)
    np.testing.assert_allclose(TABLE.under(down)[0], 0, atol=1e-12)
    np.testing.assert_allclose(np.cross(down.centre_m - solids.centre_m, TABLE.normal), 0, atol=1e-12)


def test_a_table_is_read_as_it_is_written() -> None:
    table = Table.parsed("0.0 -0.6, -0.8 0.75")
    np.testing.assert_allclose(table.normal, (0, -0.6, -0.8))
    np.testing.assert_allclose(table.height_m(np.array([0, 0, 0.5])), 0.35)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "four numbers"),
        ("0 -0.6 -0.8", "four numbers"),
        ("0 -0.6 -0.8 x", "four numbers"),
        ("0 -0.6 -0.8 nan", "four numbers"),
        ("0 -0.6 -0.6 0.7", "unit normal"),
        ("0 0.6 0.8 0.75", "towards the cameras"),
        ("0 -0.6 -0.8 -0.75", "towards the cameras"),
        ("0 -0.6 -0.8 750", "750 m from the camera: give the offset in metres"),
        ("0 -1 -0.0001 0.5", "edge-on: the normal's z is -0.0001"),
    ],
)
def test_what_is_no_table_in_front_of_the_cameras_is_refused(text: str, said: str) -> None:
    with pytest.raises(ArrayError, match=said):
        Table.parsed(text)
