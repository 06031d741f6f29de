"""Rigs drawn at random, and the scenes before them."""

from __future__ import annotations

import numpy as np
from drawn_rigs import drawn_rig
from evaluate_rigs import scored
from rendering.rigs import BENCH_RIGS, DISTANCES_M


def test_a_seed_draws_one_rig_and_another_one_another() -> None:
    one, same, other = drawn_rig("tubes", 3).rig, drawn_rig("tubes", 3).rig, drawn_rig("tubes", 4).rig
    np.testing.assert_array_equal(one.right.P, same.right.P)
    assert not np.array_equal(one.right.P, other.right.P)


def test_the_table_is_where_both_cameras_see_it() -> None:
    for seed in range(40):
        drawn = drawn_rig("mixed_shapes", seed)
        middle = np.array([[0.0, 0.0, np.mean(drawn.distances_m)]])
        for camera, (pixel,) in zip((drawn.rig.left, drawn.rig.right), drawn.rig.project(middle)):
            assert (pixel > 0).all() and (pixel < camera.frame_size).all()


def test_a_scene_is_before_its_own_rig_and_the_benchmark_s_rigs_stay() -> None:
    before = dict(BENCH_RIGS), dict(DISTANCES_M)
    drawn, found = scored(None, ("four_cylinders", 1))
    assert drawn.rig not in before[0].values()
    assert found.required == 4 and not found.missed and not len(found.ghosts_m)
    assert (dict(BENCH_RIGS), dict(DISTANCES_M)) == before
