"""Outlines without what belongs to solids that are known to be there."""

from __future__ import annotations

from functools import cache

import numpy as np
from rendered_solids import PARTS, PLACED, RIG, rectified, solid_of
from rendering import Scene

from stereo_pick.core.edges.hypotheses import Images
from stereo_pick.core.objects import Blob
from stereo_pick.core.objects.blob import CUT
from stereo_pick.core.places.clear_of import clear_of
from stereo_pick.core.shapes import SolidFit

SCENE = Scene((PARTS["standing"],), PLACED)
SOLID = solid_of(RIG, SCENE, PARTS["standing"])
KNOWN = SolidFit("cylinder", SOLID.centre_m[0], SOLID.rotation[0], SOLID.size_m()[0], 0.1, np.eye(3))
HALF_PX = 120.0


@cache
def images() -> Images:
    return Images(rectified(RIG, SCENE))


def square_beside(right: bool) -> Blob:
    """A square, a point each pixel, whose left half lies on the known solid in a view."""
    x, y = KNOWN.centre_px(RIG.right if right else RIG.left)
    side = np.arange(-HALF_PX, HALF_PX)
    edge = np.full(len(side), HALF_PX)
    corners = [np.c_[side, -edge], np.c_[edge, side], np.c_[-side, edge], np.c_[-edge, -side]]
    return Blob(np.concatenate(corners) + (x + HALF_PX, y), 100.0, sharpness=np.full(4 * len(side), 0.9))


def test_what_lies_on_a_known_solid_is_cut_off() -> None:
    seen = square_beside(right=False), square_beside(right=True)
    for before, blob, camera in zip(seen, clear_of(seen, images().behind([KNOWN])), (RIG.left, RIG.right)):
        own = blob.contour_px[blob.sharpness > CUT]
        x, y = KNOWN.centre_px(camera)
        radius_px = np.linalg.norm(KNOWN.silhouette_px(camera) - (x, y), axis=1)
        assert np.linalg.norm(own - (x, y), axis=1).min() > radius_px.min()
        far = np.linalg.norm(before.contour_px - (x, y), axis=1) > radius_px.max() + 4
        assert set(map(tuple, before.contour_px[far])) <= set(map(tuple, own))
        gaps_px = np.linalg.norm(np.diff(blob.contour_px, axis=0), axis=1)
        assert gaps_px.max() < 2 and 0 < blob.cut_share < 0.25


def test_where_nothing_is_known_or_nothing_would_be_left_it_is_the_same() -> None:
    seen = square_beside(right=False), square_beside(right=True)
    assert clear_of(seen, images()) == seen
    tiny = Blob(KNOWN.centre_px(RIG.left) + [(0, 0), (1, 0), (1, 1)], 100.0, sharpness=np.full(3, 0.9))
    assert clear_of((tiny, seen[1]), images().behind([KNOWN]))[0] is tiny
