"""The blur of outlines, and when it is too much."""

from __future__ import annotations

import numpy as np
import pytest
from outlines import disc, discs, grey_image
from rendering import Box, Cylinder, Scene, Sensor, balls, render
from rigs import RIGS

from stereo_pick.core.objects.focus import MAX_BLUR_PX, blur_px, is_out_of_focus
from stereo_pick.core.pipeline import Pipeline, Steps
from stereo_pick.core.refusal import count_reasons

SCENE = Scene(
    (
        Cylinder(-0.08, -0.03, (0.05, 0.05, 0.05), albedo=0.8),
        Box(0.07, -0.02, (0.05, 0.04, 0.03), albedo=0.6),
        *balls((0.0, 0.06, 0.05)),
    )
)


@pytest.mark.parametrize("blur", [1.2, 1.6, 2.0, 2.5, 3.0])
@pytest.mark.parametrize(("surface", "background"), [(200.0, 50.0), (60.0, 220.0)])
def test_the_blur_of_a_disc_is_measured(blur: float, surface: float, background: float) -> None:
    image = grey_image(discs([(300.3, 240.6, 30.0)], surface, background), blur_px=blur, noise_dn=0.5)
    assert blur_px(disc(300.3, 240.6, 30.0, points=190), image) == pytest.approx(np.hypot(blur, 0.4), rel=0.12)


@pytest.mark.parametrize("off_px", [-3.0, 3.0])
def test_an_outline_beside_the_edge_does_not_hide_the_blur(off_px: float) -> None:
    image = grey_image(discs([(300.0, 240.0, 30.0)]), blur_px=4.0, noise_dn=1.0)
    assert is_out_of_focus([disc(300.0, 240.0, 30.0 + off_px, points=190)], image)


def test_a_part_whose_light_fades_towards_its_rim_is_not_out_of_focus_beside_a_sharp_one() -> None:
    v, u = np.mgrid[:480, :640]
    fading = 100 * np.clip(1 - (np.hypot(u - 450, v - 300) / 40) ** 2, 0, 1) ** 2
    image = grey_image(discs([(200.0, 240.0, 30.0)]) + fading, noise_dn=1.0)
    sharp, soft = disc(200.0, 240.0, 30.0, points=190), disc(450.0, 300.0, 22.0, points=140)
    assert is_out_of_focus([soft], image)
    assert not is_out_of_focus([sharp, soft], image)


@pytest.mark.parametrize("blur", [2.6, 4.0, 6.0, 8.0])
def test_out_of_focus_pairs_give_no_pose(blur: float) -> None:
    rig, soft = RIGS["thesis"], Sensor(blur_px=blur)
    poses = Pipeline(rig, Steps()).run(render(rig, SCENE, soft, soft)).poses
    assert len(poses) == 0
    assert count_reasons(poses.refused)["out_of_focus"] >= len(SCENE.solids) - 1


def test_one_camera_out_of_focus_is_enough() -> None:
    rig = RIGS["thesis"]
    poses = Pipeline(rig, Steps()).run(render(rig, SCENE, Sensor(), Sensor(blur_px=3.0))).poses
    assert len(poses) == 0
    assert "out_of_focus" in count_reasons(poses.refused)


@pytest.mark.parametrize("noise_dn", [0.5, 3.0])
@pytest.mark.parametrize("blur", [0.5, 1.0, 1.5])
def test_usual_lenses_are_sharp_enough(blur: float, noise_dn: float) -> None:
    rig, lens = RIGS["thesis"], Sensor(blur_px=blur, noise_dn=noise_dn)
    result = Pipeline(rig, Steps()).run(render(rig, SCENE, lens, lens))
    for view, blobs in ((result.pair.left, result.blobs.left), (result.pair.right, result.blobs.right)):
        assert max(blur_px(blob, view) for blob in blobs if blob.fault != "faint") < 0.95 * MAX_BLUR_PX
