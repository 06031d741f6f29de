"""Whether two outlines show one flat face, tilted towards the cameras, and nothing else of its body.

The disparities along the outline of a flat face lie on a plane (Faugeras 1993). So do those along the silhouette of a
ball, but that plane faces the cameras; the top of a part on a table does not, unless they look straight down.
"""

from __future__ import annotations

import numpy as np

from stereo_pick.core.arrays import Floats
from stereo_pick.core.objects import Blob
from stereo_pick.core.rig import StereoRig

_ROWS = 24
_EDGE_PX = 2.0  # rows at the top and at the bottom, where an outline runs along the row, tell no disparity
_FLAT_PX = 0.2  # residual of the disparities from their plane
_FACING_DEG = 20.0


def shows_one_face(left: Blob, right: Blob, rig: StereoRig) -> bool:
    """Whether the outlines (in the rectified views) are those of one flat face that is tilted from facing the left
    camera."""
    top, bottom = (pick(a, b) for pick, a, b in zip((max, min), left.rows_px, right.rows_px))
    if bottom - top < 4 * _EDGE_PX:
        return False
    rows = np.linspace(top + _EDGE_PX, bottom - _EDGE_PX, _ROWS)
    u_left, u_right = _sides(left.contour_px, rows), _sides(right.contour_px, rows)
    focal, (cx, cy), other_cx = rig.focal_px, rig.left.P[:2, 2], rig.right.P[0, 2]
    disparity = (u_left - cx) - (u_right - other_cx)
    terms = np.stack([u_left - cx, np.tile(rows - cy, 2), np.full(2 * _ROWS, focal)], axis=1)
    normal, *_ = np.linalg.lstsq(terms, disparity, rcond=None)
    residual_px = float(np.sqrt(np.mean((terms @ normal - disparity) ** 2)))
    ahead = np.append((left.centroid_px - (cx, cy)) / focal, 1.0)
    cosine = abs(float(normal @ ahead)) / float(np.linalg.norm(normal) * np.linalg.norm(ahead))
    return residual_px < _FLAT_PX and cosine < np.cos(np.deg2rad(_FACING_DEG))


def _sides(contour_px: Floats, rows: Floats) -> Floats:
    """Columns (2 R,) of the leftmost, then of the rightmost crossings of a closed contour with rows (R,)."""
    ahead = np.roll(contour_px, -1, axis=0)
    v, v_ahead = contour_px[:, 1], ahead[:, 1]
    crosses = (v[:, None] <= rows) != (v_ahead[:, None] <= rows)
    share = (rows - v[:, None]) / np.where(crosses, (v_ahead - v)[:, None], 1.0)
    u = contour_px[:, :1] + share * (ahead[:, :1] - contour_px[:, :1])
    return np.concatenate([np.where(crosses, u, np.inf).min(axis=0), np.where(crosses, u, -np.inf).max(axis=0)])
