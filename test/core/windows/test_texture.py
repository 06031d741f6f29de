"""How wide a window the texture asks for."""

from __future__ import annotations

import numpy as np
import pytest
from outlines import pattern

from stereo_pick.core.windows.texture import predicted_sigma_at, predicted_sigma_px, window_sizes
from stereo_pick.core.windows.window import COSTS, Grey

V, U = np.indices((200, 300), np.float64)


def view(contrast: float, sigma_dn: float, seed: int = 0) -> Grey:
    noise = np.random.default_rng(seed).normal(0, sigma_dn, U.shape)
    return np.asarray(pattern(contrast=contrast)(U, V) + noise, np.float32)


@pytest.mark.parametrize("cost", COSTS)
def test_noise_alone_promises_nothing_and_texture_the_more_the_wider_the_window(cost: str) -> None:
    assert np.mean(predicted_sigma_px(view(0.0, 1.0), 1.0, 15, cost) > 0.15) > 0.99
    textured = [np.median(predicted_sigma_px(view(10.0, 1.0), 1.0, window_px, cost)) for window_px in (7, 15, 31)]
    assert textured == sorted(textured, reverse=True)


@pytest.mark.parametrize("cost", COSTS)
def test_a_point_and_the_map_agree(cost: str) -> None:
    image = view(10.0, 1.0)
    there = predicted_sigma_px(image, 1.0, 11, cost)[100, 150]
    assert predicted_sigma_at(image, np.array([150.0, 100.0]), 1.0, 11, cost) == pytest.approx(there, rel=1e-3)


@pytest.mark.parametrize(("narrowest", "widest"), [(3, 3), (7, 23), (7, 9), (5, 101)])
def test_sizes_are_odd_and_reach_from_the_narrowest_to_the_widest(narrowest: int, widest: int) -> None:
    sizes = window_sizes(narrowest, widest)
    assert sizes[0] == narrowest and sizes[-1] == widest
    assert sizes == sorted(set(sizes)) and all(size % 2 for size in sizes)
