"""Shorter solids that the views may show in place of a longer one: what goes on beyond a part may be its shadow.

The end of a part shows between it and its shadow, as an edge all the way across what passes for one solid.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from stereo_pick.core.arrays import Floats
from stereo_pick.core.edges.edge_map import EdgeMap
from stereo_pick.core.edges.growing import least_change_m, stretched_by, ways_along
from stereo_pick.core.shapes.kinds import SPHERE
from stereo_pick.core.shapes.predicted import along_polygon, inside, silhouettes
from stereo_pick.core.shapes.sight import in_pixels
from stereo_pick.core.shapes.solids import Solids
from stereo_pick.core.shapes.table import Table

_STEP_PX = 3.0
_REACH_PX = 2.5  # of an edge from the end that is tried: half a step, and as far as the orientation may be off
_POINTS = 72  # of a silhouette
_WITHIN_PX = 3.0  # how far a point lies inside the old silhouette to be one of the new end
_LEAST_POINTS = 4
_REMAINS = 0.4  # of the length, at least
_SHOWN = 0.75  # of the new end, in both views: by chance one in ten points lies on an edge
_MOST = 8


def shortened(solid: Solids, eyes_m: Floats, views: Sequence[EdgeMap], table: Table | None) -> list[Solids]:
    """The shorter solids (S = 1 each) whose new ends lie on edges in both views, the clearest first; solid: S = 1."""
    candidates = _candidates(solid, views[0].camera.P[0, 0], table)
    if candidates is None:
        return []
    shown = np.min([shown_ends(candidates, solid, eyes_m, view, i) for i, view in enumerate(views)], axis=0)
    best = np.argsort(-shown, kind="stable")[:_MOST]
    return [candidates.only(np.array([i])) for i in best if shown[i] > _SHOWN]


def _candidates(solid: Solids, focal_px: float, table: Table | None) -> Solids | None:
    """The solid shorter by some pixels, and some more, at each of its ends, but not above or below on a known table."""
    if solid.kind is SPHERE:
        return None
    m_per_px = float(solid.centre_m[0, 2]) / focal_px
    several = []
    for axis, sign in ways_along(solid, table):
        most_m = (1 - _REMAINS) * 2 * float(solid.half_m[0, solid.kind.axes[axis]])
        by_m = np.arange(least_change_m(solid, m_per_px), most_m, _STEP_PX * m_per_px)
        if len(by_m):
            several.append(stretched_by(solid, [(axis, sign)], -by_m))
    if not several:
        return None
    found = Solids.joined(several)
    return found.turning_about(table.normal) if table else found.turning_freely()


def shown_ends(shorter: Solids, solid: Solids, eyes_m: Floats, view: EdgeMap, side: int) -> Floats:
    """The part (S,) of what is new in the silhouettes of shorter solids that one view shows; side: which one."""
    focal_px = view.camera.P[0, 0]
    eye_m = eyes_m[side : side + 1]
    points, normals = along_polygon(silhouettes(shorter, eye_m)[:, 0], _POINTS)
    is_new = inside(points, silhouettes(solid, eye_m)[0]) * focal_px > _WITHIN_PX
    pixels, total = in_pixels(points, view.camera), is_new.sum(axis=1)
    on_edge = view.shows(pixels, normals, _REACH_PX, is_new)
    return np.where(total < _LEAST_POINTS, 0.0, on_edge.sum(axis=1) / np.maximum(total, 1))
