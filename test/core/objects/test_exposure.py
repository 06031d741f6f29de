"""Too dark, saturated: a view that cannot show its objects says so, and one that can never does."""

from __future__ import annotations

import numpy as np
import pytest
from outlines import PARALLEL, Disc, disc, discs, grey_image, tiles
from rendering import Scene, Sensor, balls, render
from rigs import RIGS, SIZE_PX

from stereo_pick.core.arrays import Floats, Image
from stereo_pick.core.frames import RectifiedPair, StereoFrame
from stereo_pick.core.matches.unseen import unseen
from stereo_pick.core.objects import Blob, Blobs, Detector
from stereo_pick.core.objects.exposure import with_saturation
from stereo_pick.core.pipeline import Pipeline, Result, Steps
from stereo_pick.core.refusal import count_reasons

PARTS = balls((-0.08, -0.03, 0.04), (0.0, 0.05, 0.05), (0.07, -0.02, 0.045))
SCENES = {"bright": Scene(PARTS), "dark": Scene(balls((0.0, 0.05, 0.05), albedo=0.1), table_albedo=0.7)}
PLACES: tuple[Disc, ...] = ((120.3, 100.7, 25.0), (300.0, 240.0, 18.0), (500.6, 380.2, 30.0))


def run(scene: str, left: Sensor, right: Sensor) -> Result:
    rig = RIGS["thesis"]
    return Pipeline(rig, Steps()).run(render(rig, SCENES[scene], left, right))


def reasons(result: Result) -> dict[str, int]:
    return count_reasons(result.poses.refused)


def pair_of(light: Floats) -> RectifiedPair:
    return RectifiedPair(*(grey_image(light, noise_dn=1.0, seed=seed) for seed in (1, 2)), PARALLEL)


@pytest.mark.parametrize("gain", [0.0, 0.003, 0.01])
@pytest.mark.parametrize("offset_dn", [0.0, 5.0, 16.0])
@pytest.mark.parametrize("scene", SCENES)
def test_a_pair_without_light_is_too_dark(scene: str, offset_dn: float, gain: float) -> None:
    dim = Sensor(gain=gain, offset_dn=offset_dn)
    result = run(scene, dim, dim)
    assert len(result.poses) == 0
    assert result.blobs.view_faults == ("too_dark", "too_dark")
    assert reasons(result)["too_dark"] == 2


def test_parts_that_a_twelve_bit_image_shows_in_sixteen_are_too_dark_to_be_placed() -> None:
    steps = discs(PLACES, surface=13.0, background=3.0)
    blobs = Detector().detect(pair_of(steps))
    assert len(blobs.left) == len(PLACES)
    assert blobs.view_faults == ("too_dark", "too_dark")


@pytest.mark.parametrize("dark_side", [0, 1])
def test_a_lens_cap_on_one_camera_is_said_of_that_camera(dark_side: int) -> None:
    sensors = [Sensor(), Sensor()]
    sensors[dark_side] = Sensor(gain=0.0)
    result = run("bright", *sensors)
    assert len(result.poses) == 0
    assert [bool(fault) for fault in result.blobs.view_faults] == [dark_side == 0, dark_side == 1]
    assert reasons(result) == {"too_dark": 1 + len(PARTS)}, "the view, and each object that the other shows"
    of_view = result.correspondences.refused[0]
    assert (of_view.left_px is None, of_view.right_px is None) == (dark_side == 1, dark_side == 0)


@pytest.mark.parametrize("scene", SCENES)
def test_a_pair_that_is_white_all_over_is_saturated(scene: str) -> None:
    bright = Sensor(gain=30.0)
    result = run(scene, bright, bright)
    assert len(result.poses) == 0
    assert result.blobs.view_faults == ("saturated", "saturated")


@pytest.mark.parametrize("gain", [0.3, 1.0, 1.5])
@pytest.mark.parametrize("offset_dn", [0.0, 16.0])
def test_dim_and_bright_pictures_that_show_their_parts_are_left_alone(gain: float, offset_dn: float) -> None:
    sensor = Sensor(gain=gain, offset_dn=offset_dn)
    assert len(run("bright", sensor, sensor).poses) == len(PARTS)


def test_dark_parts_on_white_paper_that_is_clipped_are_found() -> None:
    blobs = Detector().detect(pair_of(discs(PLACES, surface=40.0, background=400.0)))
    assert blobs.view_faults == ("", "")
    assert [blob.fault for blob in blobs.left] == ["", "", ""]


@pytest.mark.parametrize("level", [40.0, 128.0, 240.0])
def test_an_empty_table_in_good_light_has_no_fault(level: float) -> None:
    assert Detector().detect(pair_of(np.full(SIZE_PX[::-1], level))).view_faults == ("", "")


@pytest.mark.parametrize(("level", "fault"), [(2.0, "too_dark"), (300.0, "saturated")])
def test_an_empty_table_that_could_hide_objects_has_one(level: float, fault: str) -> None:
    assert Detector().detect(pair_of(np.full(SIZE_PX[::-1], level))).view_faults == (fault, fault)


def test_a_table_of_bold_tiles_is_uneven_and_no_empty_one() -> None:
    assert Detector().detect(pair_of(tiles(100, 180))).view_faults == ("uneven", "uneven")
    views = (grey_image(tiles(100, 180), noise_dn=1.0, seed=seed) for seed in (1, 2))
    result = Pipeline(PARALLEL, Steps()).run(StereoFrame(*views))
    assert reasons(result) == {"uneven": 2}


def test_tiles_on_which_most_objects_would_be_seen_have_no_fault() -> None:
    assert Detector().detect(pair_of(tiles(130, 150))).view_faults == ("", "")


def test_a_table_on_which_a_part_is_seen_is_not_refused_as_uneven() -> None:
    light = discs([(300.0, 240.0, 30.0)], surface=5.0, background=tiles(130, 180))
    blobs = Detector().detect(pair_of(light))
    assert blobs.view_faults == ("", "") and len(blobs.left) == 1


def white_with_grey_disc(top: float) -> tuple[Image, Blob]:
    """A grey disc on clipped white; within it a smaller one of level `top`."""
    light = discs([(300.0, 240.0, 30.0)], surface=120.0, background=400.0)
    return grey_image(discs([(300.0, 240.0, 15.0)], surface=top, background=light)), disc(300.0, 240.0, 30.0)


@pytest.mark.parametrize(("top", "fault"), [(120.0, ""), (240.0, ""), (400.0, "saturated")])
def test_a_part_is_saturated_where_it_is_clipped_on_a_clipped_background(top: float, fault: str) -> None:
    image, blob = white_with_grey_disc(top)
    assert [each.fault for each in with_saturation([blob], image)] == [fault]


def test_a_clipped_part_on_a_dark_table_is_not() -> None:
    image = grey_image(discs([(300.0, 240.0, 30.0)], surface=400.0, background=50.0))
    assert with_saturation([disc(300.0, 240.0, 30.0)], image)[0].fault == ""


def test_faults_that_objects_have_of_their_own_are_kept() -> None:
    pair = pair_of(np.full(SIZE_PX[::-1], 90.0))
    blobs = Blobs((disc(50, 50, fault="merged"), disc(150, 50)), (), "bright", ("", "too_dark"))
    assert count_reasons(unseen(blobs, pair)) == {"too_dark": 2, "merged": 1}
