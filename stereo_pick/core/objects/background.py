"""A model of the empty work surface: what each pixel would show without objects."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from statistics import NormalDist
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from stereo_pick.core.arrays import Bools, Floats, Ints

Window = tuple[slice, slice]

_SAMPLES = 3000
_MAX_ITERATIONS = 8
_CONVERGED = 0.1  # sigmas of the background, everywhere
_TRIALS = 250
_CHECKED = 200
_TUKEY = 4.685  # 95 % efficient for normal noise
_MIN_SIGMA = 0.6  # rounding to whole grey levels alone, over two samples
_TERMS = 6
_PLANE = 3  # of the terms
_HALF, _THIRD = 0.5, 1 / 3  # of the view, at least, that a background covers
CLEARLY_TIGHTER = 2.0
_FEW = 3  # one in so many samples is enough for most of the iterations


class EmptySurface(Protocol):
    """What a view would show without objects, and the spread (one sigma, grey levels) around it."""

    @property
    def sigma(self) -> float:
        """One sigma [grey levels]."""
        ...

    def at(self, window: Window, above: float = 0.0) -> NDArray[np.float32]:
        """Grey level of the empty surface in a window of the image, raised by `above`."""
        ...


@dataclass(frozen=True, eq=False)
class Background:
    """A quadratic surface of grey levels over an image of shape (H, W), by its coefficients (6,), and the spread (one
    sigma, grey levels) around it."""

    coefficients: NDArray[np.floating]
    shape: tuple[int, int]
    sigma: float

    @property
    def level(self) -> NDArray[np.float32]:
        """Grey level (H, W) of the empty surface."""
        return self.at(np.s_[:, :])

    def at(self, window: Window, above: float = 0.0) -> NDArray[np.float32]:
        """Grey level of the empty surface in a window of the image, raised by `above`."""
        by_row, u = _axes(self.shape)
        c, u = self.coefficients, u[window[1]]
        by_column = np.stack([c[0] + above + u * (c[1] + c[3] * u), c[2] + c[4] * u, np.full_like(u, c[5])])
        return by_row[window[0]] @ by_column.astype(np.float32)


@dataclass(frozen=True, eq=False)
class _Samples:
    """Where the background is looked at, and all of the fit that does not depend on the grey levels there.

    index: (N,) into the flat image; terms: (N, 6); quadratics, planes: trial surfaces; check: (C,) samples that judge
    them.
    """

    index: Ints
    terms: Floats
    quadratics: _Trials
    planes: _Trials
    check: Ints


@dataclass(frozen=True, eq=False)
class _Trials:
    """Trial surfaces of K terms: samples (T, K) that make one each, and solve (T, K, K), the surface through them."""

    samples: Ints
    solve: Floats

    @staticmethod
    def of(terms: Floats, draw: np.random.Generator) -> _Trials:
        samples = draw.integers(len(terms), size=(_TRIALS, terms.shape[1]))
        return _Trials(samples, np.asarray(np.linalg.pinv(terms[samples]), np.float64))  # some samples are in a line


def grid_stride_px(shape: tuple[int, ...]) -> int:
    """How far apart the samples are from which a view's background is found."""
    return max(1, int(np.sqrt(np.prod(shape) / _SAMPLES)))


def even_background(level: float, shape: tuple[int, ...]) -> Background:
    """The same level everywhere, and a spread of one grey level."""
    height, width = shape
    return Background(np.array([level, *[0.0] * (_TERMS - 1)]), (height, width), 1.0)


def fit_background(image: NDArray[np.float32], valid: Bools) -> Background:
    """Fit a quadratic surface to the background, robustly: Tukey's biweight, from a least-median-of-squares start.

    Vignetting and the fall-off of a lamp are smooth; objects are outliers, as long as they cover less than about two
    fifths of the view. Where the table ends within the view, neither it nor what lies beyond need cover half: a third
    is believed where it is clearly smoother. image: (H, W) grey; valid: (H, W), the pixels to look at.
    """
    height, width = image.shape
    stride_px = grid_stride_px(image.shape)
    samples = _samples((height, width), stride_px, valid[::stride_px, ::stride_px].tobytes())
    grey = image.reshape(-1)[samples.index].astype(np.float64)
    half, half_sigma = _fitted(samples, samples.quadratics, grey, _HALF)
    if half_sigma <= CLEARLY_TIGHTER * _MIN_SIGMA:
        return Background(half, (height, width), half_sigma)
    third, third_sigma = _fitted(samples, samples.planes, grey, _THIRD)
    if third_sigma * CLEARLY_TIGHTER < half_sigma:
        residual = grey - samples.terms @ third
        own = residual[np.abs(residual) < _TUKEY * third_sigma]
        return Background(third, (height, width), spread(own))
    return Background(half, (height, width), half_sigma)


def _fitted(samples: _Samples, trials: _Trials, grey: Floats, least_part: float) -> tuple[NDArray[np.floating], float]:
    """Coefficients (6,) of the surface that explains at least a part of the grey levels (N,), and its sigma."""
    coefficients = _start(samples, trials, grey, least_part)
    for part in (np.s_[::_FEW], np.s_[:]):
        coefficients = refined(coefficients, samples.terms[part], grey[part], least_part)
    return coefficients, spread(grey - samples.terms @ coefficients, least_part)


def refined(
    coefficients: NDArray[np.floating], terms: Floats, grey: Floats, least_part: float = _HALF
) -> NDArray[np.floating]:
    """Coefficients of terms (N, T) that explain N grey levels, by Tukey's biweight, from a first guess of them."""
    ridge = 1e-6 * len(grey) * np.eye(terms.shape[1])
    for _ in range(_MAX_ITERATIONS):
        residual = grey - terms @ coefficients
        sigma = spread(residual, least_part)
        weight = np.maximum(1 - (residual / (_TUKEY * sigma)) ** 2, 0) ** 2
        weighted = terms.T * weight
        before, coefficients = coefficients, np.linalg.solve(weighted @ terms + ridge, weighted @ grey)
        if np.abs(coefficients - before).sum() < _CONVERGED * sigma:
            break
    return coefficients


def _start(samples: _Samples, trials: _Trials, grey: Floats, least_part: float) -> NDArray[np.floating]:
    """The surface through a few samples that leaves the least residual in a part of the view (Rousseeuw 1984).

    The biweight alone, started from the median, follows large objects on a background that is not even.
    """
    surfaces = np.zeros((_TRIALS, _TERMS))
    surfaces[:, : trials.solve.shape[2]] = (trials.solve * grey[trials.samples][:, None]).sum(axis=2)
    surfaces[0] = [_quantile(grey, _HALF), *[0.0] * (_TERMS - 1)]
    seen = samples.terms[samples.check].T.astype(np.float32)
    residual = np.abs(surfaces.astype(np.float32) @ seen - grey[samples.check].astype(np.float32))
    last = int(least_part * _CHECKED)
    return np.asarray(surfaces[np.partition(residual, last, axis=1)[:, last].argmin()])


@lru_cache(maxsize=8)
def _samples(shape: tuple[int, int], stride_px: int, valid: bytes) -> _Samples:
    """A grid of one sample each stride_px; valid: (h, w) bool, which of them to look at."""
    rows, columns = (np.arange(0, size, stride_px) for size in shape)
    at = np.flatnonzero(np.frombuffer(valid, np.bool_))
    y, x = rows[at // len(columns)], columns[at % len(columns)]
    u, v = x / shape[1] - 0.5, y / shape[0] - 0.5
    terms = np.stack([np.ones_like(u), u, v, u * u, u * v, v * v], axis=-1)
    draw = np.random.default_rng(0)  # seeded: the same image must give the same objects
    quadratics, check = _Trials.of(terms, draw), draw.integers(len(at), size=_CHECKED)
    return _Samples(y * shape[1] + x, terms, quadratics, _Trials.of(terms[:, :_PLANE], draw), check)


@lru_cache(maxsize=8)
def _axes(shape: tuple[int, int]) -> tuple[NDArray[np.float32], Floats]:
    """Powers 0 to 2 (H, 3) of the row's place, and the column's place (W,), both from -0.5 to 0.5."""
    v, u = (np.arange(size) / size - 0.5 for size in shape)
    return np.stack([np.ones_like(v), v, v * v], axis=1).astype(np.float32), u


def spread(residual: Floats, least_part: float = _HALF) -> float:
    """One sigma of residuals (N,) of which at least a part is normal; not less than that of rounding."""
    return max(_quantile(np.abs(residual), least_part) / _normal(least_part), _MIN_SIGMA)


@lru_cache(maxsize=2)
def _normal(part: float) -> float:
    """Within how many sigmas this part of normal residuals lies."""
    return NormalDist().inv_cdf((1 + part) / 2)


def _quantile(values: Floats, part: float) -> float:
    at = int(part * len(values))
    return float(np.partition(values, at)[at])
