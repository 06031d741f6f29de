"""The lit top of a body, where one view's outline is that of the top alone and the other's takes in a side as well.

The top is level: at the right height above the table, every point of its rim in one view has its edge in the other,
whether or not an outline runs along it there.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from stereo_pick.core.arrays import Floats
from stereo_pick.core.edges.edge_map import EdgeMap
from stereo_pick.core.rig import StereoRig
from stereo_pick.core.shapes.fitting import Pair, can_be_fitted
from stereo_pick.core.shapes.outline import Outline
from stereo_pick.core.shapes.sight import normalized
from stereo_pick.core.shapes.table import EDGE_ON, Table
from stereo_pick.core.shapes.transferred import transferred

_REACH_PX = 1.5
_STEP_PX = 1.0  # of disparity, from one height to the next
_TALLEST = 2.0  # height by length of the outline
_WHOLE = 0.9  # part of an outline from which it is that of the top alone


def shared_face(pair: Pair, rig: StereoRig, views: Sequence[EdgeMap], table: Table) -> Pair | None:
    """The top's own outlines in both views, one of them moved from where it was seen; None where neither is a top's.

    How high it lies is known to a few pixels of disparity: strong edges are wide.
    """
    heights_m = _heights_m(pair[0], rig, table)
    if not len(heights_m):
        return None
    shares = [_share(pair[i], heights_m, rig, i, views[1 - i], table) for i in (0, 1)]
    trusted = [side.weight.sum() for side in pair]
    own = int((shares[1].max(), trusted[1]) > (shares[0].max(), trusted[0]))
    best = shares[own].max()
    if best < _WHOLE:
        return None
    height_m = heights_m[shares[own] == best].mean(keepdims=True)
    points, normals = _moved(pair[own], height_m, rig, own, table)
    moved = Outline(points[0], normals[0], pair[own].weight, pair[own].corner)
    face = (pair[0], moved) if own == 0 else (moved, pair[1])
    return face if can_be_fitted(face) else None


def _heights_m(outline: Outline, rig: StereoRig, table: Table) -> Floats:
    """Heights (K,) [m] above the table, by which the disparity changes step by step; none where it is seen edge-on."""
    rays = np.insert(normalized(outline.points_px, rig.left), 2, 1.0, axis=1)
    slopes = rays @ table.normal
    if slopes.max() > -EDGE_ON:
        return np.zeros(0)
    slope, length = float(slopes.mean()), float(np.ptp(rays, axis=0).max())
    depth_m = -table.offset_m / slope
    step_m = -slope * depth_m**2 / (rig.focal_px * rig.baseline_m) * _STEP_PX
    return np.asarray(np.arange(1, 2 + int(_TALLEST * length * depth_m / step_m)) * step_m, np.float64)


def _share(outline: Outline, heights_m: Floats, rig: StereoRig, own: int, other: EdgeMap, table: Table) -> Floats:
    """The part (K,) of a view's outline that has its edge in the other view, if it lies so high (K,) [m]."""
    points, normals = _moved(outline, heights_m, rig, own, table)
    asked = np.tile(outline.weight > 0, (len(points), 1))
    shown = other.shows(points, normals, _REACH_PX, asked)
    return np.asarray(shown @ outline.weight / max(outline.weight.sum(), 1.0))


def _moved(outline: Outline, heights_m: Floats, rig: StereoRig, own: int, table: Table) -> tuple[Floats, Floats]:
    """Points and normals (K, N, 2) of one view's outline in the other view, if it lies so high (K,) [m]."""
    along = np.stack([-outline.normals[:, 1], outline.normals[:, 0]], axis=1) / 2
    before, after = (transferred(outline.points_px + off, heights_m, rig, own, table) for off in (-along, along))
    ahead = after - before
    normals = np.stack([ahead[..., 1], -ahead[..., 0]], axis=-1) / np.linalg.norm(ahead, axis=-1, keepdims=True)
    return (before + after) / 2, normals
