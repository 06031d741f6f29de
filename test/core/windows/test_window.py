"""Windows compared to a part of a pixel."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from outlines import pattern

from stereo_pick.core.arrays import Floats
from stereo_pick.core.windows.window import COSTS, Grey, factor, misfit_along_row, window_at

U, V = np.meshgrid(np.arange(640.0), np.arange(360.0))


@cache
def textured(shift_px: float) -> Floats:
    return pattern()(U + shift_px, V)


def views(shift_px: float, noise_dn: float = 1.0) -> tuple[Grey, Grey]:
    """A textured plane in two views; what the left one shows at u the right one shows at u - shift."""
    rng = np.random.default_rng(2)
    left, right = (np.round(textured(s) + rng.normal(0, noise_dn, U.shape)) for s in (0.0, shift_px))
    return left.astype(np.float32), right.astype(np.float32)


@pytest.mark.parametrize("window_px", [3, 9, 15])
@pytest.mark.parametrize("cost", COSTS)
def test_the_misfit_is_what_its_definition_says(cost: str, window_px: int) -> None:
    """Equation 3.8 a pixel; and (1 - r²) of the window's variance, where the gain is within its bounds."""
    left, right = views(20.0)
    here, half = np.array([300.0, 200.0]), window_px // 2
    along = misfit_along_row(left, right, here, window_px, cost)
    assert along.shape == (640,) and int(along[half:-half].argmin()) + half == 280
    one = left[200 - half : 201 + half, 300 - half : 301 + half].astype(np.float64)
    for column in (half, 100, 280, 639 - half):
        other = right[200 - half : 201 + half, column - half : column + half + 1]
        if cost == "ssd":
            assert along[column] == pytest.approx(((one - other) ** 2).mean(), rel=1e-3, abs=0.05)
            continue
        correlation = np.corrcoef(one.ravel(), other.ravel())[0, 1]
        gain = correlation * one.std() / other.std()
        if 1 / 1.5 < gain < 1.5:
            assert along[column] == pytest.approx(one.var() * (1 - correlation**2), rel=1e-3, abs=0.05)
        else:
            assert along[column] >= one.var() * (1 - correlation**2) - 0.05


def test_zncc_forgives_gain_and_offset_and_ssd_does_not() -> None:
    left, right = views(20.0, noise_dn=0.0)
    here, darker = np.array([300.0, 200.0]), 0.75 * right - 30
    zncc, ssd = (misfit_along_row(left, darker, here, 15, cost) for cost in COSTS)
    assert int(zncc.argmin()) == 280 and zncc.min() < 0.5
    assert ssd[280] > 1000


def test_a_misfit_of_mere_rounding_is_no_better_than_none() -> None:
    assert factor(0.1, 0.0) == 1 and factor(3.0, 0.0) > 10


def test_a_window_between_pixels_is_bilinear() -> None:
    image = np.arange(400, dtype=np.float32).reshape(20, 20)
    assert window_at(image, np.array([5.25, 7.5]), 1)[0, 0] == pytest.approx(7.5 * 20 + 5.25)
    assert window_at(image, np.array([8.0, 9.0]), 5, 3).shape == (3, 5)
