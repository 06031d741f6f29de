"""A window's place in the other view to a part of a pixel, with the slant of the surface that it shows."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from stereo_pick.core.arrays import Floats
from stereo_pick.core.correspondence.window import Grey

_MAX_ITERATIONS = 8
_MAX_STEP_PX = 0.5
_CONVERGED_PX = 5e-3
_SLANT_SIGMA = 0.3  # change of disparity along a row and from row to row, before anything was measured
_MAX_SLANT = 0.7
_GAIN_SIGMA = 0.5
_OFFSET_SIGMA_DN = 50.0
_CHUNK_SAMPLES = 1 << 17  # that fit into a cache
_TINY = 1e-6


@dataclass(frozen=True)
class WindowFits:
    """Where N windows lie in the other view.

    column_px: (N,); sigma_px: (N,), one sigma of it by residual and texture, inf without texture; similarity: (N,),
    part of the window's own variation that the match explains (1 all, 0 none).
    """

    column_px: Floats
    sigma_px: Floats
    similarity: Floats


def refine(
    views: tuple[Grey, Grey],
    points_px: Floats,
    columns_px: Floats,
    window_px: int,
    cost: str,
    centres_px: Floats | None = None,
) -> WindowFits:
    """Move windows of the second view along their rows to where they fit those around `points_px` (N, 2) of the first.

    Gauss-Newton from `columns_px` (N,) (Lucas and Kanade 1981) over the place, the slant (how the disparity changes
    along the row and from row to row) and, for the cost `zncc`, gain and offset. The gradient is the mean of both
    windows': a parabola through three SSD values locks to whole pixels, and the gradient of one window alone is biased
    by the other's noise. `centres_px` (N, 2): middles of the windows, where they are not the points themselves.
    """
    if not len(points_px):
        return WindowFits(np.empty(0), np.empty(0), np.empty(0))
    centres = points_px if centres_px is None else centres_px
    step = max(1, _CHUNK_SAMPLES // window_px**2)
    parts = []
    for start in range(0, len(points_px), step):
        some = slice(start, start + step)
        fit = _Fit(views, points_px[some], columns_px[some], centres[some], window_px, free_gain=cost == "zncc")
        parts.append(fit.run())
    return WindowFits(*(np.concatenate(each) for each in zip(*parts)))


class _Fit:
    """The windows (N, h, w) around N points of one view, and where they were moved to in the other.

    state: (N, 3), column [px], and change of the column along and across the row beyond that of an upright surface.
    """

    def __init__(
        self,
        views: tuple[Grey, Grey],
        points_px: Floats,
        columns_px: Floats,
        centres_px: Floats,
        window_px: int,
        free_gain: bool,
    ) -> None:
        one, self.other = views
        half = window_px // 2
        along, across = np.arange(-half - 1, half + 2, dtype=np.float32), np.arange(-half, half + 1, dtype=np.float32)
        shift = (centres_px - points_px).astype(np.float32)
        self.i = along + shift[:, 0, None, None]  # (N, 1, w + 2) and (N, h, 1), from the point
        self.j = across[:, None] + shift[:, 1, None, None]
        self.rows = points_px[:, 1, None, None].astype(np.float32) + self.j
        wide = _sample(one, points_px[:, 0, None, None].astype(np.float32) + self.i, self.rows)
        self.a, self.gradient_a = wide[..., 1:-1], _slope(wide)
        self.free_gain = free_gain
        if free_gain:
            self.a = self.a - _mean(self.a)
            self.power = _mean(self.a * self.a)
        self.state = np.zeros((len(points_px), 3))
        self.state[:, 0] = columns_px

    def run(self) -> tuple[Floats, Floats, Floats]:
        """Columns, sigmas and similarities (N,)."""
        moving = np.arange(len(self.state))
        for _ in range(_MAX_ITERATIONS):
            step = _System(self, moving).step()
            step[:, 0] = np.clip(step[:, 0], -_MAX_STEP_PX, _MAX_STEP_PX)
            self.state[moving] += step
            self.state[:, 1:] = np.clip(self.state[:, 1:], -_MAX_SLANT, _MAX_SLANT)
            moving = moving[np.abs(step[:, 0]) >= _CONVERGED_PX]
            if not len(moving):
                break
        return self.state[:, 0], *_System(self, np.arange(len(self.state))).quality()


class _System:
    """The linearised least squares of some of the windows: `misfit` (N, S) by `jacobian` (N, P, S).

    Unknowns: place, slant along and across the row; gain and offset, where they are free.
    """

    def __init__(self, fit: _Fit, some: np.ndarray) -> None:
        column, along, across = (fit.state[some, k, None, None].astype(np.float32) for k in range(3))
        i, j, a = fit.i[some], fit.j[some], fit.a[some]
        wide = _sample(fit.other, column + i * (1 + along) + j * across, fit.rows[some])
        b = wide[..., 1:-1]
        if fit.free_gain:
            b = b - _mean(b)
            gain = np.clip(np.sqrt((fit.power[some] + _TINY) / (_mean(b * b) + _TINY)), 1 / 3, 3)
            b = b * gain
        else:
            gain = np.ones((len(a), 1, 1), np.float32)
        self.gradients = fit.gradient_a[some] / (1 + along), _slope(wide) * gain / (1 + along)
        gradient = (self.gradients[0] + self.gradients[1]) / 2
        unknowns = [gradient, gradient * i[..., 1:-1], gradient * j]
        sigmas = [np.inf, _SLANT_SIGMA, _SLANT_SIGMA]
        if fit.free_gain:
            unknowns += [b, np.ones_like(b)]
            sigmas += [_GAIN_SIGMA, _OFFSET_SIGMA_DN]
        self.jacobian = np.stack([each.reshape(len(a), -1) for each in unknowns], axis=1)
        self.misfit = (a - b).reshape(len(a), -1)
        self.a = a
        variance = (self.misfit**2).mean(axis=1)
        prior = variance[:, None] / np.square(sigmas) + _TINY
        self.normal = (self.jacobian @ self.jacobian.transpose(0, 2, 1)).astype(np.float64)
        self.normal += prior[:, None] * np.eye(len(sigmas))
        self.solution = np.linalg.solve(self.normal, (self.jacobian @ self.misfit[..., None]).astype(np.float64))[
            ..., 0
        ]

    def step(self) -> Floats:
        """What to add to the state (N, 3)."""
        return self.solution[:, :3]

    def quality(self) -> tuple[Floats, Floats]:
        """Sigma of the place [px] and similarity (N,).

        Information about the place is what the other unknowns leave of it (their Schur complement), less the
        part of the squared gradient that only one of the windows has: that is noise, and no texture.
        """
        count, samples = self.jacobian.shape[1:]
        left = self.misfit - np.einsum("nps,np->ns", self.jacobian, self.solution)
        squares = (left**2).sum(axis=1).astype(np.float64)
        noise_share = ((self.gradients[0] - self.gradients[1]) ** 2).sum(axis=(1, 2)) / 4
        information = 1 / np.linalg.inv(self.normal)[:, 0, 0] - noise_share
        variance = squares / (samples - count)
        sigma_px = np.sqrt(np.divide(variance, information, out=np.full_like(variance, np.inf), where=information > 0))
        variation = (self.a - _mean(self.a)).reshape(len(self.a), -1)
        return sigma_px, 1 - squares / ((variation**2).sum(axis=1) + _TINY)


def _mean(windows: Grey) -> Grey:
    return np.asarray(windows.mean(axis=(1, 2), keepdims=True))


def _slope(windows: Grey) -> Grey:
    return (windows[..., 2:] - windows[..., :-2]) * np.float32(0.5)


def _sample(image: Grey, x_px: Grey, y_px: Grey) -> Grey:
    """Bilinear grey levels at places that broadcast to (N, h, w); beyond the image those of its edge."""
    height, width = image.shape
    x, y = np.clip(x_px, 0, np.float32(width - 1.01)), np.clip(y_px, 0, np.float32(height - 1.01))
    column, row = x.astype(np.int32), y.astype(np.int32)
    right, down = x - column.astype(np.float32), y - row.astype(np.float32)
    flat, here = image.ravel(), row * width + column
    upper = flat[here] * (1 - right) + flat[here + 1] * right
    if not down.any():
        return np.asarray(upper)
    here += width
    return np.asarray(upper * (1 - down) + (flat[here] * (1 - right) + flat[here + 1] * right) * down)
