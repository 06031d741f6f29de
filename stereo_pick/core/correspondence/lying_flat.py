"""What outlines show beside known solids: prints and shadows lie on the table, parts and their pieces rise from it.

The right view is warped onto the left one by the table's plane. What is on the table looks the same in both then.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import cv2
import numpy as np

from stereo_pick.core.arrays import Bools, Floats, Ints
from stereo_pick.core.camera import Camera
from stereo_pick.core.correspondence.plane_alignment import off_plane
from stereo_pick.core.correspondence.table_windows import (
    Windows,
    at_full_size,
    clear_of_objects,
    matches,
    on_grid,
    pixels_around,
    reduced,
    uneven,
    valid,
)
from stereo_pick.core.correspondence.texture import predicted_sigma_px
from stereo_pick.core.correspondence.window import Grey
from stereo_pick.core.correspondence.window_planes import of_table, sigma_on_table_px
from stereo_pick.core.frames import RectifiedPair
from stereo_pick.core.noise import noise_dn
from stereo_pick.core.objects import Blob
from stereo_pick.core.sampling import remapped
from stereo_pick.core.shapes.kinds import CYLINDER
from stereo_pick.core.shapes.predicted import inside
from stereo_pick.core.shapes.sight import normalized
from stereo_pick.core.shapes.solid_fit import SolidFit
from stereo_pick.core.shapes.surface import entered
from stereo_pick.core.shapes.table import Table

_WIDTH_PX = 640  # of the reduced views, as all pixels here
SIDE_PX, STRIDE_PX = 11, 3  # of windows
_PLACED_PX = 0.05  # sigma that the edges in a window promise: rectified noise is smooth, and seems to promise less
_ALIKE = 0.7  # correlation
_SIGMAS = 3.0
_CLEAR_PX = SIDE_PX / 2 + 2  # from the solids
_WITHIN_PX = _CLEAR_PX  # a solid's outline
_RISES_PX = 1.0  # of disparity, above what is open of the table's, that tells a surface from it
_LEAST = 8  # windows
_MOST, _HALF = 0.9, 0.5  # of them
_LOW = 0.1  # of its length, that is no height
_END = 1 - 1e-6  # of half a length
_TINY = 1e-9


class _Seen(NamedTuple):
    """Windows that show edges, N of them. left, right: their middles (N, 2), where the table puts them in the right
    view; open_px: by how much their disparity (N,) may differ from the table's; alike: how alike (N,) both views are
    there; lies: which of them (N,) show it; itself: which (N,) show edges of their own, and not the halo, in what is
    uneven, of one beside them; view, right_view: those of both cameras, of a scale."""

    left: Floats
    right: Floats
    open_px: Floats
    alike: Floats
    lies: Bools
    itself: Bools
    view: Grey
    right_view: Grey
    scale: float


@dataclass(frozen=True, eq=False)
class WarpedViews:
    """What the views show of a table; looked for where it is asked for."""

    pair: RectifiedPair
    table: Table

    @property
    def scale(self) -> float:
        """Of the reduced views."""
        return min(1.0, _WIDTH_PX / float(self.pair.left.shape[1]))

    def is_all_of(self, outline: Blob, solids: Sequence[SolidFit]) -> bool:
        """Whether all that an outline in the left view shows clear of the solids lies on the table, as far as that is
        known, and something does."""
        rest = self._beside(outline, solids)
        return int(rest.sum()) >= _LEAST and float(self._seen.lies[rest].mean()) > _MOST

    def is_surely_all_of(self, outline: Blob, solids: Sequence[SolidFit]) -> bool:
        """Whether it does, and the table is known so well there that a part as long would show if it stood up."""
        return self._is_known_at(outline) and self.is_all_of(outline, solids)

    def shows_nothing_rise(self, outline: Blob, solids: Sequence[SolidFit]) -> bool:
        """Whether the table, where it is known well enough for a part as long, is seen in an outline in the left view
        clear of the solids, and nothing that rises from it."""
        if not self._is_known_at(outline) or int(self._beside(outline, solids).sum()) < _LEAST:
            return False
        return not self.rising(outline, solids)

    def shows_through(self, fit: SolidFit) -> bool:
        """Whether the table, where it is known well enough to be told from a solid's surface, is seen where the solid
        would hide it from both cameras: there is none."""
        return self._is_known_for(float(fit.size_m.min())) and self.is_seen_in_place_of(fit)

    def is_seen_in_place_of(self, fit: SolidFit) -> bool:
        """Whether the table, as far as it is known, is seen where a solid would hide it from both cameras.

        Windows that are as alike where the solid's surface is say nothing: the shading of a ball fits many disparities.
        Where a solid is so slim that no window is clear of its outline, that lies on the table as well, or it does not.
        """
        within_px, is_slim = self._within(fit)
        hidden, surface_px = self._before_table(fit, within_px > (0.0 if is_slim else _WITHIN_PX))
        if int(hidden.sum()) < _LEAST:
            return False
        told = self._seen.alike[hidden] > self._alike_at(hidden, surface_px)
        return float((self._seen.lies[hidden] & told).mean()) > (_HALF if is_slim else _MOST)

    def is_told_from_marks(self, fit: SolidFit) -> bool:
        """Whether a solid rises by so much, a pixel of disparity of the whole views, that what lies on the table would
        look another way."""
        rig, ahead = self.pair.rig, fit.centre_m / fit.centre_m[2]
        depth_m = entered(fit, rig.eyes_m[0], ahead[None])[0]
        table_depth_m = self.table.offset_m / max(-float(self.table.normal @ ahead), _TINY)
        return bool(rig.focal_px * rig.baseline_m * (1 / depth_m - 1 / table_depth_m) > _RISES_PX)

    def rising(self, outline: Blob, solids: Sequence[SolidFit]) -> list[Floats]:
        """Hulls (K, 2) [px] of what an outline in the left view shows clear of the solids that is not on the table."""
        pieces = self._pieces_off_table(self._beside(outline, solids))
        hulls = [cv2.convexHull(piece.astype(np.float32))[:, 0] for piece in pieces]
        return [at_full_size(hull.astype(np.float64), self._seen.scale) for hull in hulls if len(hull) > 2]

    def risen(self, solids: Sequence[SolidFit]) -> list[Windows]:
        """All that the left view shows clear of the solids that is not on the table, and that the right one shows as
        well, before it: windows of the reduced views, of each of the places where there are some."""
        seen = self._seen
        pieces = self._pieces_off_table(self._clear_of_all(solids) & seen.itself)
        return [
            matches(seen.view, seen.right_view, each, (SIDE_PX, SIDE_PX), self._before_table_px(each))
            for each in pieces
        ]

    def _before_table_px(self, places: Ints) -> tuple[float, float]:
        """The disparities from the table at places (N, 2) to halfway to the cameras."""
        rig, scale = self.pair.rig, self._seen.scale
        table_px = np.c_[places, np.ones(len(places))] @ of_table(self.table, rig, scale)
        apart_px = scale * (rig.left.P[0, 2] - rig.right.P[0, 2])
        return float(table_px.min()), float(2 * table_px.max() - apart_px)

    def _pieces_off_table(self, chosen: Bools) -> list[Ints]:
        """The middles (K, 2), column and row, of those windows, chosen (N,) of all, that do not show the table, of each
        of the places where there are some."""
        seen = self._seen
        column, row = seen.left[chosen & ~seen.lies].astype(int).T
        there = np.zeros(seen.view.shape, np.uint8)
        there[row, column] = 1
        joined = cv2.dilate(there, np.ones((SIDE_PX, SIDE_PX), np.uint8))
        count, labels = cv2.connectedComponents(joined)
        pieces = [np.argwhere((labels == label) & (there > 0))[:, ::-1] for label in range(1, count)]
        return [piece for piece in pieces if len(piece) >= _LEAST]

    def _beside(self, outline: Blob, solids: Sequence[SolidFit]) -> Bools:
        """Which windows (N,) an outline shows clear of the solids."""
        seen = self._seen
        column, row = seen.left.astype(int).T
        rest: Bools = ~clear_of_objects(seen.view, [outline], seen.scale, SIDE_PX, SIDE_PX)[row, column]
        return rest & self._clear_of_all(solids)

    def _clear_of_all(self, solids: Sequence[SolidFit]) -> Bools:
        """Which windows (N,) are clear of the solids in both views."""
        rest = np.ones(len(self._seen.left), np.bool_)
        for fit in solids:
            rest &= self._clear_of(fit)
        return rest

    def _within(self, fit: SolidFit) -> tuple[Floats, bool]:
        """How far windows (N,) are within a solid's outlines, and whether these are too slim for any to be clear of
        them."""
        seen, rig = self._seen, self.pair.rig
        sides = list(zip((rig.left, rig.right), fit.silhouettes(rig)))
        each_px = [_within_px(at, *side, seen.scale) for at, side in zip((seen.left, seen.right), sides)]
        slim_px = min(_half_width_px(*side, seen.scale) for side in sides)
        return np.where(seen.itself, np.minimum(*each_px), -np.inf), slim_px < SIDE_PX

    def _before_table(self, fit: SolidFit, inside_it: Bools) -> tuple[Bools, Floats]:
        """Which of those windows inside its outlines (N,) have its surface clearly before the table, and not in the end
        of what may be a tube: it stands on the table, and that is seen through it; and the surface's disparity (K,) in
        these."""
        seen, rig = self._seen, self.pair.rig
        places = normalized(at_full_size(seen.left[inside_it], seen.scale), rig.left)
        ahead = np.c_[places, np.ones(len(places))]
        depth_m = entered(fit, rig.eyes_m[0], ahead)
        apart_px = rig.left.P[0, 2] - rig.right.P[0, 2]
        surface_px = seen.scale * (rig.focal_px * rig.baseline_m / depth_m + apart_px)
        table_px = (seen.left - seen.right)[inside_it, 0]
        is_before = surface_px - table_px > _RISES_PX + 2 * seen.open_px[inside_it]
        is_before &= ~_in_an_end(fit, rig.eyes_m[0] + depth_m[:, None] * ahead)
        before = inside_it.copy()
        before[inside_it] = is_before
        return before, surface_px[is_before]

    def _alike_at(self, chosen: Bools, disparity_px: Floats) -> Floats:
        """How alike (K,) windows, chosen (N,) of all, are to what the right view shows at these disparities (K,), as of
        `off_plane`."""
        seen = self._seen
        around = pixels_around(seen.left[chosen].astype(int), SIDE_PX)
        there = np.stack([around[1] - disparity_px[:, None], around[0]], axis=-1)
        one, other = seen.view[around], remapped(seen.right_view, there, cv2.BORDER_CONSTANT, cv2.INTER_CUBIC)
        squares = (one * one).sum(axis=1) * (other * other).sum(axis=1)
        return np.asarray((one * other).sum(axis=1) / np.sqrt(np.maximum(squares, _TINY)), np.float64)

    def _is_known_at(self, outline: Blob) -> bool:
        """Whether the table is known so well there that a part as long as an outline would show if it stood up."""
        camera = self.pair.rig.left
        ray = np.append(normalized(outline.centroid_px, camera), 1.0)
        away_m = self.table.offset_m / max(-float(self.table.normal @ ray), _TINY)
        return self._is_known_for(outline.rectangle[0] * away_m / float(camera.P[0, 0]))

    def _is_known_for(self, length_m: float) -> bool:
        return bool(_SIGMAS * self.table.sigma_m < _LOW * length_m)

    @cached_property
    def _clear(self) -> dict[SolidFit, Bools]:
        return {}

    def _clear_of(self, fit: SolidFit) -> Bools:
        """Which windows (N,) are clear of a solid in both views."""
        if fit not in self._clear:
            seen, rig = self._seen, self.pair.rig
            sides = zip((seen.left, seen.right), (rig.left, rig.right), fit.silhouettes(rig))
            left, right = (_within_px(*side, seen.scale) < -_CLEAR_PX for side in sides)
            self._clear[fit] = np.asarray(left & right, np.bool_)
        return self._clear[fit]

    @cached_property
    def _seen(self) -> _Seen:
        pair, rig = self.pair, self.pair.rig
        scale = self.scale
        left, right = uneven(pair.left, rig.left, scale), uneven(pair.right, rig.right, scale)
        plain = reduced(pair.left, scale)
        noise = noise_dn(plain)
        usable = (predicted_sigma_px(left, noise, SIDE_PX, "zncc") < _PLACED_PX) & valid(rig.left, left)
        centre_px = on_grid(usable, SIDE_PX, SIDE_PX, STRIDE_PX).astype(np.float64)
        plane = of_table(self.table, rig, scale)
        windows = Windows(centre_px, np.c_[centre_px, np.ones(len(centre_px))] @ plane)
        off_px, sigma_px, alike = off_plane(left, right, plane, windows, (SIDE_PX, SIDE_PX))
        known_px = np.hypot(sigma_px, sigma_on_table_px(windows, self.table, rig, scale))
        open_px = _SIGMAS * np.asarray(known_px, np.float64)
        lies = (alike > _ALIKE) & (np.abs(off_px) < open_px)
        there_px = windows.centre_px - np.c_[windows.disparity_px, np.zeros(len(centre_px))]
        column, row = centre_px.astype(int).T
        itself = predicted_sigma_px(plain, noise, SIDE_PX, "zncc")[row, column] < _PLACED_PX
        return _Seen(centre_px, there_px, open_px, alike, lies, itself, left, right, scale)


def _in_an_end(fit: SolidFit, places_m: Floats) -> Bools:
    """Which places (N, 3) on the surface of a solid are on the end of a cylinder."""
    if fit.kind != CYLINDER.name:
        return np.zeros(len(places_m), bool)
    along_m = np.abs((places_m - fit.centre_m) @ fit.rotation[:, 2])
    return np.asarray(along_m > _END * fit.size_m[2] / 2, np.bool_)


def _half_width_px(camera: Camera, polygon: Floats, scale: float) -> float:
    """How far the middle of a silhouette (K, 2), normalized, is within it, in a reduced view."""
    middle = (polygon.min(axis=0) + polygon.max(axis=0)) / 2
    return float(inside(middle[None, None], polygon[None])[0, 0] * camera.P[0, 0] * scale)


def _within_px(points_px: Floats, camera: Camera, polygon: Floats, scale: float) -> Floats:
    """How far (N,) places (N, 2) of a reduced view are within a silhouette (K, 2), normalized."""
    places = normalized(at_full_size(points_px, scale), camera)
    return np.asarray(inside(places[None], polygon[None])[0] * camera.P[0, 0] * scale)
