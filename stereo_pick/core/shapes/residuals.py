"""How far outlines lie from the silhouettes of solids, with derivatives."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from stereo_pick.core.arrays import Floats
from stereo_pick.core.shapes.kinds import cross, dot
from stereo_pick.core.shapes.sight import Sight, tangent_planes
from stereo_pick.core.shapes.solids import Solids


class Tangents(NamedTuple):
    """Planes through the cameras that touch the solids: one for each point of the outlines.

    planes: (S, 2N, 3), their normals, outward in the images; in the solids' own axes, own: (S, 2N, 3), the same, and
    touched: (S, 2N, 3) [m], where the solids are touched.
    """

    planes: Floats
    own: Floats
    touched: Floats

    @staticmethod
    def of(sight: Sight, solids: Solids, normals: Floats, touched: Floats) -> Tangents:
        """Those whose lines in the images have these normals (S, 2, N, 2)."""
        planes = tangent_planes(sight.points, normals).reshape(len(normals), -1, 3)
        return Tangents(planes, planes @ solids.rotation, touched)


def own_tangents(sight: Sight, solids: Solids) -> Tangents:
    """The tangents with the outlines' own normals: cheap, and right where a solid is far from its place."""
    own = sight.planes @ solids.rotation
    return Tangents(sight.planes, own, solids.kind.touch(own, solids.half_m))


def residuals(sight: Sight, solids: Solids, tangents: Tangents) -> tuple[Floats, Floats]:
    """How far (S, 2N) [px] each solid reaches beyond its outline's points across tangents, and d/d it.

    The Jacobian's columns (S, 2N, 3 + Q + sizes) are centre [m], turns [rad] and half sizes [m]. sight holds one
    object for each solid. To first order the distance is that of the touching plane, at the object's depth. A tangent
    that touches along a whole side is moved by what lies next to the point, not by the side's end.
    """
    planes, own, touched = tangents
    past_centre = dot(planes.reshape(len(planes), 2, -1, 3), solids.seen_from(sight.eyes_m)).reshape(len(planes), -1)
    scale = (sight.focal_px / solids.centre_m[:, 2])[:, None]
    residual = scale * (past_centre + dot(touched, own))
    turning = solids.turns.shape[2]
    jacobian = np.empty((*residual.shape, 3 + turning + solids.kind.sizes))
    jacobian[..., :3] = planes
    if turning:
        jacobian[..., 3 : 3 + turning] = cross(touched, own) @ solids.turns
    jacobian[..., 3 + turning :] = (touched * own) @ (solids.kind.shares / solids.half_m[:, None])
    jacobian *= scale[..., None]
    return residual, jacobian
