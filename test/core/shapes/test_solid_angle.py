"""The centre of the cone of rays to an object."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from outlines import PARALLEL
from rigs import RIGS, rotation
from solid_outlines import Part, contour_px, contours_px

from stereo_pick.core.shapes import centroid_px


@pytest.mark.parametrize("name", RIGS)
@given(x=st.floats(-0.4, 0.4), y=st.floats(-0.3, 0.3), depth_m=st.floats(0.4, 1.5), share=st.floats(0.01, 0.1))
@settings(max_examples=20, deadline=None)
def test_a_sphere_is_seen_where_its_centre_is(name: str, x: float, y: float, depth_m: float, share: float) -> None:
    rig = RIGS[name]
    centre = np.array([x * depth_m, y * depth_m, depth_m])
    ball = Part("sphere", centre, np.eye(3), np.array([share * depth_m]))
    for contour, camera in zip(contours_px(ball, rig), (rig.left, rig.right)):
        seen = camera.P @ np.append(centre, 1)
        np.testing.assert_allclose(centroid_px(contour, camera), seen[:2] / seen[2], atol=1e-3)


def test_it_does_not_depend_on_which_way_the_camera_is_turned() -> None:
    camera, turn = PARALLEL.left, rotation((0.2, -0.15, 0.4))
    points = Part("box", np.array([0.05, 0.02, 0.6]), rotation((0.3, 0.8, 0.1)), np.array([0.05, 0.03, 0.02]))
    directions = []
    for R in (np.eye(3), turn):
        seen = contour_px(points.seen_from(np.zeros(3)) @ R.T, camera)
        ray = np.append((centroid_px(seen, camera) - camera.P[:2, 2]) / camera.P[0, 0], 1) @ R
        directions.append(ray / np.linalg.norm(ray))
    np.testing.assert_allclose(*directions, atol=1e-9)


def test_the_sense_of_rotation_and_the_sampling_do_not_matter() -> None:
    camera = PARALLEL.left
    corners = np.array([(100.0, 120.0), (300.0, 110.0), (340.0, 300.0), (90.0, 260.0)])
    t = np.linspace(0, 1, 50, endpoint=False)[:, None]
    dense = np.concatenate([a + t * (b - a) for a, b in zip(corners, np.roll(corners, -1, axis=0))])
    want = centroid_px(corners, camera)
    np.testing.assert_allclose(centroid_px(corners[::-1], camera), want, atol=1e-9)
    np.testing.assert_allclose(centroid_px(dense, camera), want, atol=1e-9)
