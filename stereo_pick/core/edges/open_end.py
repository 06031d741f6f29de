"""Pieces of solids: where one seems to end, little is seen in either view, and its sides go on.

A disc of a long cylinder has all edges of a solid but those of one end: the share of a silhouette that shows, and the
creases at the other end, do not tell it from a whole one.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from stereo_pick.core.arrays import Bools, Floats
from stereo_pick.core.edges.edge_map import EdgeMap
from stereo_pick.core.edges.growing import FAR, least_change_m, stretched_by, ways_along
from stereo_pick.core.shapes.kinds import SPHERE
from stereo_pick.core.shapes.predicted import along_polygon, inside, silhouettes
from stereo_pick.core.shapes.sight import in_pixels
from stereo_pick.core.shapes.solids import Solids
from stereo_pick.core.shapes.table import Table

_POINTS = 288  # of a silhouette: six pixels of a side are enough to tell
_OFF_PX = 2.0  # from a silhouette, to be no part of it
_FEWEST = 6  # points that tell of an end, or of sides
_GO_ON = 3 / 4  # of the sides beyond an end, in each view: by chance one point in ten lies on edges
_SEEN = 1 / 2  # of an end, in either view
_REACH_PX = 1.5


def has_open_end(solid: Solids, eyes_m: Floats, views: Sequence[EdgeMap], table: Table | None) -> bool:
    """Whether a solid (S = 1) goes on beyond one of its ends, as far as both views tell; on a known table, level."""
    ways = [] if solid.kind is SPHERE else ways_along(solid, table)
    if not ways:
        return False
    length_m = least_change_m(solid, float(solid.centre_m[0, 2]) / views[0].camera.P[0, 0])
    longer = stretched_by(solid, ways, np.array([length_m]))
    goes_on = np.ones(len(ways), np.bool_)
    for view, old, new in zip(views, silhouettes(solid, eyes_m)[0], silhouettes(longer, eyes_m).swapaxes(0, 1)):
        goes_on &= (_sides_shown(view, old, new) >= _GO_ON) & (_end_shown(view, old, new) < _SEEN)
    return bool(goes_on.any())


def _sides_shown(view: EdgeMap, old: Floats, new: Floats) -> Floats:
    """The part (S,) of what longer silhouettes (S, K, 2) have beside the old one (K, 2), less the far end, on edges; 0
    where that is too little to tell."""
    points, normals = along_polygon(new, _POINTS)
    beyond_px = -inside(points, old[None]) * view.camera.P[0, 0]
    sides = (beyond_px > _OFF_PX) & (beyond_px <= FAR * beyond_px.max(axis=1, keepdims=True))
    return _shown(view, points, normals, sides, 0.0)


def _end_shown(view: EdgeMap, old: Floats, new: Floats) -> Floats:
    """The part (S,) of an old silhouette (K, 2) within each of longer ones (S, K, 2) that lies on edges; 1 where that
    is too little to tell."""
    points, normals = (np.repeat(each, len(new), axis=0) for each in along_polygon(old[None], _POINTS))
    end = inside(points, new) * view.camera.P[0, 0] > _OFF_PX
    return _shown(view, points, normals, end, 1.0)


def _shown(view: EdgeMap, points: Floats, normals: Floats, asked: Bools, unknown: float) -> Floats:
    """The part (S,) on edges of those points (S, N, 2), normalized, that are asked for (S, N)."""
    pixels = in_pixels(points, view.camera)
    shown = view.shows(pixels, normals, _REACH_PX, asked)
    count = asked.sum(axis=1)
    return np.where(count >= _FEWEST, shown.sum(axis=1) / np.maximum(count, 1), unknown)
