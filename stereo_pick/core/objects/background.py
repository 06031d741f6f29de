"""A model of the empty work surface: what each pixel would show without objects."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stereo_pick.core.arrays import Bools, Floats

_SAMPLES = 3000
_ITERATIONS = 8
_TRIALS = 250
_CHECKED = 200
_TUKEY = 4.685  # 95 % efficient for normal noise
_MIN_SIGMA = 0.6  # rounding to whole grey levels alone, over two samples


@dataclass(frozen=True)
class Background:
    """Grey level (H, W) of the empty surface, and the spread (one sigma, grey levels) around it."""

    level: NDArray[np.float32]
    sigma: float


def fit_background(image: NDArray[np.float32], valid: Bools) -> Background:
    """Fit a quadratic surface to the background, robustly: Tukey's biweight, from a least-median-of-squares start.

    Vignetting and the fall-off of a lamp are smooth; objects are outliers, as long as they cover
    less than about two fifths of the view. image: (H, W) grey; valid: (H, W), the pixels to look at.
    """
    stride_px = max(1, int(np.sqrt(image.size / _SAMPLES)))
    rows, columns = np.nonzero(valid[::stride_px, ::stride_px])
    rows, columns = rows * stride_px, columns * stride_px
    grey = image[rows, columns].astype(np.float64)
    height, width = image.shape
    terms = _terms(columns / width - 0.5, rows / height - 0.5)

    residual = grey - terms @ _start(terms, grey)
    ridge = 1e-6 * len(grey) * np.eye(terms.shape[1])
    for _ in range(_ITERATIONS):
        weight = np.clip(1 - (residual / (_TUKEY * _spread(residual))) ** 2, 0, None) ** 2
        weighted = terms * weight[:, None]
        coefficients = np.linalg.solve(weighted.T @ terms + ridge, weighted.T @ grey)
        residual = grey - terms @ coefficients
    return Background(_surface(coefficients, width, height), _spread(residual))


def _start(terms: Floats, grey: Floats) -> NDArray[np.floating]:
    """The surface through a few samples that leaves the least median residual (Rousseeuw 1984).

    The biweight alone, started from the median, follows large objects on a background that is not even.
    """
    draw = np.random.default_rng(0)  # seeded: the same image must give the same objects
    trial = draw.integers(len(grey), size=(_TRIALS, terms.shape[1]))
    check = draw.integers(len(grey), size=_CHECKED)
    ridge = 1e-9 * np.eye(terms.shape[1])
    surfaces = np.linalg.solve(terms[trial] + ridge, grey[trial][..., None])[..., 0]
    surfaces[0] = [np.median(grey), *[0.0] * (terms.shape[1] - 1)]
    median = np.median(np.abs(grey[check] - surfaces @ terms[check].T), axis=1)
    return np.asarray(surfaces[median.argmin()])


def _terms(u: Floats, v: Floats) -> Floats:
    return np.stack([np.ones_like(u), u, v, u * u, u * v, v * v], axis=-1)


def _surface(c: NDArray[np.floating], width: int, height: int) -> NDArray[np.float32]:
    u, v = np.arange(width) / width - 0.5, np.arange(height) / height - 0.5
    by_row = np.stack([np.ones_like(v), v, v * v], axis=1).astype(np.float32)
    by_column = np.stack([c[0] + c[1] * u + c[3] * u * u, c[2] + c[4] * u, np.full_like(u, c[5])]).astype(np.float32)
    return by_row @ by_column


def _spread(residual: Floats) -> float:
    return max(1.4826 * float(np.median(np.abs(residual))), _MIN_SIGMA)
