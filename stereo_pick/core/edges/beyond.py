"""What a solid has beyond the outlines that it was fitted to, and whether the views show that.

An object with a notch may be one body of which a side is hardly lit, or two that touch: only the body has faint edges
where its solid closes the notch.
"""

from __future__ import annotations

from collections.abc import Sequence

import cv2
import numpy as np

from stereo_pick.core.arrays import Bools, Floats
from stereo_pick.core.edges.edge_map import EdgeMap
from stereo_pick.core.shapes.predicted import along_polygon, silhouettes
from stereo_pick.core.shapes.sight import in_pixels
from stereo_pick.core.shapes.solids import Solids

_POINTS = 72
_BEYOND_PX = 3.0
_FEWEST = 6  # points that tell something
_REACH_PX = 1.5

Contour = tuple[Floats, Bools]


def shown_beyond(solid: Solids, eyes_m: Floats, views: Sequence[EdgeMap], contours: Sequence[Contour]) -> float:
    """The part of a solid's silhouette (S = 1) outside the object's contours that lies on edges, the lesser of both
    views; 1 where there is none outside.

    contours: in each view points (N, 2) [px], and which of them (N,) are on an edge of the object or of its light: past
    the others something else may hide it.
    """
    return min(
        _shown(silhouettes(solid, eyes_m[i : i + 1])[0, 0], view, contour)
        for i, (view, contour) in enumerate(zip(views, contours))
    )


def _shown(polygon: Floats, view: EdgeMap, contour: Contour) -> float:
    points, normals = (part[0] for part in along_polygon(polygon[None], _POINTS))
    pixels = in_pixels(points, view.camera)
    outline, own = contour
    inside = np.array([cv2.pointPolygonTest(outline.astype(np.float32), (x, y), True) for x, y in pixels.tolist()])
    nearest = ((pixels[:, None] - outline) ** 2).sum(axis=2).argmin(axis=1)
    beyond = (inside < -_BEYOND_PX) & own[nearest]
    if beyond.sum() < _FEWEST:
        return 1.0
    return float(view.shows(pixels, normals, _REACH_PX, beyond)[beyond].mean())
