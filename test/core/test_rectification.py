"""Rectified images: what is seen lies on the same row, at the place that R and P say."""

from __future__ import annotations

import numpy as np
import pytest
from rendering import Scene, Sensor, balls, render
from rigs import RIGS, SIZE_PX

from stereo_pick.core.arrays import Floats, Image
from stereo_pick.core.camera import Camera
from stereo_pick.core.errors import ImageError
from stereo_pick.core.frames import StereoFrame
from stereo_pick.core.rectification import Rectifier

BALLS = balls((-0.07, -0.03, 0.04), (0.0, 0.05, 0.05), (0.06, -0.02, 0.045))
EVEN = Scene(BALLS, ambient=1.0)


@pytest.mark.parametrize("name", RIGS)
def test_every_ball_lies_at_its_closed_form_place_on_one_row(name: str) -> None:
    rig = RIGS[name]
    pair = Rectifier(rig).rectify(render(rig, EVEN, Sensor(noise_dn=0), Sensor(noise_dn=0)))
    expected = [ellipse_centres(rig.left, EVEN.positions_m())]
    expected.append(ellipse_centres(rig.right, rig.right_T_left.apply(EVEN.positions_m())))
    np.testing.assert_allclose(expected[0][:, 1], expected[1][:, 1], atol=1e-6)
    for image, centres in ((pair.left, expected[0]), (pair.right, expected[1])):
        for centre in centres:
            np.testing.assert_allclose(centroid_near(image, centre), centre, atol=0.05)


def ellipse_centres(lens: Camera, centres_m: Floats) -> Floats:
    x, y, z = (centres_m @ lens.R.T).T
    radius = np.array([ball.size_m[0] / 2 for ball in BALLS])
    return lens.P[0, 0] * np.stack([x, y], axis=1) * (z / (z**2 - radius**2))[:, None] + lens.P[:2, 2]


def centroid_near(image: Image, centre: Floats, reach: int = 34) -> Floats:
    column, row = np.round(centre).astype(int)
    v, u = np.mgrid[row - reach : row + reach + 1, column - reach : column + reach + 1]
    grey = image[v, u].astype(np.float64)
    background = np.median(image[image > 0])
    near = (u - centre[0]) ** 2 + (v - centre[1]) ** 2 < reach**2
    weight = np.clip(grey - background - 2, 0, None) * near
    return np.array([(u * weight).sum(), (v * weight).sum()]) / weight.sum()


@pytest.mark.parametrize("side", ["left", "right"])
def test_an_image_of_another_size_is_refused(side: str) -> None:
    images = {name: np.zeros(SIZE_PX[::-1], np.uint8) for name in ("left", "right")}
    images[side] = np.zeros((240, 320), np.uint8)
    with pytest.raises(ImageError, match=f"{side} image is 320 x 240, but the calibration is for 640 x 480"):
        Rectifier(RIGS["verged"]).rectify(StereoFrame(**images))


def test_colour_becomes_grey_and_the_stamp_stays() -> None:
    rig, rng = RIGS["verged"], np.random.default_rng(0)
    colour = rng.integers(0, 255, (*SIZE_PX[::-1], 3), np.uint8)
    pair = Rectifier(rig).rectify(StereoFrame(colour, colour, stamp_ns=42))
    assert pair.left.shape == SIZE_PX[::-1] and pair.stamp_ns == 42 and pair.rig is rig


def test_what_the_raw_image_does_not_cover_is_black() -> None:
    rig, white = RIGS["rolled"], np.full(SIZE_PX[::-1], 255, np.uint8)
    pair = Rectifier(rig).rectify(StereoFrame(white, white))
    assert pair.left.min() == 0 and pair.left.max() == 255
