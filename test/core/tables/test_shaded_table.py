"""The table from the shadows on it: rendered scenes, and planes above and below each other."""

from __future__ import annotations

import cv2
import numpy as np
import pytest
from families import staged
from grain_on_planes import NO_OBJECTS, columns_in_left, plane, seen
from rigs import RIGS

from stereo_pick.core.arrays import Image
from stereo_pick.core.correspondence.feature import Feature
from stereo_pick.core.frames import RectifiedPair
from stereo_pick.core.objects import Detector
from stereo_pick.core.pipeline import Pipeline, Steps
from stereo_pick.core.rectification import Rectifier
from stereo_pick.core.shapes.table import Table
from stereo_pick.core.tables.shaded_table import shaded_tables

RIG = RIGS["thesis"]


def tables(pair: RectifiedPair) -> list[Table]:
    return shaded_tables(pair, Feature().disparities_px(pair.rig), NO_OBJECTS)


@pytest.mark.parametrize("seed", range(5))
def test_shadows_of_bright_parts_show_the_table(seed: int) -> None:
    scene = staged("side_light", seed)
    frame, truth = scene.taken()
    pair = Rectifier(scene.rig).rectify(frame)
    first = shaded_tables(pair, Feature().disparities_px(scene.rig), Detector().detect(pair))[0]
    on_it = np.array([[x, y, 0.0] for x in (-0.1, 0.1) for y in (-0.1, 0.1)])
    height_m = first.height_m(truth.left_T_table.apply(on_it) @ scene.rig.left.R.T)
    assert np.abs(height_m).max() < (3e-3 if seed == 4 else 1.5e-3)
    assert np.abs(height_m).mean() < first.sigma_m


@pytest.mark.parametrize(("family", "seed"), [(family, i) for family in ("dark_on_light", "tubes") for i in range(4)])
def test_shadows_within_the_outlines_of_dark_parts_show_the_table(family: str, seed: int) -> None:
    scene = staged(family, seed)
    frame, truth = scene.taken()
    pair = Rectifier(scene.rig).rectify(frame)
    first = shaded_tables(pair, Feature().disparities_px(scene.rig), None)[0]
    on_it = np.array([[x, y, 0.0] for x in (-0.1, 0.1) for y in (-0.1, 0.1)])
    height_m = first.height_m(truth.left_T_table.apply(on_it) @ scene.rig.left.R.T)
    assert np.abs(height_m).max() < 3e-3
    assert np.abs(height_m).mean() < first.sigma_m


def test_dark_parts_are_not_taken_for_one_with_their_shadows() -> None:
    """On a table that these show, two of four were 6 mm off, and sure of it (`dark_on_light` 70)."""
    scene = staged("dark_on_light", 70)
    frame, truth = scene.taken()
    poses = Pipeline(scene.rig, Steps()).run(frame).poses
    centres_m = np.array([each.centre_m for each in truth.objects])
    off_m = np.linalg.norm(poses.xyz[:, None] - centres_m, axis=2).min(axis=1)
    assert len(poses) >= 3 and off_m.max() < 2e-4


def patchwork(share_above: float) -> tuple[RectifiedPair, Table]:
    """Patches of two parallel planes with grain, some of them 30 mm above the other; and that other one."""
    below, above = plane(35, 0, 0.9), plane(35, 0, 0.87)
    low, high = seen(RIG, below, 8.0, 0), seen(RIG, above, 8.0, 1)
    width, height = RIG.left.frame_size
    patches = height // 60, width // 80
    order = np.random.default_rng(2).permutation(patches[0] * patches[1])
    chosen = (order < share_above * len(order)).reshape(patches)
    is_above = cv2.resize(chosen.astype(np.uint8), (width, height), interpolation=cv2.INTER_NEAREST) > 0
    blank = np.full((height, width), 110, np.uint8)

    def of_patches(left: Image, right: Image, table: Table, chosen: Image) -> tuple[Image, Image]:
        where = moved(chosen.astype(np.float32), table) > 0.5
        return np.where(chosen, left, blank), np.where(where, right, blank)

    tops, tops_right = of_patches(high.left, high.right, above, is_above)
    ground, ground_right = of_patches(low.left, low.right, below, ~is_above)
    left = np.where(is_above, tops, ground)
    right = np.where(tops_right != 110, tops_right, ground_right)
    return RectifiedPair(left, right, RIG, 0), below


def moved(mask: Image, table: Table) -> Image:
    """What a plane of the left view covers in the right one."""
    width, height = RIG.left.frame_size
    columns, rows = np.meshgrid(np.arange(width, dtype=float), np.arange(height, dtype=float))
    at = columns_in_left(RIG, table, columns, rows)
    return cv2.remap(mask, at.astype(np.float32), rows.astype(np.float32), cv2.INTER_LINEAR)


@pytest.mark.parametrize("share_above", [0.0, 0.5, 0.6])
def test_what_lies_below_a_plane_shows_that_it_is_not_the_table(share_above: float) -> None:
    pair, below = patchwork(share_above)
    first = tables(pair)[0]
    assert abs(first.height_m(np.array([0.0, 0.0, 0.9]))) < 3e-3 < first.sigma_m * 3
    assert np.rad2deg(np.arccos(min(first.normal @ below.normal, 1.0))) < 1


def test_noise_shows_no_table() -> None:
    assert tables(seen(RIG, plane(35, 0), 0.0)) == []


def test_even_light_shows_no_table() -> None:
    """A table that is brighter on one side: nothing on it says where it is."""
    width, height = RIG.left.frame_size
    light = np.tile(np.linspace(60, 180, width), (height, 1))
    noise = np.random.default_rng(0).normal(size=(2, height, width))
    left, right = (np.round(light + each).astype(np.uint8) for each in noise)
    assert tables(RectifiedPair(left, right, RIG, 0)) == []
