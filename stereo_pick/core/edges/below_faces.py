"""The table below lit faces: the tops of bodies whose sides are as dark as the table.

A top is level, so it tells how the table is inclined. How far down that is, other objects may tell, or the edges of
sides and feet below the top.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from stereo_pick.core.arrays import Floats
from stereo_pick.core.edges.edge_map import EdgeMap
from stereo_pick.core.edges.growing import shown_parts
from stereo_pick.core.shapes.common_normal import ANGLE, across, lowest_m
from stereo_pick.core.shapes.common_table import SUPPOSED_SIGMA_M
from stereo_pick.core.shapes.kinds import BOX
from stereo_pick.core.shapes.solid_fit import SolidFit
from stereo_pick.core.shapes.solids import Solids
from stereo_pick.core.shapes.table import EDGE_ON, Table

_STEP_PX = 1.5  # by which the foot of a body moves from one level to the next
_SHORTEST, _TALLEST = 0.15, 2.0  # height of a body by length of its top
_SHOWN = 0.5  # part of what a body has below its top, from which on it counts that it lies on edges
_LEVELS = 3  # that are worth trying
_APART = 3  # steps between two of these
_ALIKE = np.sqrt(1 - ANGLE**2)  # cosine of the angle by which faces that are level may differ


def tables_below(
    faces: Sequence[SolidFit], bodies: Sequence[SolidFit], views: Sequence[EdgeMap], eyes_m: Floats
) -> list[Table]:
    """What thin solids may be the tops above, the likeliest first; bodies: solids that may stand or lie on the same
    table.

    These are proposals: objects must be found on a table before it is believed.
    """
    sheets = [face for face in faces if face.kind == BOX.name or face.size_m.argmin() == 2]  # the others are rods
    normal = _common_normal(sheets)
    if normal is None:
        return []
    level = [face for face in sheets if across(face) @ normal > _ALIKE]
    step_m = _STEP_PX * float(np.mean([face.centre_m[2] for face in level])) / views[0].camera.P[0, 0]
    bases_m = lowest_m(normal, bodies)
    levels_m = np.concatenate([_levels_m(level, normal, step_m), bases_m])
    votes = np.zeros(len(levels_m))
    for face in level:
        below = _down_to(face, normal, face.centre_m @ normal - levels_m)
        votes += np.maximum(shown_parts(below, face.solid, eyes_m, views) - _SHOWN, 0)
    votes[len(votes) - len(bases_m) :] += _SHOWN
    return [Table(normal, -each, SUPPOSED_SIGMA_M) for each in _best(levels_m, votes, _APART * step_m)]


def _common_normal(faces: Sequence[SolidFit]) -> Floats | None:
    """The mean normal (3,) of the faces that agree with most of the others; larger ones count more."""
    seen = [face for face in faces if -across(face)[2] > EDGE_ON]
    if not seen:
        return None
    normals = np.array([across(face) for face in seen])
    weights = np.array([float(np.median(face.size_m)) ** 2 for face in seen])
    alike = normals @ normals.T > _ALIKE
    best = alike[int((alike @ weights).argmax())]
    mean = weights[best] @ normals[best]
    return np.asarray(mean / np.linalg.norm(mean))


def _levels_m(faces: Sequence[SolidFit], normal: Floats, step_m: float) -> Floats:
    """How high (L,) [m] above the camera, along the normal, the table may be: below all of the faces."""
    tops_m = np.array([face.centre_m @ normal for face in faces])
    sizes_m = np.array([float(face.size_m.max()) for face in faces])
    return np.arange((tops_m - _TALLEST * sizes_m).min(), (tops_m - _SHORTEST * sizes_m).min(), step_m)


def _down_to(face: SolidFit, normal: Floats, heights_m: Floats) -> Solids:
    """The bodies (S,) below a face that are so high (S,) [m]."""
    kind, thin = face.solid.kind, int(face.size_m.argmin())
    heights_m = np.maximum(heights_m, face.size_m[thin])
    half_m = np.repeat(face.solid.half_m, len(heights_m), axis=0)
    half_m[:, kind.axes[thin]] = heights_m / 2
    centre_m = face.centre_m - heights_m[:, None] / 2 * normal
    rotation = np.repeat(face.rotation[None], len(heights_m), axis=0)
    return Solids(kind, centre_m, rotation, half_m, np.zeros((len(heights_m), 3, 0)))


def _best(levels_m: Floats, votes: Floats, apart_m: float) -> list[float]:
    """The levels with the most votes, none near another."""
    found: list[float] = []
    for which in np.argsort(-votes, kind="stable"):
        if votes[which] <= 0 or len(found) == _LEVELS:
            break
        if all(abs(levels_m[which] - other) >= apart_m for other in found):
            found.append(float(levels_m[which]))
    return found
