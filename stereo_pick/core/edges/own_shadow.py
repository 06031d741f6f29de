"""Where dark parts stand in their own shadow: they end without an edge there, and edges beside are the shadow's.

A shadow lies on the table, so that with lamps from above it is next to the lower part of what casts it. What is behind
the upper part is lit there, unless another one's shadow or something dark is in the way.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from stereo_pick.core.arrays import Bools, Floats, Image
from stereo_pick.core.edges.edge_map import EdgeMap
from stereo_pick.core.rig import StereoRig
from stereo_pick.core.sampling import places_along, sampled
from stereo_pick.core.shapes.predicted import along_polygon, silhouettes, touched, values_along
from stereo_pick.core.shapes.refinement import medians
from stereo_pick.core.shapes.sight import in_pixels
from stereo_pick.core.shapes.solids import Solids
from stereo_pick.core.shapes.table import Table

_LOW = 0.6  # of a solid's height: straight from above, what lies ends at half of it
_BESIDE_PX = np.array([3.0, -2.5])  # outside and inside of a silhouette, clear of its blur
_SHADED = 1 / 4  # of the step from the part to what is lit, by which shadow is darker than that
_MOST = 0.96  # of the points above the shadow
_POINTS = 60
_TINY = 1e-9


def heights(solids: Solids, eyes_m: Floats, table: Table) -> Floats:
    """How high (S, E, 48) above a table, as parts of their solid's height, the corners of its `silhouettes` are."""
    above_m = table.height_m(touched(solids, eyes_m) + eyes_m[:, None])
    top_m = above_m.max(axis=(1, 2), keepdims=True)
    return np.asarray(above_m / np.maximum(top_m, _TINY))


def is_dark(image: Image, contour_px: Floats) -> bool:
    """Whether what a contour (N, 2) [px] goes around is mostly darker than what is outside."""
    off_px = contour_px - contour_px.mean(axis=0)
    outwards = off_px / np.maximum(np.linalg.norm(off_px, axis=1, keepdims=True), _TINY)
    outside, inside = sampled(image, places_along(contour_px, outwards, _BESIDE_PX)).T
    return bool(np.median(outside - inside) > 0)


def in_own_shadow(image: Image, points_px: Floats, outwards: Floats, height: Floats) -> Bools:
    """Whether points (S, N, 2) [px] of silhouettes, with normals (S, N, 2), so high (S, N), end in a shadow (S, N): low
    down, of a part that is darker than what is behind its upper part, where it is clearly darker than there."""
    outside, inside, behind = _levels(image, points_px, outwards, height)
    step = behind - inside
    return np.asarray((step > 0) & (height < _LOW) & (behind - outside > _SHADED * step))


def ends_in_light(solid: Solids, views: Sequence[EdgeMap], rig: StereoRig, table: Table) -> bool:
    """Whether a dark solid (S = 1) ends where its silhouettes do, as far as they are above its shadow: what is behind
    it is lit all around, where a piece of something as dark would go on."""
    corners, height = silhouettes(solid, rig.eyes_m), heights(solid, rig.eyes_m, table)
    for i, view in enumerate(views):
        places, outwards = along_polygon(corners[:, i], _POINTS)
        high = values_along(corners[:, i], height[:, i], _POINTS)
        points_px = in_pixels(places, view.camera)
        outside, inside, behind = _levels(view.image, points_px, outwards, high)
        lit = (outside > (inside + behind) / 2)[high >= _LOW]
        if not len(lit) or float(lit.mean()) < _MOST:
            return False
    return True


def _levels(image: Image, points_px: Floats, outwards: Floats, height: Floats) -> tuple[Floats, Floats, Floats]:
    """Grey levels beside silhouettes: outside of each point (S, N), inside of most, and outside of most that are high
    (S, 1)."""
    around = places_along(points_px.reshape(-1, 2), outwards.reshape(-1, 2), _BESIDE_PX)
    outside, inside = np.moveaxis(sampled(image, around).reshape(*height.shape, 2), -1, 0)
    behind = medians(outside, height >= _LOW)[:, None]
    return outside, np.median(inside, axis=1, keepdims=True), np.where(np.isfinite(behind), behind, -np.inf)
