"""How much noise there is in a view."""

from __future__ import annotations

import numpy as np
import pytest
from outlines import pattern

from stereo_pick.core.noise import noise_dn

V, U = np.indices((200, 300), np.float64)


@pytest.mark.parametrize("sigma_dn", [0.5, 1.0, 3.0, 8.0])
def test_the_noise_is_measured_also_on_texture(sigma_dn: float) -> None:
    for contrast in (0.0, 10.0):
        noise = np.random.default_rng(0).normal(0, sigma_dn, U.shape)
        view = pattern(contrast=contrast)(U, V) + noise
        assert noise_dn(view.astype(np.float32)) == pytest.approx(sigma_dn, rel=0.05)


def test_the_noise_is_never_less_than_that_of_whole_grey_levels() -> None:
    assert noise_dn(np.full((50, 50), 7, np.float32)) == pytest.approx(12**-0.5)
