"""What rises from the table, as windows of both views show it: where an object with a pattern is, and how large.

Outlines show such an object in pieces, or not at all, where its pattern is here and there as dark as the table.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from stereo_pick.core.arrays import Bools, Floats, Ints
from stereo_pick.core.objects import Blob
from stereo_pick.core.objects.blob import CUT
from stereo_pick.core.places.position import BlobPair
from stereo_pick.core.rig import StereoRig
from stereo_pick.core.shapes import Outline
from stereo_pick.core.shapes.fitting import Pair, can_be_fitted
from stereo_pick.core.shapes.sight import normalized
from stereo_pick.core.shapes.solid_fit import SolidFit
from stereo_pick.core.shapes.solids import Solids
from stereo_pick.core.shapes.surface_fit import Surface, solids_onto
from stereo_pick.core.shapes.table import Table
from stereo_pick.core.tables.seen_table import LEAST, SIDE_PX, STRIDE_PX, SeenTable
from stereo_pick.core.windows.table_windows import Windows, at_full_size, matches
from stereo_pick.core.windows.window_planes import of_table

_AWAY, _NEAR_PX = 4.0, 2.0  # times as far as most are from the median, and more, from which a disparity is chance
_PLACED_PX = 0.15  # sigma of a window's disparity
_LEAST_APART = 4  # windows of a surface, beside each other
_STEPS = 4  # in which outlines are drawn in by half the side of a window


@dataclass(frozen=True, eq=False)
class Risen:
    """windows: of one object, in reduced views; scale: of these."""

    windows: Windows
    scale: float

    @property
    def shows_a_surface(self) -> bool:
        """Whether it is wider than windows are, in both views, and some of these show its surface alone."""
        if not _may_show_a_surface(self.windows.centre_px):
            return False
        return all(len(self._drawn_in(side, SIDE_PX / 2)) > 2 for side in self._sides)

    @property
    def blobs(self) -> BlobPair:
        """Its outlines at their widest, without edges."""
        left, right = (_without_edges(self._drawn_in(side, 0.0)) for side in self._sides)
        return left, right

    def solids(self, rig: StereoRig, table: Table) -> list[Solids]:
        """What it may be on a table."""
        return solids_onto(self._surface(rig), self._outlines, rig, table)

    @property
    def _outlines(self) -> list[Pair]:
        """What its outlines in both views may be: windows show an edge from up to half their side beside it."""
        several = ([self._drawn_in(side, by_px) for side in self._sides] for by_px in self._steps_px)
        left_over = ((left, right) for left, right in several if len(left) and len(right))
        pairs = [(Outline.from_contour(left), Outline.from_contour(right)) for left, right in left_over]
        return [pair for pair in pairs if can_be_fitted(pair)]

    def _surface(self, rig: StereoRig) -> Surface:
        """What the windows show of its surface, but those at its edges: these show what is nearer."""
        within = self.windows.those(_is_within(self.windows.centre_px))
        places = normalized(at_full_size(within.centre_px, self.scale), rig.left)
        disparity_px = within.disparity_px / self.scale - (rig.left.P[0, 2] - rig.right.P[0, 2])
        sigma_px = _PLACED_PX / self.scale * SIDE_PX / STRIDE_PX  # windows that share pixels are not so many
        return Surface(np.c_[places, np.ones(len(places))], disparity_px, sigma_px)

    @property
    def _steps_px(self) -> Floats:
        return np.linspace(0, SIDE_PX / 2, _STEPS)

    @property
    def _sides(self) -> tuple[Floats, Floats]:
        """The middles (N, 2) of the windows in both views."""
        left = self.windows.centre_px
        return left, left - np.c_[self.windows.disparity_px, np.zeros(len(left))]

    def _drawn_in(self, middles_px: Floats, by_px: float) -> Floats:
        """The hull of windows in the whole view, drawn in, as a contour (K, 2); (0, 2) where what is left is narrower
        than windows tell: no solid can be fitted to a line."""
        hull = _hull(middles_px)
        corner = np.floor(hull.min(axis=0)) - 1
        width, height = np.ceil(hull.max(axis=0) - corner).astype(int) + 2
        covered = np.zeros((height, width), np.uint8)
        cv2.fillConvexPoly(covered, np.round(hull - corner).astype(np.int32), (1,))
        far_px = cv2.distanceTransform(covered, cv2.DIST_L2, cv2.DIST_MASK_PRECISE)
        if far_px.max() - by_px < STRIDE_PX:
            return np.zeros((0, 2))
        contours, _ = cv2.findContours((far_px > by_px).astype(np.uint8), cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
        return at_full_size(max(contours, key=len)[:, 0] + corner, self.scale)


def all_risen(seen: SeenTable, table: Table, solids: Sequence[SolidFit], outlines_px: Sequence[Floats]) -> list[Risen]:
    """What rises from a table clear of the solids, and the right view shows as well, with something of its surface; the
    largest first. outlines_px: (K, 2) each, in the left view, one of which must show some of it."""
    pieces = seen.pieces_off(seen.clear_of_all(solids) & seen.itself)
    pieces = [each for each in pieces if any(_shows(outline, each, seen.scale) for outline in outlines_px)]
    # Before they are looked for in the right view, which takes long.
    pieces = [each for each in pieces if _may_show_a_surface(each)]
    found = [most_of(_matched(each, seen, table)) for each in pieces]
    found.sort(key=lambda each: len(each.disparity_px), reverse=True)
    risen = [Risen(each, seen.scale) for each in found if len(each.disparity_px) >= LEAST]
    return [each for each in risen if each.shows_a_surface]


def _may_show_a_surface(middles_px: Floats | Ints) -> bool:
    """Whether enough windows (N, 2) show a surface alone, sharing pixels as they do."""
    apart = int(_is_within(middles_px).sum()) * STRIDE_PX**2 / SIDE_PX**2  # as many as share no pixels
    return apart >= _LEAST_APART


def _is_within(middles_px: Floats | Ints) -> Bools:
    """Which windows (N,) lie within the hull of all middles (N, 2)."""
    hull = _hull(middles_px)
    edge_px = [cv2.pointPolygonTest(hull, (x, y), True) for x, y in middles_px.tolist()]
    return np.array(edge_px) > SIDE_PX / 2


def _shows(outline_px: Floats, places: Ints, scale: float) -> bool:
    """Whether one of several places (N, 2) of a reduced view is within an outline."""
    contour = outline_px.astype(np.float32)
    whole_px = at_full_size(places.astype(np.float64), scale)
    return any(cv2.pointPolygonTest(contour, (x, y), False) >= 0 for x, y in whole_px.tolist())


def _matched(places: Ints, seen: SeenTable, table: Table) -> Windows:
    """The windows around places (N, 2) that the right view shows, from the table to halfway to the cameras."""
    table_px = np.c_[places, np.ones(len(places))] @ of_table(table, seen.rig, seen.scale)
    apart_px = seen.scale * (seen.rig.left.P[0, 2] - seen.rig.right.P[0, 2])
    reach_px = float(table_px.min()), float(2 * table_px.max() - apart_px)
    return matches(seen.view, seen.right_view, places, (SIDE_PX, SIDE_PX), reach_px)


def most_of(windows: Windows) -> Windows:
    """Those of the windows (N) that are about as near as most."""
    if not len(windows.disparity_px):
        return windows
    off_px = np.abs(windows.disparity_px - np.median(windows.disparity_px))
    return windows.those(off_px < _AWAY * np.median(off_px) + _NEAR_PX)


def _without_edges(contour_px: Floats) -> Blob:
    return Blob(contour_px, 0.0, fault="merged", sharpness=np.full(len(contour_px), CUT))


def _hull(points_px: Floats | Ints) -> NDArray[np.float32]:
    return np.asarray(cv2.convexHull(points_px.astype(np.float32))[:, 0], np.float32)
