"""Arrays are checked at birth and stay as they are."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays_of

from stereo_pick.core.arrays import floats, image
from stereo_pick.core.errors import ArrayError, StereoPickError


def test_a_checked_array_is_read_only_and_a_copy() -> None:
    source = np.arange(6).reshape(2, 3)
    array = floats("xyz", source, 2, 3)
    source[0, 0] = 99
    assert array[0, 0] == 0 and array.dtype == np.float64
    with pytest.raises(ValueError, match="read-only"):
        array[0, 0] = 1


@given(st.sampled_from([np.nan, np.inf, -np.inf]), st.integers(0, 3), st.integers(0, 2))
def test_a_value_that_is_not_finite_is_refused_with_its_index(bad: float, row: int, column: int) -> None:
    values = np.zeros((4, 3))
    values[row, column] = bad
    with pytest.raises(ArrayError) as caught:
        floats("covariance", values, None, 3)
    assert "covariance" in str(caught.value) and str([row, column]) in str(caught.value)
    assert str(bad) in str(caught.value)


@given(arrays_of.array_shapes(max_dims=3, max_side=4))
def test_only_the_wanted_shape_passes(shape: tuple[int, ...]) -> None:
    if len(shape) == 2 and shape[1] == 2:
        assert floats("px", np.zeros(shape), None, 2).shape == shape
    else:
        with pytest.raises(ArrayError, match=r"px has shape .* must have \('any', 2\)"):
            floats("px", np.zeros(shape), None, 2)


def test_an_array_error_is_a_value_error_for_users() -> None:
    assert issubclass(ArrayError, ValueError) and issubclass(ArrayError, StereoPickError)


@pytest.mark.parametrize("shape", [(4, 5), (4, 5, 3)])
def test_an_image_is_a_read_only_view(shape: tuple[int, ...]) -> None:
    pixels = np.zeros(shape, np.uint8)
    view = image("left image", pixels)
    assert np.shares_memory(view, pixels) and not view.flags.writeable
    assert pixels.flags.writeable, "the caller's own array must stay as it was"


@pytest.mark.parametrize(
    "pixels",
    [
        np.zeros((4, 5), np.uint16),
        np.zeros((4, 5), np.float32),
        np.zeros((4, 5, 4), np.uint8),
        np.zeros(20, np.uint8),
        np.zeros((0, 5), np.uint8),
    ],
    ids=["16 bit", "float", "four channels", "flat", "empty"],
)
def test_what_is_no_8_bit_image_is_refused_by_name(pixels: np.ndarray) -> None:
    with pytest.raises(ArrayError, match="left image is"):
        image("left image", pixels)
