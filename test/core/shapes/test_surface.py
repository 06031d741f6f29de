"""Lines of sight end on the surface of a solid, before everything else of it."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from rendering.rigs import rotation

from stereo_pick.core.shapes.kinds import KINDS, Round, dot
from stereo_pick.core.shapes.solid_fit import SolidFit
from stereo_pick.core.shapes.surface import entered, facing

SIZES = {
    "sphere": (0.04, 0.04, 0.04),
    "cylinder": (0.04, 0.04, 0.07),
    "box": (0.03, 0.05, 0.07),
    "hexprism": (0.04 * 2 / 3**0.5, 0.04, 0.03),
}
EYE_M = np.array([0.1, 0.0, 0.0])


def placed(kind: str, turn: tuple[float, float, float]) -> SolidFit:
    turned = rotation(np.array(turn))
    return SolidFit(kind, np.array([0.02, -0.03, 0.8]), turned, np.array(SIZES[kind]), 0.1, 1e-8 * np.eye(3))


def farthest(fit: SolidFit, points_m: np.ndarray) -> np.ndarray:
    """By how much the points are farther out than the solid reaches, in the direction where that is most."""
    random = np.random.default_rng(0)
    ways = random.normal(size=(4000, 3))
    if not isinstance(KINDS[fit.kind], Round):
        ways = np.concatenate([ways, *KINDS[fit.kind].beside])
    elif fit.kind == "cylinder":
        around = random.normal(size=(2000, 2))
        ways = np.concatenate([ways, np.c_[around, np.zeros(2000)], np.eye(3)[2:], -np.eye(3)[2:]])
    else:
        ways = np.concatenate([ways, (points_m - fit.centre_m) @ fit.rotation])
    ways /= np.linalg.norm(ways, axis=1, keepdims=True)
    solid = fit.solid
    reach_m = dot(solid.kind.touch(ways[None], solid.half_m)[0], ways)
    return np.asarray(((points_m - fit.centre_m) @ fit.rotation @ ways.T - reach_m).max(axis=1))


turns = st.tuples(*[st.floats(-3, 3)] * 3)


@pytest.mark.parametrize("kind", sorted(SIZES))
@given(turn=turns)
def test_where_a_line_enters_is_on_the_surface_and_nothing_of_the_solid_is_before_it(
    kind: str, turn: tuple[float, float, float]
) -> None:
    fit = placed(kind, turn)
    inner_m = fit.centre_m + np.random.default_rng(1).uniform(-0.3, 0.3, (20, 3)) * fit.size_m @ fit.rotation.T
    ahead = inner_m - EYE_M
    at = entered(fit, EYE_M, ahead)
    assert (at < 1).all() or farthest(fit, inner_m).max() > 0
    assert np.abs(farthest(fit, EYE_M + ahead * at[:, None])).max() < 5e-5
    before = EYE_M + ahead * (at - 0.01)[:, None]
    assert (farthest(fit, before) > 0).all()


@pytest.mark.parametrize("kind", sorted(SIZES))
@given(turn=turns)
def test_a_line_beside_a_solid_misses_it(kind: str, turn: tuple[float, float, float]) -> None:
    fit = placed(kind, turn)
    away = np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]]) * 0.08
    assert np.isnan(entered(fit, EYE_M, fit.centre_m + away - EYE_M)).all()
    assert np.isnan(entered(fit, EYE_M, (EYE_M - fit.centre_m)[None])).all()  # behind the eye


@pytest.mark.parametrize("kind", sorted(SIZES))
@given(turn=turns)
def test_a_surface_faces_the_eye_and_nothing_of_the_solid_is_before_its_plane(
    kind: str, turn: tuple[float, float, float]
) -> None:
    fit = placed(kind, turn)
    inner_m = fit.centre_m + np.random.default_rng(1).uniform(-0.1, 0.1, (20, 3)) * fit.size_m @ fit.rotation.T
    ahead = inner_m - EYE_M
    normal, points_m = facing(fit, EYE_M, ahead), EYE_M + ahead * entered(fit, EYE_M, ahead)[:, None]
    np.testing.assert_allclose(np.linalg.norm(normal, axis=1), 1.0)
    assert (dot(normal, ahead) < 0).all()
    solid = fit.solid
    reach_m = dot(solid.kind.touch((normal @ fit.rotation)[None], solid.half_m)[0], normal @ fit.rotation)
    away_m = dot(points_m - fit.centre_m, normal)
    assert (np.abs(away_m - reach_m) < 1e-4).mean() > 0.9  # but where lines meet a crease


def test_a_box_faces_the_eye_with_its_sides() -> None:
    fit = placed("box", (0.3, -0.2, 0.5))
    sides = np.array([[0.0, 0.0, -1.0], [0.0, 0.0, 1.0]]) @ fit.rotation.T
    toward = sides[int((sides @ (EYE_M - fit.centre_m)).argmax())]
    middle_m = fit.centre_m + toward * fit.size_m[2] / 2
    np.testing.assert_allclose(facing(fit, EYE_M, (middle_m - EYE_M)[None])[0], toward, atol=1e-6)
