"""Views in which the table ends."""

from __future__ import annotations

import numpy as np
import pytest
from families import staged
from rigs import RIGS

from stereo_pick.core.arrays import Image
from stereo_pick.core.objects import Detector
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
