"""Rigs for the tests: the thesis's own, typical ones and random ones."""

from __future__ import annotations

import numpy as np
from hypothesis import strategies as st
from rendering.rigs import SIZE_PX, camera, looking_at, rotation, thesis_cameras

from stereo_pick.core.rig import StereoRig
from stereo_pick.core.transform import Transform

__all__ = ["RIGS", "SIZE_PX", "camera", "looking_at", "random_rigs", "rotation", "thesis_cameras", "typical_rigs"]


def _typical(right_T_left: Transform) -> StereoRig:
    D = (-0.15, 0.08, 0.001, -0.0005, 0.0)
    return StereoRig.from_extrinsics(
        camera("left", 880.0, (321.0, 236.0), D), camera("right", (905.0, 900.0), (315.0, 243.0), D), right_T_left
    )


def typical_rigs() -> dict[str, StereoRig]:
    """One rig of every kind that users build; all see what lies 0.9 m before the left camera."""
    aim = (0.0, 0.0, 0.9)
    return {
        "parallel": _typical(Transform(np.eye(3), np.array([-0.08, 0, 0]))),
        "verged": _typical(looking_at((0.28, 0.0, 0.0), aim)),  # by 17 degrees
        "rolled": _typical(looking_at((0.15, 0.01, -0.02), aim, roll_deg=10)),
        "vertical": _typical(looking_at((0.0, -0.2, 0.0), aim)),
        "thesis": StereoRig.from_extrinsics(*thesis_cameras()),
    }


RIGS = typical_rigs()


@st.composite
def random_rigs(draw: st.DrawFn, distorted: bool = True) -> StereoRig:
    """Rigs of 5 to 40 cm baseline, to the side or up to 45 degrees above or below, that look at a point before them."""
    focal_px = draw(st.floats(600, 1300))
    direction = np.deg2rad(draw(st.floats(-45, 45)))
    baseline_m = draw(st.floats(0.05, 0.4))
    centre = baseline_m * np.array([np.cos(direction), np.sin(direction), draw(st.floats(-0.2, 0.2))])
    target = (draw(st.floats(-0.1, 0.1)), draw(st.floats(-0.1, 0.1)), draw(st.floats(0.8, 4.0)))
    D = (draw(st.floats(-0.25, 0.1)), draw(st.floats(0, 0.05)), 0.001, -0.001, 0.0) if distorted else (0.0,) * 5
    left, right = camera("left", focal_px, (310.0, 245.0), D), camera("right", focal_px * 1.02, D=D)
    return StereoRig.from_extrinsics(left, right, looking_at(centre, target, draw(st.floats(-10, 10))))
