"""Cylinders end where their rims show, in rendered scenes with exact truth."""

from __future__ import annotations

import numpy as np
import pytest
from rendered_solids import FROM_ABOVE, PARTS, PLACED, RIG, rectified, solid_of, table_of
from rendering import Cylinder, Scene, Solid

from stereo_pick.core.edges.creases import creases
from stereo_pick.core.edges.ending import ended
from stereo_pick.core.edges.growing import stretched_by
from stereo_pick.core.edges.hypotheses import Images
from stereo_pick.core.shapes.occluders import Occluders
from stereo_pick.core.shapes.solid_fit import SolidFit
from stereo_pick.core.shapes.solids import Solids

TABLE = table_of(RIG, PLACED)
LYING = Cylinder(0.0, 0.0, (0.03, 0.03, 0.06), yaw_rad=1.2, lying=True)


def seen(part: Solid) -> tuple[Images, Solids]:
    scene = Scene((part,), PLACED, lamps=(FROM_ABOVE,), ambient=0.3)
    return Images(rectified(RIG, scene)), solid_of(RIG, scene, part)


def seen_end(solid: Solids) -> float:
    """Which end of a lying cylinder both cameras see: 1 where its axis points to, -1 the other."""
    is_seen = creases(solid, RIG.eyes_m).seen[0].reshape(2, 2, -1).all(axis=(0, 2))
    assert is_seen.sum() == 1
    return 1.0 if is_seen[1] else -1.0


@pytest.mark.parametrize("by", [-0.4, -0.15, 0.25, 0.7])
def test_a_cylinder_ends_where_its_rim_shows(by: float) -> None:
    images, true = seen(LYING)
    by_m = by * 2 * float(true.half_m[0, 1])
    wrong = stretched_by(true, [(2, seen_end(true))], np.array([by_m]))
    first = ended(wrong, images.maps, RIG, TABLE, None)[0]
    pixel_m = float(true.centre_m[0, 2]) / RIG.focal_px
    np.testing.assert_allclose(first.half_m, true.half_m, atol=pixel_m)
    np.testing.assert_allclose(first.centre_m, true.centre_m, atol=pixel_m)


def test_where_the_rim_is_hidden_it_shows_nothing() -> None:
    images, true = seen(LYING)
    end = true.centre_m[0] + seen_end(true) * float(true.half_m[0, 1]) * true.rotation[0, :, 2]
    before_m = end * (1 - 0.06 / float(np.linalg.norm(end)))
    ball = SolidFit("sphere", before_m, np.eye(3), np.full(3, 0.05), 0.1, 1e-8 * np.eye(3))
    assert len(ended(true, images.maps, RIG, TABLE, None)) > 0
    assert ended(true, images.maps, RIG, TABLE, Occluders.of([ball], RIG)) == []


def test_of_a_cylinder_seen_from_the_side_no_rim_shows() -> None:
    images, true = seen(Cylinder(0.0, 0.0, (0.03, 0.03, 0.06), lying=True))
    assert not creases(true, RIG.eyes_m).seen.all(axis=1).any()
    assert ended(true, images.maps, RIG, TABLE, None) == []


@pytest.mark.parametrize("name", ["box", "sphere", "standing"])
def test_nothing_else_is_looked_for(name: str) -> None:
    """A cylinder that stands reaches down to the table, and its top is where its outlines show it."""
    images, true = seen(PARTS[name])
    assert ended(true, images.maps, RIG, TABLE, None) == []
