"""Solids brought to the least distance between their silhouettes and the outlines (Levenberg and Marquardt)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from stereo_pick.core.arrays import Bools, Floats, Ints
from stereo_pick.core.shapes.kinds import dot
from stereo_pick.core.shapes.nearest import nearest_tangents
from stereo_pick.core.shapes.residuals import Tangents, residuals
from stereo_pick.core.shapes.sight import Sight
from stereo_pick.core.shapes.solids import Solids
from stereo_pick.core.shapes.table import Table

Touch = Callable[[Sight, Solids], Tangents]

TUKEY = 4.685  # in sigmas: 95 % efficient on normal noise
LEAST_SCALE_PX = 0.05
_LEAST_HALF = 0.02  # of the object's radius
_FIRM = 1e5  # points of an outline that weigh as much as the table
_CONVERGED_PX = 0.01  # the step is taken, and the next one would be far smaller
_SAME = np.eye(3)
_CROSS = np.cross(_SAME[:, None], -_SAME).reshape(3, 9)  # of each axis: what it turns the others to


@dataclass(frozen=True, eq=False)
class Fitted:
    """Solids and their residuals (S, 2N) [px], Jacobians (S, 2N, 3 + Q + sizes), and weights (S, 2N).

    A point at which something else ends the object has weight where the solid does not even reach it."""

    solids: Solids
    residual_px: Floats
    jacobian: Floats
    weight: Floats

    def only(self, chosen: Ints) -> Fitted:
        """These of them."""
        return Fitted(self.solids.only(chosen), self.residual_px[chosen], self.jacobian[chosen], self.weight[chosen])

    def scale_px(self) -> Floats:
        """Robust standard deviation (S,) [px] of the trusted residuals."""
        return robust_scale(self.residual_px, self.weight)


def fitted(sight: Sight, solids: Solids, touch: Touch = nearest_tangents) -> Fitted:
    """The solids as they are, measured across these tangents; sight holds one object for each."""
    residual, jacobian = residuals(sight, solids, touch(sight, solids))
    short = np.where(residual < 0, sight.inner.reshape(residual.shape), 0.0)
    return Fitted(solids, residual, jacobian, sight.weight.reshape(residual.shape) + short)


def refine(sight: Sight, now: Fitted, rounds: int, touch: Touch = nearest_tangents) -> Fitted:
    """Improve every solid by up to so many steps; sight holds one object for each."""
    damping = np.full(len(now.residual_px), 1e-3)
    for _ in range(rounds):
        scale = np.maximum(now.scale_px(), LEAST_SCALE_PX)[:, None]
        step = _step(sight, now, scale, damping)
        there = moved(now.solids, step, _LEAST_HALF * sight.radius_m)
        tried = fitted(sight, sight.table.put_down(there) if sight.table else there, touch)
        better = _cost(tried, scale) <= _cost(now, scale)
        settled = np.abs((now.jacobian @ step[..., None])[..., 0]).max(axis=1) < _CONVERGED_PX
        now = _where(better, tried, now)
        damping *= np.where(better, 0.2, 10.0)
        if settled.all():
            break
    return now


def firmly_on(table: Table, solids: Solids, focal_px: float) -> tuple[Floats, Floats]:
    """What a table adds to the normal matrices (S, P, P) and right-hand sides (S, P, 1) of a step's equations, so that
    the lowest points of the solids (S) come to lie on it."""
    height_m, gradient = table.under(solids)
    weight = _FIRM * (focal_px / solids.centre_m[:, 2, None]) ** 2
    column = gradient[..., None]
    return column * (weight * gradient)[:, None], column * (weight * height_m[:, None])[..., None]


def robust_scale(residual: Floats, weight: Floats) -> Floats:
    """Standard deviation (S,) of most of those residuals (S, N) that have weight; inf where none has."""
    ordered = np.sort(np.where(weight > 0, np.abs(residual), np.inf), axis=1)
    middle = np.minimum(np.count_nonzero(weight, axis=1) // 2, ordered.shape[1] - 1)
    return np.asarray(1.4826 * ordered[np.arange(len(middle)), middle])


def medians(values: Floats, which: Bools) -> Floats:
    """Of which (S, N) of the values (S, N), in each row; infinite where there is none."""
    ordered, count, row = np.sort(np.where(which, values, np.inf), axis=1), which.sum(axis=1), np.arange(len(values))
    low, high = ordered[row, np.maximum(count - 1, 0) // 2], ordered[row, count // 2]
    return np.asarray((low + high) / 2)


def tukey(residual: Floats, scale: Floats | float) -> Floats:
    """Tukey's weight: 1 for a residual of 0, 0 for one that is far off on this scale."""
    return np.asarray(np.maximum(1 - (residual / (TUKEY * scale)) ** 2, 0) ** 2)


def bounded(residual_px: Floats, scale_px: Floats | float) -> Floats:
    """Tukey's loss [px²]: the square of a small residual, and no more than 7.3 scale² for any."""
    inside = np.maximum(1 - (residual_px / (TUKEY * scale_px)) ** 2, 0)
    return np.asarray((TUKEY * scale_px) ** 2 / 3 * (1 - inside * inside * inside))


def _cost(now: Fitted, scale_px: Floats) -> Floats:
    return np.asarray((now.weight * bounded(now.residual_px, scale_px)).sum(axis=1))


def _step(sight: Sight, now: Fitted, scale_px: Floats, damping: Floats) -> Floats:
    """The damped step (S, 3 + Q + sizes) of iteratively reweighted least squares."""
    weight = now.weight * tukey(now.residual_px, scale_px)
    weighted = (now.jacobian * weight[..., None]).transpose(0, 2, 1)
    normal = weighted @ now.jacobian
    diagonal = np.einsum("sii->si", normal)  # a view
    diagonal += diagonal * damping[:, None] + 1e-9
    if sight.table:
        normal += firmly_on(sight.table, now.solids, sight.focal_px)[0]
    return -np.asarray(np.linalg.solve(normal, weighted @ now.residual_px[..., None])[..., 0])


def moved(solids: Solids, step: Floats, least_half_m: Floats) -> Solids:
    """Solids (S) after steps (S, 3 + Q + sizes) of centre [m], turns [rad] and half sizes [m]; least_half_m: (S,)."""
    turning = solids.turns.shape[2]
    turn = (solids.turns @ step[:, 3 : 3 + turning, None])[..., 0]
    half_m = np.maximum(solids.half_m + step[:, 3 + turning :], least_half_m[:, None])
    rotation = solids.rotation @ _rotations(turn) if turning else solids.rotation
    return Solids(solids.kind, solids.centre_m + step[:, :3], rotation, half_m, solids.turns)


def _rotations(vectors: Floats) -> Floats:
    """Rotation vectors (S, 3) [rad] to rotations (S, 3, 3): Rodrigues."""
    angle = np.sqrt(dot(vectors, vectors))[:, None, None]
    cross = (vectors / (angle[:, 0] + 1e-15) @ _CROSS).reshape(-1, 3, 3)
    return np.asarray(_SAME + np.sin(angle) * cross + (1 - np.cos(angle)) * (cross @ cross))


def _where(better: Bools, tried: Fitted, now: Fitted) -> Fitted:
    if better.all():
        return tried
    one, two, three = better[:, None], better[:, None, None], better[:, None, None]
    solids = Solids(
        now.solids.kind,
        np.where(one, tried.solids.centre_m, now.solids.centre_m),
        np.where(two, tried.solids.rotation, now.solids.rotation),
        np.where(one, tried.solids.half_m, now.solids.half_m),
        now.solids.turns,
    )
    return Fitted(
        solids,
        np.where(one, tried.residual_px, now.residual_px),
        np.where(three, tried.jacobian, now.jacobian),
        np.where(one, tried.weight, now.weight),
    )
