"""Views in which the table ends."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from evaluate_surroundings import taken
from families import staged
from outlines import disc
from rendering.rigs import BENCH_RIGS
from rigs import RIGS

from stereo_pick.core.arrays import Image
from stereo_pick.core.objects import Blobs, Detector
from stereo_pick.core.objects.blob import MAX_CONCAVITY
from stereo_pick.core.objects.energy import seen_by_both
from stereo_pick.core.objects.foreground import measure_contrast
from stereo_pick.core.objects.surfaces import surfaces, without_others
from stereo_pick.core.objects.view import View
from stereo_pick.core.rectification import Rectifier

CAMERA = RIGS["thesis"].left
SIGMAS = 6.0


def view(beyond: float, share: float, noise: float = 1.0) -> View:
    """A table of 70 grey levels, and beyond it, in so large a part of the view, other ones."""
    height, width = CAMERA.height_px, CAMERA.width_px
    light = np.full((height, width), 70.0)
    light[:, : int(share * width)] = beyond
    light += np.random.default_rng(0).normal(0, noise, light.shape)
    return View.of(np.asarray(np.round(light), np.uint8), CAMERA)


@pytest.mark.parametrize("beyond", [20.0, 130.0])
@pytest.mark.parametrize("share", [0.15, 0.3, 0.6])
def test_what_lies_beyond_an_edge_is_a_surface_of_its_own(beyond: float, share: float) -> None:
    found = surfaces(measure_contrast(view(beyond, share), "background", 0, SIGMAS), SIGMAS)
    shown = [np.median(each.view.smooth[np.abs(each.excess("bright", np.s_[:, :])) < 5]) for each in found]
    np.testing.assert_allclose(sorted(shown), sorted([70.0, beyond]), atol=1.0)
    table = without_others(found[0], found)
    own = np.abs(table.excess("bright", np.s_[:, :])) < 5
    other = table.view.inside & ~own
    assert table.beyond is not None and table.beyond[own].mean() < 0.03 and table.beyond[other].mean() > 0.97


@pytest.mark.parametrize(("beyond", "share", "noise"), [(70.0, 0.3, 1.0), (78.0, 0.3, 3.0), (130.0, 0.02, 1.0)])
def test_one_surface_is_the_table(beyond: float, share: float, noise: float) -> None:
    contrast = measure_contrast(view(beyond, share, noise), "background", 0, SIGMAS)
    assert surfaces(contrast, SIGMAS) == [contrast]
    assert without_others(contrast, [contrast]) is contrast


def test_a_large_object_within_the_view_is_no_surface() -> None:
    height, width = CAMERA.height_px, CAMERA.width_px
    image: Image = np.full((height, width), 70, np.uint8)
    image[height // 4 : height // 2, width // 4 : width // 2] = 150
    contrast = measure_contrast(View.of(image, CAMERA), "background", 0, SIGMAS)
    assert surfaces(contrast, SIGMAS) == [contrast]


@pytest.mark.parametrize("seed", [4, 6, 14, 15, 21])
def test_objects_are_found_wherever_the_table_ends(seed: int) -> None:
    """In some of these views what lies beyond is larger than the table, and objects stand before it."""
    scene = staged("table_edge", seed)
    frame, truth = scene.taken()
    blobs = Detector().detect(Rectifier(scene.rig).rectify(frame))
    for side in (blobs.left, blobs.right):
        assert sum(blob.fault in ("", "merged") for blob in side) >= len(truth.objects)
        assert not any(blob.cut for blob in side)


def test_parts_stand_on_the_table_though_bold_prints_on_another_surface_show_more() -> None:
    """The squares of a board had more contrast than all parts, which were one with their shadows then."""
    rig_name, frame, truth = taken(None, ("thick_board", 4))
    rig = BENCH_RIGS[rig_name]
    blobs = Detector().detect(Rectifier(rig).rectify(frame))
    assert blobs.polarity == "bright"
    parts_m = np.array([each.centre_m for each in truth.objects if each.required])
    for camera, side, xyz in (
        (rig.left, blobs.left, parts_m),
        (rig.right, blobs.right, rig.right_T_left.apply(parts_m)),
    ):
        expected = camera.rectified(camera.project(xyz))
        found = np.array([blob.centroid_px for blob in side if not blob.cut])
        off_px = np.linalg.norm(found[:, None] - expected, axis=2)
        assert off_px.min(axis=0).max() < 20


def test_what_both_views_show_counts_as_far_as_it_may_be_one_part() -> None:
    whole, notched = disc(100, 100), disc(200, 100)
    notched = replace(notched, contour_px=np.insert(notched.contour_px, 10, notched.contour_px.mean(axis=0), axis=0))
    alone = seen_by_both(Blobs((whole,), (whole,), "bright"), MAX_CONCAVITY)
    assert alone > 0
    assert seen_by_both(Blobs((whole, notched), (whole, notched), "bright"), MAX_CONCAVITY) == alone
    assert seen_by_both(Blobs((whole,), (notched,), "bright"), MAX_CONCAVITY) == 0
