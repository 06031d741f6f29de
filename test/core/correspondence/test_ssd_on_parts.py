"""Method ssd on rendered parts, against the surface that their outlines' centres show."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from rendering import CLEAN, Box, Cylinder, Scene, Sensor, Sphere, balls, render
from rigs import RIGS

from stereo_pick.core.arrays import Floats
from stereo_pick.core.correspondence.ssd import Ssd
from stereo_pick.core.frames import RectifiedPair
from stereo_pick.core.objects import Blobs, Detector
from stereo_pick.core.rectification import Rectifier
from stereo_pick.core.refusal import count_reasons
from stereo_pick.core.rig import StereoRig

TEXTURED = Scene(
    (
        Box(-0.1, -0.04, (0.06, 0.05, 0.04), 0.7, texture=0.4),
        Cylinder(0.0, 0.05, (0.05, 0.05, 0.05), texture=0.4),
        Sphere(0.09, -0.03, (0.055,) * 3, texture=0.4),
    )
)
MATTE = Scene(balls((-0.08, -0.03, 0.045), (0.0, 0.05, 0.05), (0.07, -0.04, 0.04)))
DIMMER = Sensor(gain=0.7, offset_dn=15, noise_dn=2)


@cache
def seen(rig_name: str, textured: bool, right: Sensor = CLEAN) -> tuple[RectifiedPair, Blobs]:
    pair = Rectifier(RIGS[rig_name]).rectify(render(RIGS[rig_name], TEXTURED if textured else MATTE, right=right))
    return pair, Detector().detect(pair)


def true_column_px(rig: StereoRig, scene: Scene, left_px: Floats) -> float:
    """Right column of the surface that a rectified left point shows."""
    P, Q = rig.left.P, rig.right.P
    ray = rig.left.R.T @ np.array([(left_px[0] - P[0, 2]) / P[0, 0], (left_px[1] - P[1, 2]) / P[1, 1], 1.0])
    table_T_left = scene.left_T_table.inverse()
    ahead = (table_T_left.rotation @ ray)[None]
    far = min(float(solid.hit(table_T_left.translation, ahead)[0][0]) for solid in scene.solids)
    x, _, z = rig.right.R @ rig.right_T_left.apply((far * ray)[None])[0]
    return float(Q[0, 0] * x / z + Q[0, 2])


@pytest.mark.parametrize("right", [CLEAN, DIMMER], ids=["alike", "dimmer"])
@pytest.mark.parametrize("rig_name", ["verged", "parallel", "thesis"])
def test_flat_slanted_and_round_faces_are_found_by_either_camera_gain(rig_name: str, right: Sensor) -> None:
    pair, blobs = seen(rig_name, True, right)
    found = Ssd().match(pair, blobs)
    assert len(found) == len(blobs.sound()[0]) == 3
    true = np.array([true_column_px(pair.rig, TEXTURED, place) for place in found.left_px])
    error = np.abs(found.right_px[:, 0] - true)
    assert error.max() < 0.6 and (error < 2 * np.hypot(*found.sigma_px.T)).all()


def test_plain_ssd_refuses_what_a_dimmer_camera_shows_rather_than_guess() -> None:
    pair, blobs = seen("verged", True, DIMMER)
    found = Ssd(cost="ssd").match(pair, blobs)
    true = np.array([true_column_px(pair.rig, TEXTURED, place) for place in found.left_px])
    assert (np.abs(found.right_px[:, 0] - true) < 1.0).all()
    assert len(found) + sum(count_reasons(found.refused).values()) >= len(blobs.sound()[0])


@pytest.mark.parametrize("cost", ["zncc", "ssd"])
@pytest.mark.parametrize("rig_name", ["verged", "parallel", "thesis"])
def test_matte_balls_are_refused_or_right(rig_name: str, cost: str) -> None:
    """Even paint still has shading, which on a matte part stays where it is: what is matched by it must be right."""
    pair, blobs = seen(rig_name, False)
    found = Ssd(cost=cost).match(pair, blobs)
    true = np.array([true_column_px(pair.rig, MATTE, place) for place in found.left_px])
    error = np.abs(found.right_px[:, 0] - true)
    assert error.max(initial=0) < 1.5 and (error < 2.5 * np.hypot(*found.sigma_px.T)).all()
    assert len(found) + len(found.refused) >= len(blobs.sound()[0])
