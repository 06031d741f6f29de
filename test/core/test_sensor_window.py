"""A camera whose driver delivers a part of the sensor's image, or combines its pixels."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from recordings import DEMO_BAG
from rendering import Box, Cylinder, Scene, render
from rendering.rigs import table_before
from rigs import RIGS

from stereo_pick.core.errors import CalibrationError
from stereo_pick.core.frames import StereoFrame
from stereo_pick.core.pipeline import Pipeline, Steps
from stereo_pick.core.refusal import count_reasons
from stereo_pick.core.rig import StereoRig
from stereo_pick.core.sensor_window import SensorWindow
from stereo_pick.sources.opening import open_source

RIG = RIGS["thesis"]
ALL = SensorWindow(0, 0, 0, 0, 0, 0)


@given(
    x_px=st.integers(0, 100), y_px=st.integers(0, 80), across=st.integers(1, 4), down=st.integers(1, 4), data=st.data()
)
def test_a_pixel_looks_where_those_look_together_that_it_is_made_of(
    x_px: int, y_px: int, across: int, down: int, data: st.DataObject
) -> None:
    full = RIG.right
    width_px, height_px = full.width_px - x_px, full.height_px - y_px
    window = SensorWindow(x_px, y_px, width_px, height_px, across, down)
    camera, rectified = window.of_raw(full), window.of_rectified(full)
    assert camera.frame_size == (width_px // across, height_px // down)
    i, j = (data.draw(st.integers(0, size - 1)) for size in camera.frame_size)
    u, v = np.meshgrid(x_px + across * i + np.arange(across), y_px + down * j + np.arange(down))
    middle_px = np.array([[u.mean(), v.mean()]])
    np.testing.assert_allclose(camera.normalized([[i, j]]), full.normalized(middle_px), atol=1e-9)
    np.testing.assert_allclose(rectified.rays([[i, j]]), full.rays(middle_px), atol=1e-9)
    assert (camera.P == full.P).all() and rectified.frame_size == camera.frame_size


@pytest.mark.parametrize("window", [ALL, replace(ALL, binning_x=1, binning_y=1), replace(ALL, width_px=640)])
def test_all_of_it_is_the_camera_itself(window: SensorWindow) -> None:
    camera = window.of_rectified(RIG.left)
    assert camera.frame_size == RIG.left.frame_size
    for matrix in "KDRP":
        assert (getattr(camera, matrix) == getattr(RIG.left, matrix)).all()


@pytest.mark.parametrize(
    ("window", "says"),
    [
        (SensorWindow(20, 0, 640, 480, 0, 0), r"left camera: .*640 x 480 pixels at \(20, 0\).*beyond.*640 x 480"),
        (SensorWindow(0, 8, 0, 0, 0, 0), r"640 x 480 pixels at \(0, 8\)"),
        (replace(ALL, binning_x=1000), "image size 0 x 480 must be positive"),
    ],
)
def test_no_camera_delivers_what_is_beyond_its_image(window: SensorWindow, says: str) -> None:
    with pytest.raises(CalibrationError, match=says):
        window.of_raw(RIG.left)


@pytest.mark.parametrize("binning", [1, 2])
def test_objects_are_where_they_were_in_the_full_images(binning: int) -> None:
    """Each camera with a region of its own; those of the full camera's numbers would be off by centimetres."""
    parts = (Cylinder(-0.02, 0.0, (0.04, 0.04, 0.05)), Box(0.05, -0.02, (0.05, 0.036, 0.04), yaw_rad=0.4))
    frame = render(RIG, Scene(parts, table_before(RIG, 0.9, 60)), seed=1)
    windows = (SensorWindow(60, 20, 520, 440, binning, binning), SensorWindow(30, 40, 520, 440, binning, binning))
    cut = [
        image[w.y_px : w.y_px + w.height_px, w.x_px : w.x_px + w.width_px]
        .reshape(w.height_px // binning, binning, w.width_px // binning, binning)
        .mean(axis=(1, 3))
        .round()
        .astype(np.uint8)
        for image, w in zip((frame.left, frame.right), windows)
    ]
    cameras = (w.of_raw(full) for w, full in zip(windows, (RIG.left, RIG.right)))
    rig = StereoRig.from_cameras(*cameras)
    expected = Pipeline(RIG, Steps()).run(frame).poses
    found = Pipeline(rig, Steps()).run(StereoFrame(cut[0], cut[1], 0)).poses
    assert len(expected) == 2
    np.testing.assert_allclose(found.xyz, expected.xyz, atol=5e-4 * binning)


def test_a_part_that_a_region_cuts_in_one_view_only_is_refused() -> None:
    """It was a shorter one, on the plane of the belt on which the only other part stands: 6.5 mm off, sure of it."""
    source = open_source(DEMO_BAG)
    assert source.cameras is not None
    windows = (SensorWindow(2, 18, 486, 268, 0, 0), SensorWindow(100, 7, 486, 268, 0, 0))
    rig = StereoRig.from_cameras(*(w.of_raw(full) for w, full in zip(windows, source.cameras)))
    images = next(iter(source)).images()
    cut = [image[w.y_px : w.y_px + w.height_px, w.x_px : w.x_px + w.width_px] for image, w in zip(images, windows)]
    poses = Pipeline(rig, Steps()).run(StereoFrame(cut[0], cut[1], 0)).poses
    assert len(poses) == 1 and poses.xyz[0, 1] < -0.05
    assert "cut_by_border" in count_reasons(poses.refused)
