"""How far outlines lie from the silhouettes of solids, with derivatives."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from stereo_pick.core.arrays import Floats
from stereo_pick.core.shapes.kinds import cross, dot
from stereo_pick.core.shapes.sight import Sight, tangent_planes
from stereo_pick.core.shapes.solids import Solids


class Tangents(NamedTuple):
    """Lines in the images that touch the solids: one for each point of the outlines.

    normals: (S, 2, N, 2), outward; touched: (S, 2N, 3) [m], where the solids are touched, in their own axes.
    """

    normals: Floats
    touched: Floats


def own_tangents(sight: Sight, solids: Solids) -> Tangents:
    """The tangents with the outlines' own normals: cheap, and right where a solid is far from its place."""
    planes = tangent_planes(sight.points, sight.normals).reshape(len(sight.points), -1, 3)
    return Tangents(sight.normals, solids.kind.touch(planes @ solids.rotation, solids.half_m))


def residuals(sight: Sight, solids: Solids, tangents: Tangents) -> tuple[Floats, Floats]:
    """How far (S, 2N) [px] each solid reaches beyond its outline's points across tangents, and d/d it.

    The Jacobian's columns (S, 2N, 3 + Q + sizes) are centre [m], turns [rad] and half sizes [m]. sight holds one
    object for each solid. To first order the distance is that of the touching plane, at the object's depth. A tangent
    that touches along a whole side is moved by what lies next to the point, not by the side's end.
    """
    views = tangent_planes(sight.points, tangents.normals)
    past_centre = dot(views, solids.seen_from(sight.eyes_m)).reshape(len(views), -1)
    planes = views.reshape(len(views), -1, 3)
    own = planes @ solids.rotation
    scale = (sight.focal_px / solids.centre_m[:, 2])[:, None]
    grown = tangents.touched * own
    residual = scale * (past_centre + dot(tangents.touched, own))
    turning = solids.turns.shape[2]
    jacobian = np.empty((*residual.shape, 3 + turning + solids.kind.sizes))
    jacobian[..., :3] = planes
    if turning:
        jacobian[..., 3 : 3 + turning] = cross(tangents.touched, own) @ solids.turns
    jacobian[..., 3 + turning :] = grown @ (solids.kind.shares / solids.half_m[:, None])
    jacobian *= scale[..., None]
    return residual, jacobian
