"""The table from its grain: exact planes, seen by two cameras."""

from __future__ import annotations

import numpy as np
import pytest
from families import staged
from grain_on_planes import NO_OBJECTS, plane, seen
from rigs import RIGS

from stereo_pick.core.correspondence.feature import Feature
from stereo_pick.core.frames import RectifiedPair
from stereo_pick.core.objects import Blob, Blobs, Detector
from stereo_pick.core.rectification import Rectifier
from stereo_pick.core.rig import StereoRig
from stereo_pick.core.tables.grain import grained_table


@pytest.mark.parametrize("rig", RIGS.values(), ids=RIGS)
@pytest.mark.parametrize(("tilt_deg", "turn_deg"), [(0, 0), (35, 0), (50, 10)])
def test_the_plane_is_found_as_well_as_it_says(rig: StereoRig, tilt_deg: float, turn_deg: float) -> None:
    truth = plane(tilt_deg, turn_deg)
    found = grained_table(seen(rig, truth, 8.0), NO_OBJECTS, Feature().disparities_px(rig))
    assert found is not None
    assert np.rad2deg(np.arccos(min(found.normal @ truth.normal, 1.0))) < 0.3
    on_it = np.array([0.0, 0.0, 0.9])
    assert abs(found.height_m(on_it)) < 3 * found.sigma_m < 6e-3


def test_a_rendered_table_of_planks_is_found_among_its_parts() -> None:
    scene = staged("planks_and_prints", 11)
    frame, truth = scene.taken()
    pair = Rectifier(scene.rig).rectify(frame)
    found = grained_table(pair, Detector().detect(pair), Feature().disparities_px(scene.rig))
    assert found is not None
    placed = truth.left_T_table
    on_it = placed.apply(np.array([[x, y, 0.0] for x in (-0.2, 0.2) for y in (-0.2, 0.2)])) @ scene.rig.left.R.T
    assert np.abs(found.height_m(on_it)).max() < 1e-3


def test_noise_is_no_grain() -> None:
    rig = RIGS["thesis"]
    pair = seen(rig, plane(35, 0), 0.0)
    assert grained_table(pair, NO_OBJECTS, Feature().disparities_px(rig)) is None


def test_two_views_of_different_things_show_no_plane() -> None:
    rig = RIGS["thesis"]
    one, other = (seen(rig, plane(35, 0), 8.0, seed) for seed in (0, 1))
    pair = RectifiedPair(one.left, other.right, rig, 0)
    assert grained_table(pair, NO_OBJECTS, Feature().disparities_px(rig)) is None


def test_a_view_full_of_objects_shows_no_table() -> None:
    rig = RIGS["thesis"]
    width, height = rig.left.frame_size
    whole = Blob(np.array([[0.0, 0.0], [width, 0.0], [width, height], [0.0, height]]), 100.0)
    pair = seen(rig, plane(35, 0), 8.0)
    blobs = Blobs((whole,), (whole,), "bright")
    assert grained_table(pair, blobs, Feature().disparities_px(rig)) is None
