"""Grey levels between pixels."""

import numpy as np

from stereo_pick.core.sampling import sampled

RAMP = np.add.outer(2 * np.arange(40), np.arange(60)).astype(np.uint8)


def test_grey_levels_of_a_ramp_are_those_of_its_plane_between_pixels_too() -> None:
    points = np.random.default_rng(0).uniform((0, 0), (59, 39), (50, 7, 2))
    # OpenCV places the points to 1/32 pixel
    np.testing.assert_allclose(sampled(RAMP, points), points[..., 0] + 2 * points[..., 1], atol=3 / 64 + 0.5)


def test_beyond_the_image_its_border_goes_on() -> None:
    assert sampled(RAMP, np.array([[[-9.0, -9.0], [99.0, 99.0]]])).tolist() == [[0.0, 59.0 + 78.0]]


def test_no_number_of_points_is_too_large_or_too_small() -> None:
    many = np.tile([[[3.0, 5.0], [4.0, 5.0]]], (40_000, 1, 1))
    assert (sampled(RAMP, many) == [13.0, 14.0]).all()
    assert sampled(RAMP, np.empty((0, 2, 2))).shape == (0, 2)
