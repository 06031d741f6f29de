"""A chessboard's corner as a picture: four fields that meet where two blurred edges cross."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from stereo_pick.core.arrays import Floats, Image

# x y of the corner [px], directions of both edges [rad], mean grey, contrast, blur [px], grey gradient in x and in y.
_PARAMETERS = 9
_TURNS = 12
_MIN_HALF_PX, _MAX_HALF_PX, _OF_SQUARE = 3, 9, 0.6
_START_BLUR_PX, _BLUR_PX = 1.2, (0.4, 4.0)
_MAX_SHIFT_PX = 1.0  # farther than that from where it was found, it is another thing
_RIDGE = 1e-6
_CONVERGED_PX = 1e-4  # far less than the noise of a corner; the step is taken


def fitted_corners(picture: Image, grid_px: Floats) -> Floats:
    """Corners (rows, columns, 2) [px] moved to where the model of a corner fits the grey values (H, W) best.

    All pixels of both edges take part, so the noise is about a third of that of a gradient method on the same window.
    A corner without room for its window in the image, or whose fit runs away, stays where it was found.
    """
    along, down = (np.gradient(grid_px, axis=axis).reshape(-1, 2) for axis in (1, 0))
    corners_px = grid_px.reshape(-1, 2)
    half = _half_px(along, down)
    centre = np.round(corners_px).astype(np.int64)
    inside = ((centre >= half) & (centre < np.array(picture.shape[1::-1]) - half)).all(axis=1)
    v, u = (offset.ravel() for offset in np.mgrid[-half : half + 1, -half : half + 1])
    disc = u * u + v * v <= half * half + 1
    x, y = centre[inside, :1] + u[disc], centre[inside, 1:] + v[disc]
    grey = picture[y, x].astype(np.float64)
    fit = _fit(_start(corners_px[inside], along[inside], down[inside], x, y, grey), x, y, grey)[:, :2]
    near = np.linalg.norm(fit - corners_px[inside], axis=1) <= _MAX_SHIFT_PX
    result = np.array(corners_px)
    result[np.flatnonzero(inside)[near]] = fit[near]
    return result.reshape(grid_px.shape)


def _half_px(along: Floats, down: Floats) -> int:
    """Half the window [px]: short of the edges that lie one square away, whichever way the squares are seen."""
    longer = np.maximum(np.linalg.norm(along, axis=1), np.linalg.norm(down, axis=1))
    across = np.abs(along[:, 0] * down[:, 1] - along[:, 1] * down[:, 0]) / longer
    return int(np.clip(_OF_SQUARE * across.min(), _MIN_HALF_PX, _MAX_HALF_PX))


def _start(corners_px: Floats, along: Floats, down: Floats, x: Floats, y: Floats, grey: Floats) -> Floats:
    """First parameters (N, 9): the edges run along the rows and columns, contrast and its sign from the picture."""
    start = np.zeros((len(corners_px), _PARAMETERS))
    start[:, :2] = corners_px
    start[:, 2], start[:, 3] = (np.arctan2(edge[:, 1], edge[:, 0]) for edge in (along, down))
    start[:, 5], start[:, 6] = 1.0, _START_BLUR_PX
    unit = _grey(start, x, y)[0]
    mean = grey.mean(axis=1)
    start[:, 4], start[:, 5] = mean, ((grey - mean[:, None]) * unit).sum(axis=1) / (unit * unit).sum(axis=1)
    return start


def _fit(parameters: Floats, x: Floats, y: Floats, grey: Floats) -> Floats:
    """Gauss-Newton on all corners (N, 9) at once, each until it stays; x, y, grey: (N, M) pixels of each window."""
    found, moving = parameters.copy(), np.arange(len(parameters))
    for _ in range(_TURNS):
        step = _step(found[moving], x[moving], y[moving], grey[moving])
        found[moving] += step
        found[:, 6] = found[:, 6].clip(*_BLUR_PX)
        moving = moving[np.abs(step[:, :2]).max(axis=1) >= _CONVERGED_PX]
        if not len(moving):
            break
    return found


def _step(parameters: Floats, x: Floats, y: Floats, grey: Floats) -> Floats:
    modelled, jacobian = _grey(parameters, x, y)
    normal = jacobian @ jacobian.transpose(0, 2, 1)
    ridge = _RIDGE * np.trace(normal, axis1=1, axis2=2) / _PARAMETERS
    normal += ridge[:, None, None] * np.eye(_PARAMETERS)
    step = np.linalg.solve(normal, jacobian @ (grey - modelled)[..., None])[..., 0]
    step[:, :2], step[:, 6] = step[:, :2].clip(-0.5, 0.5), step[:, 6].clip(-0.3, 0.3)
    return np.asarray(step)


def _grey(parameters: Floats, x: Floats, y: Floats) -> tuple[Floats, Floats]:
    """Grey values (N, M) of the model, and their derivatives (N, 9, M)."""
    corner_x, corner_y, along, down, mean, contrast, blur, slope_x, slope_y = (
        column[:, None] for column in parameters.T
    )
    u, v = x - corner_x, y - corner_y
    first, second = _Edge.through_corner(u, v, along, blur), _Edge.through_corner(u, v, down, blur)
    by_first, by_second = contrast * second.level, contrast * first.level
    jacobian = np.empty((len(x), _PARAMETERS, x.shape[1]))
    jacobian[:, 0] = by_first * first.by_x + by_second * second.by_x - slope_x
    jacobian[:, 1] = by_first * first.by_y + by_second * second.by_y - slope_y
    jacobian[:, 2], jacobian[:, 3] = by_first * first.by_direction, by_second * second.by_direction
    jacobian[:, 4], jacobian[:, 5] = 1.0, first.level * second.level
    jacobian[:, 6] = by_first * first.by_blur + by_second * second.by_blur
    jacobian[:, 7], jacobian[:, 8] = u, v
    return mean + slope_x * u + slope_y * v + contrast * first.level * second.level, jacobian


class _Edge(NamedTuple):
    """A blurred edge through the corner: its level (N, M) from -1 to 1, and the level's derivatives by x and y of the
    corner, by the edge's direction and by its blur."""

    level: Floats
    by_x: Floats
    by_y: Floats
    by_direction: Floats
    by_blur: Floats

    @staticmethod
    def through_corner(u: Floats, v: Floats, direction: Floats, blur: Floats) -> _Edge:
        """At pixels u, v (N, M) from the corners."""
        cosine, sine = np.cos(direction), np.sin(direction)
        off = (v * cosine - u * sine) / blur
        level = np.tanh(off)
        steep = (1 - level * level) / blur
        return _Edge(level, steep * sine, -steep * cosine, -steep * (u * cosine + v * sine), -steep * off)
