"""Creases lie where two faces meet, inside the silhouette, and only where both are seen."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from rigs import RIGS
from solid_outlines import any_part, contours_px, distances_px

from stereo_pick.core.arrays import Floats
from stereo_pick.core.edges.creases import POINTS, Creases, creases
from stereo_pick.core.shapes import SolidFit
from stereo_pick.core.shapes.kinds import KINDS, Prism
from stereo_pick.core.shapes.solids import Solids

RIG = RIGS["verged"]
EYES = np.array([[0.0, 0.0, 0.0], [RIG.baseline_m, 0.0, 0.0]])
ANGULAR = ("cylinder", "box", "hexprism")
SEEDS = st.integers(0, 2**31)


def any_solid(kind: str, seed: int) -> tuple[Solids, tuple[Floats, Floats]]:
    part = any_part(kind, RIG, np.random.default_rng(seed))
    size_m = 2 * part.half_m[list(KINDS[kind].axes)] * KINDS[kind].spans
    return SolidFit(kind, part.centre_m, part.rotation, size_m, 0.1, np.eye(3)).solid, contours_px(part, RIG)


def own_m(solid: Solids, seen: Creases) -> Floats:
    """Points (E, K, 3) [m] in the solid's own axes."""
    return np.asarray(seen.unit[0] * solid.half_m[0, solid.kind.axes])


@pytest.mark.parametrize("kind", ANGULAR)
@given(seed=SEEDS)
def test_creases_appear_inside_the_silhouette(kind: str, seed: int) -> None:
    solid, contours = any_solid(kind, seed)
    inside = creases(solid, EYES)
    for i, camera in enumerate((RIG.left, RIG.right)):
        points = solid.centre_m[0] + own_m(solid, inside)[i] @ solid.rotation[0].T - EYES[i]
        pixels = points[:, :2] / points[:, 2:] * RIG.focal_px + camera.P[:2, 2]
        if inside.seen[0, i].any():
            assert distances_px(pixels[inside.seen[0, i]], contours[i]).min() > -0.05


@pytest.mark.parametrize("kind", ANGULAR)
@given(seed=SEEDS)
def test_a_crease_lies_on_the_two_faces_between_which_it_slides(kind: str, seed: int) -> None:
    """A little way along it, or towards either face, one is on the surface or outside, never within."""
    solid, _ = any_solid(kind, seed)
    inside = creases(solid, EYES)
    points, slide = own_m(solid, inside)[0], inside.slide[0, 0]
    ahead = inside.ahead[0, 0] / np.linalg.norm(inside.ahead[0, 0], axis=1, keepdims=True)
    np.testing.assert_allclose(np.linalg.norm(slide, axis=1), 1.0)
    np.testing.assert_allclose((ahead * slide).sum(axis=1), 0.0, atol=1e-12)
    outward = np.cross(ahead, slide)
    outward *= np.sign((outward * points).sum(axis=1, keepdims=True))
    touched = solid.kind.touch(outward[None], solid.half_m)[0]
    np.testing.assert_allclose((outward * points).sum(axis=1), (outward * touched).sum(axis=1), atol=1e-12)


@given(seed=SEEDS)
def test_of_a_box_an_eye_sees_the_creases_between_the_faces_that_it_sees(seed: int) -> None:
    """Of one face none, of two faces one, of three faces three."""
    solid, _ = any_solid("box", seed)
    eyes = (EYES - solid.centre_m[0]) @ solid.rotation[0]
    faces = (np.abs(eyes) > solid.half_m).sum(axis=1)
    seen = creases(solid, EYES).seen[0].reshape(len(EYES), -1, POINTS)
    assert (seen.all(axis=2) == seen.any(axis=2)).all()
    assert (seen.all(axis=2).sum(axis=1) == np.array([0, 0, 1, 3])[faces]).all()


@given(seed=SEEDS)
def test_of_a_cylinder_the_near_side_of_the_rim_is_seen_of_an_end_of_which_the_face_is(seed: int) -> None:
    solid, _ = any_solid("cylinder", seed)
    eyes = (EYES - solid.centre_m[0]) @ solid.rotation[0]
    inside = creases(solid, EYES)
    faces = np.abs(eyes[:, 2]) > solid.half_m[0, 1]
    beside = np.linalg.norm(eyes[:, :2], axis=1) > solid.half_m[0, 0]
    assert (inside.seen[0].sum(axis=1) == POINTS * (faces & beside)).all()
    for eye, points, seen in zip(eyes, own_m(solid, inside), inside.seen[0]):
        near = points[seen]
        np.testing.assert_allclose(np.linalg.norm(near[:, :2], axis=1), solid.half_m[0, 0])
        assert (near[:, 2] * eye[2] > 0).all() and (near[:, :2] @ (eye[:2] - near[:, :2]).T).diagonal().min(
            initial=1
        ) > 0


def test_a_ball_has_none() -> None:
    solid, _ = any_solid("sphere", 0)
    assert creases(solid, EYES).seen.shape == (1, 2, 0)


@pytest.mark.parametrize(
    "kind", [kind for kind in KINDS.values() if isinstance(kind, Prism)], ids=lambda kind: kind.name
)
def test_each_edge_of_a_prism_lies_on_the_two_faces_that_meet_there(kind: Prism) -> None:
    for normals in kind.beside:
        np.testing.assert_allclose(np.linalg.norm(normals, axis=1), 1.0)
        for corner in kind.edges:
            reach = kind.corners @ normals.T
            np.testing.assert_allclose((kind.corners[corner] * normals).sum(axis=1), reach.max(axis=0))
