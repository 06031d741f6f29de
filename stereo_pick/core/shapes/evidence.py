"""What outlines say for and against a solid, and how sure they make its centre."""

from __future__ import annotations

import numpy as np

from stereo_pick.core.arrays import Bools, Floats
from stereo_pick.core.shapes.refinement import TUKEY, Fitted, bounded, tukey
from stereo_pick.core.shapes.table import Table

ARCS = 9  # independent pieces of an outline: light and shading move an edge along whole arcs, not point by point
ARC_PX = 25.0  # the length of such a piece
USUAL_PX = 0.085  # from the solid that explains them; where points lie farther off, such pieces do, too
_ASSUMED = 10.0  # independent pieces that the assumed noise counts for, beside the residuals seen
_LOOSEST = 0.05  # standard deviation of a centre, as a part of the solid's size
_ASTRAY = 0.15  # of the outline in a view, that may be something else than the object's edge
_LIMIT = 1.5  # noise half as large again as assumed, or a quarter of the outline quite somewhere else


def misfit_px(found: Fitted, noise_px: float) -> Floats:
    """Root mean square (S,) [px] of the trusted residuals, none of which counts for more than about 3 noise_px."""
    loss = (found.weight * bounded(found.residual_px, noise_px)).sum(axis=1)
    return np.asarray(np.sqrt(loss / np.maximum(found.weight.sum(axis=1), 1)))


def explained(misfit_px: Floats, noise_px: float) -> Bools:
    """Whether (S,) solids with these misfits (S,) [px] explain their outlines."""
    return np.asarray(misfit_px <= _LIMIT * noise_px)


def followed(found: Fitted, noise_px: float) -> Bools:
    """Whether (S,) nearly all of the outline in either view lies on the solid: a piece of it that does not is small."""
    views = (len(found.weight), 2, -1)
    known = found.weight.reshape(views) > 0
    astray = known & (np.abs(found.residual_px).reshape(views) > TUKEY * noise_px)
    return np.asarray((astray.sum(axis=2) <= _ASTRAY * known.sum(axis=2)).all(axis=1))


def determined(found: Fitted, covariance: Floats) -> Bools:
    """Whether (S,) the outlines fix the centres: a box with one end hidden can be of any length."""
    worst_m = np.sqrt(np.einsum("sii->si", covariance).max(axis=1))
    return np.asarray(worst_m < _LOOSEST * found.solids.size_m().mean(axis=1))


def complaint(found: Fitted, noise_px: float) -> Floats:
    """The Bayesian information criterion (S,): misfit in units of the noise, plus a price for each parameter.

    The arcs of the outlines are the data, not their points.
    """
    arcs = _arcs(found)
    parameters = found.jacobian.shape[2]
    return np.asarray(arcs * (misfit_px(found, noise_px) / noise_px) ** 2 + parameters * np.log(arcs))


def centre_covariance(found: Fitted, noise_px: Floats | float, table: Table | None = None) -> Floats:
    """Covariance (S, 3, 3) [m²] of the centres, from the noise that the residuals show and the one assumed, of all or
    of each (S,).

    Residuals are averaged over as many independent pieces as there are arcs; few of them remain beside the
    parameters, so the assumed noise is given a say.
    """
    arcs = _arcs(found)
    scale = np.maximum(found.scale_px(), noise_px)[:, None]
    weight = found.weight * tukey(found.residual_px, scale)
    total = weight.sum(axis=1)
    parameters = found.jacobian.shape[2]
    squares = arcs * (weight * found.residual_px**2).sum(axis=1) / total
    variance = (squares + _ASSUMED * noise_px**2) / (np.maximum(arcs - parameters, 1) + _ASSUMED)
    point_variance = (variance * total / arcs)[:, None, None]
    normal = (found.jacobian * weight[..., None]).transpose(0, 2, 1) @ found.jacobian
    known = point_variance * np.eye(parameters)  # nothing on a table is off by more than 1 m or 1 rad
    if table:
        _, gradient = table.under(found.solids)
        known = known + gradient[..., None] * gradient[:, None] * point_variance / table.sigma_m**2
    return np.asarray(np.linalg.inv(normal + known)[:, :3, :3] * point_variance)


def _arcs(found: Fitted) -> Floats:
    return np.asarray(np.maximum(2 * ARCS * found.weight.mean(axis=1), 2.0))
