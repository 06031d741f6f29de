"""A window's place in the other view to a part of a pixel, with the slant of the surface that it shows."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from stereo_pick.core.arrays import Floats, Ints
from stereo_pick.core.windows.window import Grey

_MAX_ITERATIONS = 8
_MAX_STEP_PX = 0.5
_CONVERGED_PX = 5e-3
_SLANT_SIGMA = 0.3  # change of disparity along a row and from row to row, before anything was measured
_MAX_SLANT = 0.7
_GAIN_SIGMA = 0.5
_OFFSET_SIGMA_DN = 50.0
_CHUNK_SAMPLES = 1 << 17  # that fit into a cache
_TINY = 1e-6
_SQUARES = np.array([[0, 1, 2], [1, 3, 4], [2, 4, 5]])  # 1, i and j multiplied with each other, among the monomials


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
        self.shift_px, self.monomials = shift, _monomials(along[1:-1], across)
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
        return self.state[:, 0], *_System(self, slice(None)).quality()


class _System:
    """The linearised least squares of some of the windows: `misfit` (N, h, w) by P unknowns: place, slant along and
    across the row; gain and offset, where they are free.
    """

    def __init__(self, fit: _Fit, some: Ints | slice) -> None:
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
        self.gradients = fit.gradient_a[some] / (1 + along), _slope(wide) * (gain / (1 + along))
        self.gradient, self.b = (self.gradients[0] + self.gradients[1]) / 2, b
        self.a, self.misfit = a, a - b
        self.i, self.j = i[..., 1:-1], j
        sigmas = [np.inf, _SLANT_SIGMA, _SLANT_SIGMA] + [_GAIN_SIGMA, _OFFSET_SIGMA_DN] * fit.free_gain
        products, right = self._products(fit.monomials, len(sigmas))
        about_point = _shifted(fit.shift_px[some], len(sigmas))
        prior = np.square(self.misfit).mean(axis=(1, 2))[:, None] / np.square(sigmas) + _TINY
        self.normal = about_point.transpose(0, 2, 1) @ products @ about_point + prior[:, None] * np.eye(len(sigmas))
        self.solution = np.linalg.solve(self.normal, about_point.transpose(0, 2, 1) @ right[..., None])[..., 0]

    def _products(self, monomials: Grey, unknowns: int) -> tuple[Floats, Floats]:
        """The unknowns' columns multiplied with each other (N, P, P), and with the misfits (N, P), of windows that lie
        around their points: what holds a slant is a sum of squared gradients times places in the window, which are the
        same for all."""
        gradient, b, misfit = (each.reshape(len(each), -1) for each in (self.gradient, self.b, self.misfit))
        linear = monomials[:, :3]
        products, right = np.empty((len(b), unknowns, unknowns)), np.empty((len(b), unknowns))
        products[:, :3, :3] = (gradient * gradient @ monomials)[:, _SQUARES]
        right[:, :3] = gradient * misfit @ linear
        if unknowns > 3:
            products[:, 3, :3], products[:, 4, :3] = gradient * b @ linear, gradient @ linear
            products[:, :3, 3:] = products[:, 3:, :3].transpose(0, 2, 1)
            products[:, 3, 3], products[:, 4, 4] = (b * b).sum(axis=1), b.shape[1]
            products[:, 3, 4] = products[:, 4, 3] = b.sum(axis=1)
            right[:, 3], right[:, 4] = (b * misfit).sum(axis=1), misfit.sum(axis=1)
        return products, right

    def step(self) -> Floats:
        """What to add to the state (N, 3)."""
        return self.solution[:, :3]

    def quality(self) -> tuple[Floats, Floats]:
        """Sigma of the place [px] and similarity (N,).

        Information about the place is what the other unknowns leave of it (their Schur complement), less the
        part of the squared gradient that only one of the windows has: that is noise, and no texture.
        """
        solution = self.solution[..., None, None].astype(np.float32)
        left = self.misfit - self.gradient * (solution[:, 0] + solution[:, 1] * self.i + solution[:, 2] * self.j)
        if len(solution[0]) > 3:
            left -= solution[:, 3] * self.b + solution[:, 4]
        squares = (left**2).sum(axis=(1, 2)).astype(np.float64)
        noise_share = ((self.gradients[0] - self.gradients[1]) ** 2).sum(axis=(1, 2)) / 4
        information = 1 / np.linalg.inv(self.normal)[:, 0, 0] - noise_share
        variance = squares / (left[0].size - len(solution[0]))
        sigma_px = np.sqrt(np.divide(variance, information, out=np.full_like(variance, np.inf), where=information > 0))
        variation = np.square(self.a - _mean(self.a)).sum(axis=(1, 2))
        return sigma_px, 1 - squares / (variation + _TINY)


def _monomials(along: Grey, across: Grey) -> Grey:
    """1, i, j, i i, i j, j j (S, 6) of the places i (w,) along and j (h,) across the rows of a window."""
    j, i = (each.ravel() for each in np.meshgrid(across, along, indexing="ij"))
    return np.stack([np.ones_like(i), i, j, i * i, i * j, j * j], axis=1)


def _shifted(shift_px: Grey, unknowns: int) -> Floats:
    """From the unknowns of points to those of the middles of windows (N, P, P) that lie beside them by shifts (N, 2):
    there a slant has moved the place as well."""
    found = np.tile(np.eye(unknowns), (len(shift_px), 1, 1))
    found[:, 0, 1:3] = shift_px
    return found


def _mean(windows: Grey) -> Grey:
    return np.asarray(windows.mean(axis=(1, 2), keepdims=True))


def _slope(windows: Grey) -> Grey:
    return (windows[..., 2:] - windows[..., :-2]) * np.float32(0.5)


def _sample(image: Grey, x_px: Grey, y_px: Grey) -> Grey:
    """Bilinear grey levels at places that broadcast to (N, h, w); beyond the image those of its edge."""
    height, width = image.shape
    x, y = np.clip(x_px, 0, np.float32(width - 1.01)), np.clip(y_px, 0, np.float32(height - 1.01))
    column, row = x.astype(np.intp), y.astype(np.intp)
    right, down = x - column.astype(np.float32), y - row.astype(np.float32)
    flat, here = image.ravel(), row * width + column
    upper = _between(flat, here, right)
    if not down.any():
        return upper
    return np.asarray(upper + (_between(flat, here + width, right) - upper) * down)


def _between(flat: Grey, here: Ints, share: Grey) -> Grey:
    """Values of an image's pixels, one row after the other, with that share of the next pixel's."""
    first = flat.take(here)
    return np.asarray(first + (flat.take(here + 1) - first) * share)
