"""What edges say of solids, on rendered scenes."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from rendered_solids import PARTS, PLACED, RIG, rectified, solid_of
from rendering import Scene

from stereo_pick.core.arrays import Floats
from stereo_pick.core.edges.arcs import usual_sigma_px
from stereo_pick.core.edges.edge_evidence import EdgeEvidence, edges_seen
from stereo_pick.core.edges.hypotheses import Images
from stereo_pick.core.shapes.kinds import dot
from stereo_pick.core.shapes.solids import Solids

SCENE = Scene(tuple(PARTS.values()), PLACED, ambient=0.6)


@cache
def images(empty: bool = False) -> Images:
    return Images(rectified(RIG, Scene((), PLACED) if empty else SCENE))


def evidence(solid: Solids, empty: bool = False) -> EdgeEvidence:
    seen = edges_seen([solid], images(empty).maps, RIG)[0]
    return seen.evidence(usual_sigma_px(seen.scale_px, seen.shown))


def step(seen: EdgeEvidence) -> Floats:
    """What to add to a solid's unknowns (P,), were they known no better before, and had no camera turned."""
    normal, right = seen.normal[0, :-2, :-2], seen.right[0, :-2]
    return np.asarray(-np.linalg.solve(normal + np.eye(len(right)), right))


@pytest.mark.parametrize("name", PARTS)
def test_a_part_that_is_there_is_shown_all_around_and_inside(name: str) -> None:
    seen = evidence(solid_of(RIG, SCENE, PARTS[name]))
    assert seen.shown[0] > 0.92 and seen.creased[0] > 0.6 and seen.scale_px[0] < 0.15
    assert np.abs(step(seen)[:3]).max() < 3e-4


@pytest.mark.parametrize("name", ["standing", "box"])
def test_one_that_is_not_there_is_not(name: str) -> None:
    seen = evidence(solid_of(RIG, SCENE, PARTS[name]), empty=True)
    assert seen.shown[0] < 0.3 and seen.creased[0] < 0.3


@pytest.mark.parametrize("name", PARTS)
def test_edges_beside_a_silhouette_deny_it(name: str) -> None:
    """One 0.8 px larger all around lies beside the part's edges."""
    solid = solid_of(RIG, SCENE, PARTS[name])
    larger = replace(solid, half_m=solid.half_m + 0.8 * solid.centre_m[0, 2] / RIG.focal_px)
    assert evidence(solid).denied[0] < 0.05
    assert evidence(larger).denied[0] > 0.5


@pytest.mark.parametrize("name", PARTS)
@pytest.mark.parametrize("axis", range(3))
def test_the_step_leads_back(name: str, axis: int) -> None:
    """From 0.3 mm off to either side, most of the way between the two comes back at once, also in depth."""
    solid, off_m = solid_of(RIG, SCENE, PARTS[name]), 3e-4 * np.eye(3)[axis]
    back = [step(evidence(replace(solid, centre_m=solid.centre_m + sign * off_m)))[:3] for sign in (1, -1)]
    assert (back[1] - back[0])[axis] == pytest.approx(6e-4, rel=0.5 if axis == 2 else 0.1)


@pytest.mark.parametrize("name", PARTS)
def test_a_rounded_part_reaches_as_far_as_balls_around_a_smaller_one(name: str) -> None:
    """By the supports of both themselves, not by derivatives; round ones are polygons where they are measured."""
    solid, radius_m = solid_of(RIG, SCENE, PARTS[name]), 1e-3
    jacobian = edges_seen([solid], images().maps, RIG)[0].outer.jacobian
    across = jacobian[..., :3] @ solid.rotation
    sharp, smaller = (dot(across, solid.kind.touch(across, half)) for half in (solid.half_m, solid.half_m - radius_m))
    further_px = smaller + radius_m * np.linalg.norm(across, axis=-1) - sharp
    np.testing.assert_allclose(jacobian[..., -3] * radius_m, further_px, atol=0.02)
    assert (further_px < 1e-9).all() and (name == "sphere" or further_px.min() < -0.3)


def test_the_less_of_a_silhouette_shows_the_less_is_known() -> None:
    """Half of a cylinder longer than the part lies on nothing."""
    solid = solid_of(RIG, SCENE, PARTS["standing"])
    longer = replace(solid, half_m=solid.half_m * (1, 1.8), centre_m=solid.centre_m)
    right, wrong = evidence(solid), evidence(longer)
    assert wrong.shown[0] < 0.8 * right.shown[0]
    assert wrong.normal[0, 0, 0] < 0.5 * right.normal[0, 0, 0]
