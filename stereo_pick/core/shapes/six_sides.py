"""Whether a cylinder that explains an object leaves room for a hexagonal prism."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from stereo_pick.core.arrays import Bools, Floats
from stereo_pick.core.shapes.evidence import misfit_px
from stereo_pick.core.shapes.kinds import HEX_PRISM
from stereo_pick.core.shapes.refinement import Fitted, fitted
from stereo_pick.core.shapes.sight import Sight
from stereo_pick.core.shapes.solids import Solids
from stereo_pick.core.shapes.starts import turned

_TURNS = 8
_ROOM = 1.5  # times the misfit of the cylinder: there are more than small changes
_SMALL = 1e-3  # price of a change, as a part of what the outlines say of it
_ACROSS_FLATS = 1 / 1.05  # of a cylinder's radius: half-way between where its flats and its corners touch


def may_have_six_sides(sight: Sight, cylinders: Fitted, noise_px: float) -> Bools:
    """Whether (S,) a prism about a cylinder's axis, turned, moved and resized a little, could fit as well as it does.

    Six flats make a pattern around the axis of which a twelfth of the radius cannot be moved or resized away: where
    that is more than the noise, it is not there. sight: of one object for each cylinder.
    """
    count = len(cylinders.residual_px)
    if not count:
        return np.zeros(0, np.bool_)
    prisms = fitted(sight.without_corners().only(np.repeat(np.arange(count), _TURNS)), _prisms(cylinders.solids))
    misfit = misfit_px(replace(prisms, residual_px=_left_px(prisms)), noise_px)
    return np.asarray(misfit.reshape(count, _TURNS).min(axis=1) <= _ROOM * misfit_px(cylinders, noise_px))


def _left_px(prisms: Fitted) -> Floats:
    """The residuals (S, 2N) [px] that the best small change of each would leave."""
    weighted = (prisms.jacobian * prisms.weight[..., None]).transpose(0, 2, 1)
    normal = weighted @ prisms.jacobian
    diagonal = np.einsum("sii->si", normal)  # a view
    diagonal += diagonal * _SMALL + 1e-9
    step = np.linalg.solve(normal, weighted @ prisms.residual_px[..., None])
    return np.asarray(prisms.residual_px - (prisms.jacobian @ step)[..., 0])


def _prisms(cylinders: Solids) -> Solids:
    """Each cylinder as hexagonal prisms, turned about its axis."""
    rotation = (cylinders.rotation[:, None] @ turned(np.pi / 3, _TURNS)).reshape(-1, 3, 3)
    half_m: Floats = np.repeat(cylinders.half_m, _TURNS, axis=0) * (_ACROSS_FLATS, 1.0)
    centre_m = np.repeat(cylinders.centre_m, _TURNS, axis=0)
    return Solids(HEX_PRISM, centre_m, rotation, half_m, np.zeros((len(half_m), 3, 0))).turning_freely()
