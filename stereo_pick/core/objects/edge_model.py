"""Where in a profile of grey levels a surface ends: a blurred step, with the shading of the surface behind it.

The half-way level misplaces the limb of a rounded part by half a pixel: its surface turns away from the light
towards the limb, so the grey level half-way up belongs to a point well inside.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from stereo_pick.core.arrays import Floats

STEP_PX = 0.5
OFFSETS_PX = np.arange(-3.0, 4.01, STEP_PX)  # outside to inside
BLURS_PX = tuple(float(blur) for blur in np.geomspace(0.5, 2.0, 18))

_EDGE_STEP_PX = 0.2
_EDGES_PX = np.arange(-1.2, 1.21, _EDGE_STEP_PX)
_FINE_PX = 0.05
_FREEDOM = len(OFFSETS_PX) - 4
# Behind the edge of a flat face the light changes linearly with the distance, behind the limb of a round one with
# its square root (Lambert): one power for both.
_SHADING_POWER = 0.75


@dataclass(frozen=True, eq=False)
class Edges:
    """What N profiles show: place_px (N,), where along OFFSETS_PX the surface ends; step (N,), by how much it is
    brighter there than what is outside [grey levels]; sharpness (N,), the part of the change of light that happens
    there at once, 1 at the edge of a flat face, about one half at the limb of a round part, near 0 where light
    merely fades on a surface, negative where the inside is the darker one; squares (N,), what the model leaves."""

    place_px: Floats
    step: Floats
    sharpness: Floats
    squares: Floats


def find_edges(profiles: Floats, blur_px: float) -> Edges:
    """Explain profiles (N, len(OFFSETS_PX)) by least squares: the level outside, a step, the shading behind it, for
    each of a grid of places."""
    model = _model(blur_px)
    change = profiles - profiles.mean(axis=1, keepdims=True)
    first, second = change @ model.first, change @ model.second
    squares = (change**2).sum(axis=1)[:, None] - first**2 - second**2
    best = np.clip(squares.argmin(axis=1), 1, len(_EDGES_PX) - 2)
    row = np.arange(len(best))
    before, at, after = squares[row, best - 1], squares[row, best], squares[row, best + 1]
    bend = before - 2 * at + after
    part = np.clip(0.5 * (before - after) / np.where(bend > 0, bend, np.inf), -1.0, 1.0)
    least = np.maximum(at, 0.0)
    first, second, solve = first[row, best], second[row, best], model.solve[best]
    step, shading = solve[:, 0] * first + solve[:, 1] * second, solve[:, 2] * second
    noise = 3 * np.sqrt(least / _FREEDOM)
    sharpness = step / (np.abs(step) + np.abs(shading) + noise + 1e-9)
    return Edges(_EDGES_PX[best] + part * _EDGE_STEP_PX, step, sharpness, least)


def best_blur_px(profiles: Floats) -> float:
    """The blur (one sigma) with which these profiles (N, len(OFFSETS_PX)) are explained best, all together."""
    change = (profiles - profiles.mean(axis=1, keepdims=True)).astype(np.float32)
    first, second = _all_models()
    explained = (change @ first) ** 2 + (change @ second) ** 2
    best = explained.reshape(len(change), -1, len(BLURS_PX)).max(axis=1)
    return BLURS_PX[int(best.sum(axis=0).argmax())]


@dataclass(frozen=True, eq=False)
class _Model:
    """What a profile may show less its mean, for each of E places of the edge: first, second: (M, E), orthonormal
    bases; solve: (E, 3), by which a profile's components a, b give its step, solve[0] a + solve[1] b, and its
    shading over all of the inside, solve[2] b."""

    first: Floats
    second: Floats
    solve: Floats


@lru_cache(maxsize=len(BLURS_PX))
def _model(blur_px: float) -> _Model:
    bases, solve = [], []
    for place_px in _EDGES_PX:
        inside = OFFSETS_PX - place_px
        shading = _blurred(_SHADING_POWER, inside, blur_px) / inside[-1] ** _SHADING_POWER
        model = np.stack([_blurred(0.0, inside, blur_px), shading], axis=1)
        basis, triangle = np.linalg.qr(model - model.mean(axis=0))
        bases.append(basis)
        solve.append(np.linalg.inv(triangle)[[0, 0, 1], [0, 1, 1]])
    first, second = np.stack(bases, axis=2).transpose(1, 0, 2)
    return _Model(first, second, np.stack(solve))


@lru_cache(maxsize=1)
def _all_models() -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Bases (M, E' B) of all blurs for the places inside the grid, blur by blur for each place."""
    models = [_model(blur_px) for blur_px in BLURS_PX]
    first = np.stack([model.first[:, 1:-1] for model in models], axis=2)
    second = np.stack([model.second[:, 1:-1] for model in models], axis=2)
    return first.reshape(len(first), -1).astype(np.float32), second.reshape(len(second), -1).astype(np.float32)


def _blurred(power: float, at_px: Floats, blur_px: float) -> Floats:
    """`distance ** power` inside the edge, nothing outside, seen through a Gaussian blur."""
    reach = int(np.ceil(4 * blur_px / _FINE_PX))
    spread = (np.arange(-reach, reach) + 0.5) * _FINE_PX  # no edge lies on one of these
    weight = np.exp(-0.5 * (spread / blur_px) ** 2)
    distance = np.maximum(at_px[:, None] - spread, 0.0)
    grown = np.where(at_px[:, None] > spread, distance**power, 0.0)
    return np.asarray(grown @ (weight / weight.sum()))
