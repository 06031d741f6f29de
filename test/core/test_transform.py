"""Laws of rigid transforms."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from rigs import rotation

from stereo_pick.core.errors import ArrayError
from stereo_pick.core.transform import Transform

COORDINATES = st.tuples(*[st.floats(-3, 3)] * 3)
TRANSFORMS = st.builds(lambda r, t: Transform(rotation(r), np.array(t)), COORDINATES, COORDINATES)


def same(one: Transform, other: Transform) -> bool:
    return np.allclose(one.rotation, other.rotation, atol=1e-9) and np.allclose(
        one.translation, other.translation, atol=1e-9
    )


@given(TRANSFORMS, COORDINATES)
def test_the_inverse_undoes(a_T_b: Transform, point: tuple[float, float, float]) -> None:
    assert same(a_T_b @ a_T_b.inverse(), Transform.identity())
    assert same(a_T_b.inverse() @ a_T_b, Transform.identity())
    np.testing.assert_allclose(a_T_b.inverse().apply(a_T_b.apply(point)), point, atol=1e-9)


@given(TRANSFORMS, TRANSFORMS, TRANSFORMS)
def test_composition_is_associative(a: Transform, b: Transform, c: Transform) -> None:
    assert same((a @ b) @ c, a @ (b @ c))


@given(TRANSFORMS, TRANSFORMS, COORDINATES)
def test_composed_is_one_after_the_other(a_T_b: Transform, b_T_c: Transform, point: tuple[float, ...]) -> None:
    np.testing.assert_allclose((a_T_b @ b_T_c).apply(point), a_T_b.apply(b_T_c.apply(point)), atol=1e-9)


@given(TRANSFORMS, COORDINATES, COORDINATES)
def test_distances_are_kept(a_T_b: Transform, one: tuple[float, ...], other: tuple[float, ...]) -> None:
    moved = np.linalg.norm(a_T_b.apply(one) - a_T_b.apply(other))
    assert moved == pytest.approx(np.linalg.norm(np.subtract(one, other)), abs=1e-9)


def test_points_of_any_leading_shape_are_moved_alike() -> None:
    a_T_b = Transform(rotation((0.1, -0.4, 0.7)), np.array([1.0, 2.0, 3.0]))
    points = np.random.default_rng(0).normal(size=(4, 5, 3))
    expected = [[a_T_b.rotation @ point + a_T_b.translation for point in row] for row in points]
    np.testing.assert_allclose(a_T_b.apply(points), expected)


@pytest.mark.parametrize(
    "matrix", [np.diag([1.0, 1.0, -1.0]), 1.01 * np.eye(3), np.zeros((3, 3)), np.ones((3, 3))],
    ids=["mirror", "scaled", "zero", "singular"],
)  # fmt: skip
def test_what_is_no_rotation_is_refused(matrix: np.ndarray) -> None:
    with pytest.raises(ArrayError, match="not a rotation matrix: .* must be at most 0.001; det = .*, must be 1"):
        Transform(matrix, np.zeros(3))


def test_a_transform_cannot_be_changed() -> None:
    transform = Transform.identity()
    with pytest.raises(ValueError, match="read-only"):
        transform.translation[0] = 1.0
