"""Parts that stand in a narrow shadow."""

from __future__ import annotations

import cv2
import numpy as np
import pytest
from families import staged
from marks import first_of

from stereo_pick.core.arrays import Floats, Image
from stereo_pick.core.edges.foot import shadow_px
from stereo_pick.core.pipeline import Pipeline, Steps

TABLE, PART = 80.0, 60.0
EDGES_PX = np.array([[20.0, row] for row in np.arange(10.0, 40.0)])
INWARDS = np.tile([1.0, 0.0], (len(EDGES_PX), 1))


def view(shadow: float, width_px: float, blur_px: float = 0.8, noise: float = 0.0) -> Image:
    """A table to the left of column 20, a shadow so wide behind it, and then the part."""
    fine = np.full((50, 60 * 20), TABLE)
    columns = (np.arange(60 * 20) + 0.5) / 20 - 0.5
    fine[:, columns > 20] = shadow
    fine[:, columns > 20 + width_px] = PART
    light = cv2.resize(
        cv2.GaussianBlur(fine, (0, 0), blur_px * 20, sigmaY=1e-3), (60, 50), interpolation=cv2.INTER_AREA
    )
    return np.asarray(np.round(light + np.random.default_rng(0).normal(0, noise, light.shape)), np.uint8)


def widths_px(image: Image, noise: float = 0.3) -> Floats:
    return shadow_px(image, EDGES_PX, INWARDS, np.full(len(EDGES_PX), 50.0), noise)


@pytest.mark.parametrize("width_px", [2.0, 2.5, 3.0])
@pytest.mark.parametrize("blur_px", [0.6, 0.8, 1.0])
def test_a_part_ends_behind_its_shadow(width_px: float, blur_px: float) -> None:
    np.testing.assert_allclose(widths_px(view(30.0, width_px, blur_px)), width_px, atol=0.5)


def test_a_part_as_dark_as_what_is_behind_its_edge_has_no_shadow() -> None:
    for noise in (0.0, 0.5):
        assert (widths_px(view(PART, 3.0, noise=noise)) == 0).all()
    assert (widths_px(view(PART + 10, 2.0)) == 0).all()


def test_no_edges_have_no_shadows() -> None:
    assert shadow_px(view(30.0, 2.0), np.zeros((0, 2)), np.zeros((0, 2)), np.zeros(0), 0.3).shape == (0,)


@pytest.mark.parametrize("seed", first_of(6, 14))
def test_bodies_with_dark_sides_are_no_higher_for_their_shadows(seed: int) -> None:
    scene = staged("four_cylinders", seed)
    frame, truth = scene.taken()
    poses = Pipeline(scene.rig, Steps()).run(frame).poses
    assert len(poses) >= 3
    heights_m = np.array([part.extent_m[2] for part in truth.objects])
    assert np.abs(poses.size_m[:, 2] - np.median(heights_m)).max() < 1.2e-3
