"""What windows of both views show of a table, and of what is not on it.

The right view is warped onto the left one by the table's plane. What is on the table looks the same in both then.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import cv2
import numpy as np

from stereo_pick.core.arrays import Bools, Floats, Ints
from stereo_pick.core.camera import Camera
from stereo_pick.core.frames import RectifiedPair
from stereo_pick.core.noise import noise_dn
from stereo_pick.core.objects import Blob
from stereo_pick.core.rig import StereoRig
from stereo_pick.core.shapes.predicted import inside
from stereo_pick.core.shapes.sight import normalized
from stereo_pick.core.shapes.solid_fit import SolidFit
from stereo_pick.core.shapes.table import Table
from stereo_pick.core.windows.plane_alignment import off_plane
from stereo_pick.core.windows.table_windows import (
    Windows,
    at_full_size,
    clear_of_objects,
    on_grid,
    reduced,
    uneven,
    valid,
)
from stereo_pick.core.windows.texture import predicted_sigma_px
from stereo_pick.core.windows.window import Grey
from stereo_pick.core.windows.window_planes import of_table, sigma_on_table_px

SIDE_PX, STRIDE_PX = 11, 3  # of windows
CLEAR_PX = SIDE_PX / 2 + 2  # from a solid's outline
SIGMAS = 3.0
LEAST = 8  # windows
_WIDTH_PX = 640  # of the reduced views, as all pixels here
_PLACED_PX = 0.05  # sigma that the edges in a window promise: rectified noise is smooth, and seems to promise less
_ALIKE = 0.7  # correlation


@dataclass(frozen=True, eq=False)
class SeenTable:
    """Windows that show edges, N of them. left, right: their middles (N, 2), where the table puts them in the right
    view; open_px: by how much their disparity (N,) may differ from the table's; alike: how alike (N,) both views are
    there; lies: which of them (N,) show it; itself: which (N,) show edges of their own, and not the halo, in what is
    uneven, of one beside them; view, right_view: those of both cameras, of a scale; rig: theirs."""

    left: Floats
    right: Floats
    open_px: Floats
    alike: Floats
    lies: Bools
    itself: Bools
    view: Grey
    right_view: Grey
    scale: float
    rig: StereoRig
    _clear: dict[SolidFit, Bools] = field(default_factory=dict)

    @staticmethod
    def of(pair: RectifiedPair, table: Table) -> SeenTable:
        """What a pair of views shows of it."""
        rig = pair.rig
        scale = min(1.0, _WIDTH_PX / float(pair.left.shape[1]))
        left, right = uneven(pair.left, rig.left, scale), uneven(pair.right, rig.right, scale)
        plain = reduced(pair.left, scale)
        noise = noise_dn(plain)
        usable = (predicted_sigma_px(left, noise, SIDE_PX, "zncc") < _PLACED_PX) & valid(rig.left, left)
        centre_px = on_grid(usable, SIDE_PX, SIDE_PX, STRIDE_PX).astype(np.float64)
        plane = of_table(table, rig, scale)
        windows = Windows(centre_px, np.c_[centre_px, np.ones(len(centre_px))] @ plane)
        windows = windows.those(_are_within(windows, valid(rig.right, right)))
        centre_px = windows.centre_px
        off_px, sigma_px, alike = off_plane(left, right, plane, windows, (SIDE_PX, SIDE_PX))
        known_px = np.hypot(sigma_px, sigma_on_table_px(windows, table, rig, scale))
        open_px = SIGMAS * np.asarray(known_px, np.float64)
        lies = (alike > _ALIKE) & (np.abs(off_px) < open_px)
        there_px = windows.centre_px - np.c_[windows.disparity_px, np.zeros(len(centre_px))]
        column, row = centre_px.astype(int).T
        itself = predicted_sigma_px(plain, noise, SIDE_PX, "zncc")[row, column] < _PLACED_PX
        return SeenTable(centre_px, there_px, open_px, alike, lies, itself, left, right, scale, rig)

    def beside(self, outline: Blob, solids: Sequence[SolidFit]) -> Bools:
        """Which windows (N,) an outline in the left view shows clear of the solids."""
        column, row = self.left.astype(int).T
        rest: Bools = ~clear_of_objects(self.view, [outline], self.scale, SIDE_PX, SIDE_PX)[row, column]
        return rest & self.clear_of_all(solids)

    def clear_of_all(self, solids: Sequence[SolidFit]) -> Bools:
        """Which windows (N,) are clear of the solids in both views."""
        rest = np.ones(len(self.left), np.bool_)
        for fit in solids:
            rest &= self._clear_of(fit)
        return rest

    def pieces_off(self, chosen: Bools) -> list[Ints]:
        """Those `pieces` of windows, chosen (N,) of all, that do not show the table."""
        return self.pieces(chosen & ~self.lies)

    def pieces(self, chosen: Bools) -> list[Ints]:
        """The middles (K, 2), column and row, of windows, chosen (N,) of all, of each of the places where there are
        some."""
        column, row = self.left[chosen].astype(int).T
        there = np.zeros(self.view.shape, np.uint8)
        there[row, column] = 1
        joined = cv2.dilate(there, np.ones((SIDE_PX, SIDE_PX), np.uint8))
        count, labels = cv2.connectedComponents(joined)
        pieces = [np.argwhere((labels == label) & (there > 0))[:, ::-1] for label in range(1, count)]
        return [piece for piece in pieces if len(piece) >= LEAST]

    def _clear_of(self, fit: SolidFit) -> Bools:
        """Which windows (N,) are clear of a solid in both views."""
        if fit not in self._clear:
            sides = zip((self.left, self.right), (self.rig.left, self.rig.right), fit.silhouettes(self.rig))
            left, right = (within_px(*side, self.scale) < -CLEAR_PX for side in sides)
            self._clear[fit] = np.asarray(left & right, np.bool_)
        return self._clear[fit]


def _are_within(windows: Windows, seen: Bools) -> Bools:
    """Which (N,) are, where the plane puts them in the right view, within what that camera sees (h, w)."""
    whole = cv2.erode(seen.astype(np.uint8), np.ones((SIDE_PX, SIDE_PX), np.uint8), borderValue=0)
    column = np.round(windows.centre_px[:, 0] - windows.disparity_px).astype(int)
    row = windows.centre_px[:, 1].astype(int)
    inside = (column >= 0) & (column < seen.shape[1])
    return np.asarray(inside & (whole[row, np.where(inside, column, 0)] > 0), np.bool_)


def within_px(points_px: Floats, camera: Camera, polygon: Floats, scale: float) -> Floats:
    """How far (N,) places (N, 2) of a reduced view are within a silhouette (K, 2), normalized."""
    places = normalized(at_full_size(points_px, scale), camera)
    return np.asarray(inside(places[None], polygon[None])[0] * camera.P[0, 0] * scale)
