"""Solids that go on beyond a part, as into its shadow: the true end is among the shorter ones that the views show."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from rendered_solids import PLACED, RIG, centre_m, rectified, solid_of
from rendering import Box, Cylinder, Scene, Solid, Sphere

from stereo_pick.core.edges.hypotheses import Images
from stereo_pick.core.edges.shortening import shortened
from stereo_pick.core.shapes.solids import Solids
from stereo_pick.core.shapes.table import Table

NORMAL = RIG.left.R @ PLACED.rotation[:, 2]
TABLE = Table(NORMAL, -float(NORMAL @ RIG.left.R @ PLACED.translation), 5e-4)
PARTS: dict[str, Solid] = {
    "box": Box(0.02, 0.0, (0.06, 0.036, 0.045), yaw_rad=0.4),
    "lying cylinder": Cylinder(-0.02, 0.01, (0.07, 0.036, 0.036), lying=True, yaw_rad=0.7),
}


def longest(solid: Solids) -> int:
    """The axis along the table along which a part is longest."""
    axes = [2] if solid.kind.sizes == 2 else [0, 1, 2]
    level = [axis for axis in axes if abs(solid.rotation[0, :, axis] @ NORMAL) < 0.5]
    return max(level, key=lambda axis: float(solid.half_m[0, solid.kind.axes[axis]]))


def longer(solid: Solids, by: float, sign: float) -> Solids:
    """The part made longer by a share of its length, at one of its ends."""
    axis = longest(solid)
    half_m = solid.half_m.copy()
    half_m[0, solid.kind.axes[axis]] *= 1 + by
    ahead = sign * solid.rotation[:, :, axis] * (half_m - solid.half_m).max()
    return replace(solid, centre_m=solid.centre_m + ahead, half_m=half_m)


@pytest.mark.parametrize("name", PARTS)
@pytest.mark.parametrize("sign", [-1.0, 1.0])
@pytest.mark.parametrize("by", [0.25, 0.5])
def test_the_true_end_is_found_within_what_is_longer(name: str, sign: float, by: float) -> None:
    part = PARTS[name]
    scene = Scene((part,), PLACED, ambient=0.5)
    images, true = Images(rectified(RIG, scene)), solid_of(RIG, scene, part)
    found = shortened(longer(true, by, sign), images.eyes_m, images.maps, TABLE)
    off_m = [float(np.linalg.norm(each.centre_m[0] - centre_m(RIG, scene, part))) for each in found]
    step_m = 3.0 * float(true.centre_m[0, 2]) / RIG.focal_px
    assert min(off_m) < step_m
    best = images.all_locked(found, TABLE)[int(np.argmin(off_m))]
    assert np.linalg.norm(best.fit.centre_m - centre_m(RIG, scene, part)) < 1e-3


@pytest.mark.parametrize("name", PARTS)
def test_what_ends_nowhere_within_has_no_shorter_one(name: str) -> None:
    scene = Scene((PARTS[name],), PLACED, ambient=0.5)
    images = Images(rectified(RIG, scene))
    assert shortened(solid_of(RIG, scene, PARTS[name]), images.eyes_m, images.maps, TABLE) == []


def test_a_ball_cannot_be_shortened() -> None:
    ball = Sphere(0.0, 0.0, (0.04, 0.04, 0.04))
    scene = Scene((ball,), PLACED, ambient=0.5)
    images = Images(rectified(RIG, scene))
    assert shortened(solid_of(RIG, scene, ball), images.eyes_m, images.maps, TABLE) == []
