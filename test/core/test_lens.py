"""Intrinsics that a lens can have, however wide or distorted it is, and those that none can."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from rigs import RIGS, camera

from stereo_pick.core.camera import Camera
from stereo_pick.core.errors import CalibrationError
from stereo_pick.core.lens import check_lens
from stereo_pick.core.sensor_window import SensorWindow

LENSES = {
    "none": camera(),
    "the thesis's": RIGS["thesis"].left,
    "k1 alone, which folds in the corners": camera(focal_px=533.0, D=(-0.3, 0, 0, 0)),
    "barrel, 94 degrees": camera(focal_px=300.0, D=(-0.3, 0.12, 0.001, -0.001, -0.02)),
    "pincushion": camera(D=(0.4, 0.3, 0, 0, 0.1)),
    "rational, 130 degrees": camera(
        focal_px=280.0, D=(2.6, 1.1, 0, 0, 0.04, 2.93, 1.9, 0.28), model="rational_polynomial"
    ),
    "rational, that narrows to nothing": camera(D=(0.0,) * 5 + (0.3, 0.1, 0.0), model="rational_polynomial"),
    "fisheye": camera(focal_px=200.0, D=(0.05, -0.01, 0.002, -0.001), model="equidistant"),
    "circular fisheye, which folds beyond its circle": camera(focal_px=120.0, D=(0, -0.03, 0, 0), model="equidistant"),
}


@pytest.mark.parametrize("name", LENSES)
def test_what_a_lens_can_have_is_accepted(name: str) -> None:
    check_lens(LENSES[name])


@pytest.mark.parametrize("x_offset", [0, 3000])
def test_a_window_may_lie_beside_the_optical_axis(x_offset: int) -> None:
    full = camera(focal_px=2000.0, centre_px=(2000.0, 1500.0), D=(-0.05, 0.02, 0, 0, 0), size_px=(4000, 3000))
    roi = SimpleNamespace(x_offset=x_offset, y_offset=0, width=640, height=480)
    window = SensorWindow.of(SimpleNamespace(roi=roi, binning_x=0, binning_y=0)).of_raw(full)
    assert window.frame_size == (640, 480) and not 0 < window.K[0, 2] < 640
    check_lens(window)


@pytest.mark.parametrize("centre_px", [(5000.0, 240.0), (320.0, -3000.0)])
def test_an_image_beside_all_that_a_lens_shows_is_refused(centre_px: tuple[float, float]) -> None:
    with pytest.raises(CalibrationError, match="left camera: principal point .* focal lengths beside the image of 640"):
        check_lens(camera(centre_px=centre_px))


@pytest.mark.parametrize(
    "folded",
    [
        camera(D=(-25.0, 0, 0, 0, 0)),
        camera(focal_px=300.0, D=(-1.0, 0, 0, 0)),
        camera(D=(0, 0, 0, 0, 0, -8.0, 200.0, 0), model="rational_polynomial"),
        camera(focal_px=400.0, D=(-2.0, 0, 0, 0), model="equidistant"),
    ],
)
def test_a_distortion_that_folds_the_image_over_is_refused(folded: Camera) -> None:
    with pytest.raises(CalibrationError, match="left camera: D = .* folds the image over: no ray would end .* px"):
        check_lens(folded)
    check_lens(replace(folded, D=np.zeros_like(folded.D)))


def test_no_ray_ends_beyond_a_fold() -> None:
    """What the message says is so."""
    folded = camera(D=(-25.0, 0, 0, 0, 0))
    rays = np.stack([np.linspace(0, 0.2, 1000), np.zeros(1000), np.ones(1000)], axis=1)
    reach_px = (folded.project(rays)[:, 0] - folded.K[0, 2]).max()
    with pytest.raises(CalibrationError, match=f"no ray would end {reach_px:.0f} px or more"):
        check_lens(folded)
