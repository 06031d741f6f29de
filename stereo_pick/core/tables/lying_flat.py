"""What outlines show beside known solids: prints and shadows lie on the table, parts and their pieces rise from it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import cv2
import numpy as np

from stereo_pick.core.arrays import Bools, Floats
from stereo_pick.core.camera import Camera
from stereo_pick.core.frames import RectifiedPair
from stereo_pick.core.objects import Blob
from stereo_pick.core.sampling import remapped
from stereo_pick.core.shapes.kinds import CYLINDER
from stereo_pick.core.shapes.predicted import inside
from stereo_pick.core.shapes.sight import normalized
from stereo_pick.core.shapes.solid_fit import SolidFit
from stereo_pick.core.shapes.surface import entered, facing
from stereo_pick.core.shapes.table import Table
from stereo_pick.core.tables.seen_table import CLEAR_PX, LEAST, SIDE_PX, SIGMAS, SeenTable, within_px
from stereo_pick.core.windows.table_windows import at_full_size, pixels_around

_WITHIN_PX = CLEAR_PX  # a solid's outline
_RISES_PX = 1.0  # of disparity, above what is open of the table's, that tells a surface from it
_UNLIKE = 0.5  # correlation of windows that show something else: those of shading are alike at many disparities
_MOST, _HALF = 0.9, 0.5  # of the windows
_LOW = 0.1  # of its length, that is no height
_END = 1 - 1e-6  # of half a length
_TINY = 1e-9


@dataclass(frozen=True, eq=False)
class WarpedViews:
    """What the views show of a table; looked for where it is asked for."""

    pair: RectifiedPair
    table: Table

    def is_all_of(self, outline: Blob, solids: Sequence[SolidFit]) -> bool:
        """Whether all that an outline in the left view shows clear of the solids lies on the table, as far as that is
        known, and something does."""
        return self._all_lie(self.seen.beside(outline, solids))

    def is_surely_all_of(self, fit: SolidFit, outline: Blob, solids: Sequence[SolidFit]) -> bool:
        """Whether it does, and nothing rises, however little of the outline that may be, and the table is known so well
        there that a part as long would show if it stood up, and a piece of one of the solids as thin as that is if it
        lay there."""
        if not self._is_known_at(outline) or not self._would_show_piece_of(fit):
            return False
        return self.is_all_of(outline, solids) and not self._rises(self.seen.beside(outline, solids))

    def is_surely_all_beside(self, fit: SolidFit, outline: Blob, solids: Sequence[SolidFit]) -> bool:
        """Whether all that an outline in the left view shows clear of the solids, no farther from one of them than that
        is long, lies on the table, which is known so well that it would show if it rose, and something does: a plain
        piece of it shows its edges only, the nearest of which may lie there."""
        if not self._is_known_for(float(fit.size_m.mean())) or not self._would_show_piece_of(fit):
            return False
        rig, seen = self.pair.rig, self.seen
        silhouette = fit.silhouettes(rig)[0]
        reach_px = _length_px(rig.left, silhouette, seen.scale)
        near = seen.beside(outline, solids) & (within_px(seen.left, rig.left, silhouette, seen.scale) > -reach_px)
        return self._all_lie(near) and not self._rises(near)

    def shows_nothing_rise(self, outline: Blob, solids: Sequence[SolidFit]) -> bool:
        """Whether the table, where it is known well enough for a part as long, is seen in an outline in the left view
        clear of the solids, and nothing that rises from it."""
        if not self._is_known_at(outline) or int(self.seen.beside(outline, solids).sum()) < LEAST:
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
        if int(hidden.sum()) < LEAST:
            return False
        told = self.seen.alike[hidden] > self._alike_at(hidden, surface_px)
        return float((self.seen.lies[hidden] & told).mean()) > (_HALF if is_slim else _MOST)

    def is_seen_in_place_of_some(self, fit: SolidFit) -> bool:
        """Whether the table is surely seen where a face of a solid that looks up would hide it from both cameras: some
        of the solid is none, but lies beside it. In faces that stand the table mirrors as if it went on behind them,
        and what is seen at a slant is no more alike where it is than elsewhere."""
        within_px, _ = self._within(fit)
        hidden, surface_px = self._before_table(fit, within_px > _WITHIN_PX)
        if int(hidden.sum()) < LEAST:
            return False
        through = self.seen.lies[hidden] & (self._alike_at(hidden, surface_px) < _UNLIKE)
        hidden[hidden] = through & self._looks_up(fit, hidden)
        return len(self.seen.pieces(hidden)) > 0

    def is_told_from_marks(self, fit: SolidFit) -> bool:
        """Whether a solid rises by so much, a pixel of disparity of the whole views, that what lies on the table would
        look another way."""
        rig, ahead = self.pair.rig, fit.centre_m / fit.centre_m[2]
        depth_m = entered(fit, rig.eyes_m[0], ahead[None])[0]
        table_depth_m = self.table.offset_m / max(-float(self.table.normal @ ahead), _TINY)
        return bool(rig.focal_px * rig.baseline_m * (1 / depth_m - 1 / table_depth_m) > _RISES_PX)

    def rising(self, outline: Blob, solids: Sequence[SolidFit]) -> list[Floats]:
        """Hulls (K, 2) [px] of what an outline in the left view shows clear of the solids that is not on the table."""
        pieces = self.seen.pieces_off(self.seen.beside(outline, solids))
        hulls = [cv2.convexHull(piece.astype(np.float32))[:, 0] for piece in pieces]
        return [at_full_size(hull.astype(np.float64), self.seen.scale) for hull in hulls if len(hull) > 2]

    def _within(self, fit: SolidFit) -> tuple[Floats, bool]:
        """How far windows (N,) are within a solid's outlines, and whether these are too slim for any to be clear of
        them."""
        seen, rig = self.seen, self.pair.rig
        sides = list(zip((rig.left, rig.right), fit.silhouettes(rig)))
        each_px = [within_px(at, *side, seen.scale) for at, side in zip((seen.left, seen.right), sides)]
        slim_px = min(_half_width_px(*side, seen.scale) for side in sides)
        return np.where(seen.itself, np.minimum(*each_px), -np.inf), slim_px < SIDE_PX

    def _before_table(self, fit: SolidFit, inside_it: Bools) -> tuple[Bools, Floats]:
        """Which of those windows inside its outlines (N,) have its surface clearly before the table, and not in the end
        of what may be a tube: it stands on the table, and that is seen through it; and the surface's disparity (K,) in
        these."""
        seen, rig = self.seen, self.pair.rig
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

    def _looks_up(self, fit: SolidFit, chosen: Bools) -> Bools:
        """Whether a solid's surface is nearer to level than to upright (K,) at the windows chosen (N,) of all."""
        places = normalized(at_full_size(self.seen.left[chosen], self.seen.scale), self.pair.rig.left)
        up = facing(fit, self.pair.rig.eyes_m[0], np.c_[places, np.ones(len(places))]) @ self.table.normal
        return np.asarray(up > np.sqrt(0.5), np.bool_)

    def _alike_at(self, chosen: Bools, disparity_px: Floats) -> Floats:
        """How alike (K,) windows, chosen (N,) of all, are to what the right view shows at these disparities (K,), as of
        `off_plane`."""
        seen = self.seen
        around = pixels_around(seen.left[chosen].astype(int), SIDE_PX)
        there = np.stack([around[1] - disparity_px[:, None], around[0]], axis=-1)
        one, other = seen.view[around], remapped(seen.right_view, there, cv2.BORDER_CONSTANT, cv2.INTER_CUBIC)
        squares = (one * one).sum(axis=1) * (other * other).sum(axis=1)
        return np.asarray((one * other).sum(axis=1) / np.sqrt(np.maximum(squares, _TINY)), np.float64)

    def _rises(self, chosen: Bools) -> bool:
        """Whether some of the windows chosen (N,) of all, in one place, show something else than the table: those that
        are nearly as alike as need be may be a little beside it, as where something hides a part of them."""
        return len(self.seen.pieces_off(chosen & (self.seen.alike < _UNLIKE))) > 0

    def _all_lie(self, chosen: Bools) -> bool:
        """Whether all windows chosen (N,) of all lie on the table, but for a few, and there are some."""
        return int(chosen.sum()) >= LEAST and float(self.seen.lies[chosen].mean()) > _MOST

    def _is_known_at(self, outline: Blob) -> bool:
        """Whether the table is known so well there that a part as long as an outline would show if it stood up."""
        camera = self.pair.rig.left
        ray = np.append(normalized(outline.centroid_px, camera), 1.0)
        away_m = self.table.offset_m / max(-float(self.table.normal @ ray), _TINY)
        return self._is_known_for(outline.rectangle[0] * away_m / float(camera.P[0, 0]))

    def _is_known_for(self, length_m: float) -> bool:
        return bool(SIGMAS * self.table.sigma_m < _LOW * length_m)

    def _would_show_piece_of(self, fit: SolidFit) -> bool:
        """Whether what is as thin as a solid rises by more than the table may be mistaken, and by more than is open
        then."""
        return bool(2 * SIGMAS * self.table.sigma_m < float(fit.size_m.min()))

    @cached_property
    def seen(self) -> SeenTable:
        """Their windows."""
        return SeenTable.of(self.pair, self.table)


def _in_an_end(fit: SolidFit, places_m: Floats) -> Bools:
    """Which places (N, 3) on the surface of a solid are on the end of a cylinder."""
    if fit.kind != CYLINDER.name:
        return np.zeros(len(places_m), bool)
    along_m = np.abs((places_m - fit.centre_m) @ fit.rotation[:, 2])
    return np.asarray(along_m > _END * fit.size_m[2] / 2, np.bool_)


def _length_px(camera: Camera, polygon: Floats, scale: float) -> float:
    """How long a silhouette (K, 2), normalized, is in a reduced view, at most."""
    apart = np.linalg.norm(polygon[:, None] - polygon, axis=2)
    return float(apart.max() * camera.P[0, 0] * scale)


def _half_width_px(camera: Camera, polygon: Floats, scale: float) -> float:
    """How far the middle of a silhouette (K, 2), normalized, is within it, in a reduced view."""
    middle = (polygon.min(axis=0) + polygon.max(axis=0)) / 2
    return float(inside(middle[None, None], polygon[None])[0, 0] * camera.P[0, 0] * scale)
