"""Where in a profile of grey levels a surface ends: a blurred step, with the shading of a surface beside it.

The half-way level misplaces the limb of a rounded part by half a pixel: its surface turns away from the light
towards the limb, so the grey level half-way up belongs to a point well inside. Outside of a dark part it is the other
way round: what it stands on lies in its shadow, more so the nearer.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from stereo_pick.core.arrays import Bools, Floats, Ints

STEP_PX = 0.5
OFFSETS_PX = np.arange(-4.0, 4.01, STEP_PX)  # outside to inside
BLURS_PX = tuple(float(blur) for blur in np.geomspace(0.5, 2.0, 18))

_EDGE_STEP_PX = 0.2
_EDGES_PX = np.arange(-1.2, 1.21, _EDGE_STEP_PX)
_FINE_PX = 0.05
_SIDE = 4  # samples that show the level of one side
_PLAIN = 2  # outermost samples on the side without shading that may show something else
_MODELLED_PX = OFFSETS_PX[_PLAIN:]
_FREEDOM = len(_MODELLED_PX) - 4
# Behind the edge of a flat face the light changes linearly with the distance, behind the limb of a round one with
# its square root (Lambert): one power for both.
SHADING_POWER = 0.75


@dataclass(frozen=True, eq=False)
class Edges:
    """What N profiles show: place_px (N,), where along OFFSETS_PX the surface ends; step (N,), by how much it is
    brighter there than what is outside [grey levels]; sharpness (N,), the part of the change of light that happens
    there at once, 1 at the edge of a flat face, about one half at the limb of a round part, near 0 where light
    merely fades on a surface, negative where the inside is the darker one; squares (N,), what the model leaves;
    spread_px (N,), one sigma of the place, where it is known."""

    place_px: Floats
    step: Floats
    sharpness: Floats
    squares: Floats
    spread_px: Floats | float = 0.0


def find_edges(profiles: Floats, blur_px: float, part: Ints | None = None) -> Edges:
    """Explain profiles (N, len(OFFSETS_PX)) by least squares: the level outside, a step, the shading behind it;
    or before it, where that explains more of the edge of a dark part.

    part: the number (N,) of the part that each belongs to, of one and the same where it is not given.
    """
    if part is None:
        part = np.zeros(len(profiles), np.int64)
    edges = _shaded_behind(profiles[:, _PLAIN:], blur_px)
    darker = np.flatnonzero((edges.step < 0) & _is_dark(edges, part))
    if not len(darker):
        return edges
    before = _shaded_behind(profiles[darker, ::-1][:, _PLAIN:], blur_px)
    better = before.squares < edges.squares[darker]
    turned = -before.place_px, -before.step, -before.sharpness, before.squares
    for known, other in zip((edges.place_px, edges.step, edges.sharpness, edges.squares), turned):
        known[darker[better]] = other[better]
    return edges


def _is_dark(edges: Edges, part: Ints) -> Bools:
    """Whether most edges of the part that each (N,) belongs to are darker inside."""
    return np.asarray((np.bincount(part, np.sign(edges.step)) < 0)[part])


def _shaded_behind(profiles: Floats, blur_px: float) -> Edges:
    """The same of profiles (N, len(_MODELLED_PX)) with shading behind the step, for each of a grid of places."""
    model = _model(blur_px)
    change = profiles - profiles.mean(axis=1, keepdims=True)
    first, second = change @ model.first, change @ model.second
    squares = (change * change).sum(axis=1)[:, None] - first * first - second * second
    best = np.minimum(np.maximum(squares.argmin(axis=1), 1), len(_EDGES_PX) - 2)
    place = np.arange(0, squares.size, len(_EDGES_PX)) + best  # in the flat arrays
    before, at, after = squares.take(place - 1), squares.take(place), squares.take(place + 1)
    part = vertex(before, at, after)
    least = np.maximum(at, 0.0)
    first, second, (by_first, by_second, shades) = first.take(place), second.take(place), model.solve.take(best, axis=1)
    step, shading = by_first * first + by_second * second, shades * second
    noise = 3 * np.sqrt(least / _FREEDOM)
    sharpness = step / (np.abs(step) + np.abs(shading) + noise + 1e-9)
    return Edges(_EDGES_PX[best] + part * _EDGE_STEP_PX, step, sharpness, least)


def vertex(before: Floats, at: Floats, after: Floats) -> Floats:
    """Where (N,) the parabola through three neighbouring values is lowest, in steps from the middle one; at most 1."""
    bend = before - 2 * at + after
    return np.minimum(np.maximum(0.5 * (before - after) / np.where(bend > 0, bend, np.inf), -1.0), 1.0)


def nearest_blur_px(blur_px: float) -> float:
    """The blur nearest to this one for which there are models."""
    blur_px = max(blur_px, BLURS_PX[0])
    return min(BLURS_PX, key=lambda modelled: abs(np.log(modelled / blur_px)))


def best_blur_px(profiles: Floats) -> float:
    """The blur (one sigma) with which these profiles (N, len(OFFSETS_PX)) are explained best, all together."""
    best = _explained(profiles[:, _PLAIN:])
    darker = profiles[:, -_SIDE:].sum(axis=1) < profiles[:, :_SIDE].sum(axis=1)
    best[darker] = np.maximum(best[darker], _explained(profiles[darker, ::-1][:, _PLAIN:]))
    return BLURS_PX[int(best.sum(axis=0).argmax())]


def _explained(profiles: Floats) -> NDArray[np.float32]:
    """How much (N, len(BLURS_PX)) of profiles (N, len(_MODELLED_PX)) shading behind a step explains with each blur."""
    change = (profiles - profiles.mean(axis=1, keepdims=True)).astype(np.float32)
    first, second = _all_models()
    explained = (change @ first) ** 2 + (change @ second) ** 2
    return np.asarray(explained.reshape(len(change), len(_EDGES_PX) - 2, len(BLURS_PX)).max(axis=1))


@dataclass(frozen=True, eq=False)
class _Model:
    """What a profile may show less its mean, for each of E places of the edge: first, second: (M, E), orthonormal
    bases; solve: (3, E), by which a profile's components a, b give its step, solve[0] a + solve[1] b, and its
    shading over all of the inside, solve[2] b."""

    first: Floats
    second: Floats
    solve: Floats


@lru_cache(maxsize=len(BLURS_PX) + 1)
def _model(blur_px: float) -> _Model:
    bases, solve = [], []
    for place_px in _EDGES_PX:
        inside = _MODELLED_PX - place_px
        shading = blurred(SHADING_POWER, inside, blur_px) / inside[-1] ** SHADING_POWER
        model = np.stack([blurred(0.0, inside, blur_px), shading], axis=1)
        basis, triangle = np.linalg.qr(model - model.mean(axis=0))
        bases.append(basis)
        solve.append(np.linalg.inv(triangle)[[0, 0, 1], [0, 1, 1]])
    first, second = np.stack(bases, axis=2).transpose(1, 0, 2)
    return _Model(first, second, np.stack(solve, axis=1))


@lru_cache(maxsize=1)
def _all_models() -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Bases (M, E' B) of all blurs for the places inside the grid, blur by blur for each place."""
    models = [_model(blur_px) for blur_px in BLURS_PX]
    first = np.stack([model.first[:, 1:-1] for model in models], axis=2)
    second = np.stack([model.second[:, 1:-1] for model in models], axis=2)
    return first.reshape(len(first), -1).astype(np.float32), second.reshape(len(second), -1).astype(np.float32)


def blurred(power: float, at_px: Floats, blur_px: float) -> Floats:
    """`distance ** power` inside the edge, nothing outside, seen through a Gaussian blur."""
    reach = int(np.ceil(4 * blur_px / _FINE_PX))
    spread = (np.arange(-reach, reach) + 0.5) * _FINE_PX  # no edge lies on one of these
    weight = np.exp(-0.5 * (spread / blur_px) ** 2)
    distance = np.maximum(at_px[:, None] - spread, 0.0)
    grown = np.where(at_px[:, None] > spread, distance**power, 0.0)
    return np.asarray(grown @ (weight / weight.sum()))
