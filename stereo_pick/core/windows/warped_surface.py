"""What both views show where the surface of a solid is: the right one warped onto the left one by it.

What is printed on the surface looks the same in both then.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from stereo_pick.core.arrays import Bools, Floats, Image, Ints
from stereo_pick.core.camera import Camera
from stereo_pick.core.frames import RectifiedPair
from stereo_pick.core.noise import noise_dn
from stereo_pick.core.rig import StereoRig
from stereo_pick.core.sampling import remapped
from stereo_pick.core.shapes.sight import normalized
from stereo_pick.core.shapes.solid_fit import SolidFit
from stereo_pick.core.shapes.surface import entered
from stereo_pick.core.windows.table_windows import on_grid, pixels_around
from stereo_pick.core.windows.texture import predicted_sigma_px
from stereo_pick.core.windows.window import Grey

ALIKE = 0.7  # correlation of windows that show the same
LEAST = 8  # windows
SIDE_PX, _STRIDE_PX = 11, 3  # of windows
_PLACED_PX = 0.05  # sigma that the edges in a window promise, as a rule
_BLUR_PX = 2  # beyond windows, where outlines still show
_AROUND = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (SIDE_PX + 2 * _BLUR_PX, SIDE_PX + 2 * _BLUR_PX))
_HIDDEN = 1e-3  # of the depth, by which a place behind the surface is hidden by it


@dataclass(frozen=True, eq=False)
class WarpedSurface:
    """The part (h, w) of the left view around a solid, less its mean; right: the right view, less the same; columns,
    rows: where in that the surface shows each pixel; usable: of which the windows show edges, on the surface and on
    nothing else; share: the part that these are of all on the surface; within: which pixels of the right view are;
    corner_px: the upper left one."""

    left: Grey
    right: Grey
    columns: Grey
    rows: Grey
    usable: Bools
    share: float
    within: Image
    corner_px: tuple[int, int]

    @staticmethod
    def of(
        pair: RectifiedPair, fit: SolidFit, others: Sequence[SolidFit], placed_px: float = _PLACED_PX
    ) -> WarpedSurface | None:
        """None where too little of the solid is in the view, or shows anything; placed_px: sigma that the edges in a
        window must promise."""
        rig = pair.rig
        outline = fit.silhouette_px(rig.left)
        height, width = pair.left.shape
        x0, y0 = np.maximum(np.floor(outline.min(axis=0)).astype(int), 0)
        x1, y1 = np.minimum(np.ceil(outline.max(axis=0)).astype(int) + 1, (width, height))
        if min(x1 - x0, y1 - y0) <= 2 * SIDE_PX:
            return None
        left, right = pair.left[y0:y1, x0:x1].astype(np.float32), pair.right[y0:y1].astype(np.float32)
        on_it = _well_within(fit, others, rig.left, (x0, y0), left.shape) > 0
        if not on_it.any():
            return None
        tells = predicted_sigma_px(left, noise_dn(left, on_it), SIDE_PX, "zncc") < placed_px
        if len(on_grid(tells & on_it, SIDE_PX, SIDE_PX, _STRIDE_PX)) < LEAST:
            return None
        column, row = np.meshgrid(np.arange(x0, x1, dtype=np.float64), np.arange(y0, y1, dtype=np.float64))
        seen, there = _in_the_right_view(fit, rig, np.stack([column, row], axis=-1).reshape(-1, 2))
        columns, rows = there.reshape(left.shape).astype(np.float32), (row - y0).astype(np.float32)
        within = _well_within(fit, others, rig.right, (0, y0), right.shape)
        on_it &= seen.reshape(left.shape) & (cv2.remap(within, columns, rows, cv2.INTER_NEAREST) > 0)
        usable = tells & on_it
        share = float(usable.sum()) / max(int(on_it.sum()), 1)
        level = left.mean()  # without which squares in single precision are exact enough
        return WarpedSurface(left - level, right - level, columns, rows, usable, share, within, (int(x0), int(y0)))

    def windows(self, chosen: Bools) -> Ints:
        """The usable windows (N, 2), column and row, of which the middles are among these pixels (h, w)."""
        return on_grid(self.usable & chosen, SIDE_PX, SIDE_PX, _STRIDE_PX)

    def clear_of(self, outline_px: Floats) -> Bools:
        """Which pixels (h, w) are at the middle of windows outside an outline (M, 2) in the left view."""
        covered = np.zeros(self.usable.shape, np.uint8)
        cv2.fillPoly(covered, [np.round(outline_px - self.corner_px).astype(np.int32)], (1,))
        return np.asarray(cv2.dilate(covered, _AROUND) == 0)

    def alike(self, off_px: float) -> Grey:
        """Correlation (h, w) of the windows with what the right view shows so far before the surface; -1 where that is
        not within the solid."""
        there = cv2.remap(self.right, self.columns - np.float32(off_px), self.rows, cv2.INTER_CUBIC)
        within = cv2.remap(self.within, self.columns - np.float32(off_px), self.rows, cv2.INTER_NEAREST)
        alike = _correlation(self.left, np.asarray(there, np.float32), _means_around)
        return np.asarray(np.where(within > 0, alike, -1), np.float32)

    def alike_at(self, places: Ints, off_px: float) -> Grey:
        """The same (N,) of the windows at some places (N, 2), column and row."""
        x, y = places.T
        if len(places) * SIDE_PX**2 > self.left.size:
            return np.asarray(self.alike(off_px)[y, x])
        around = pixels_around(places, SIDE_PX)
        points = np.stack([self.columns[around] - np.float32(off_px), self.rows[around]], axis=-1)
        there = remapped(self.right, points, cv2.BORDER_CONSTANT, cv2.INTER_CUBIC)
        middle = points[:, SIDE_PX**2 // 2, None]
        within = remapped(self.within, middle, cv2.BORDER_CONSTANT, cv2.INTER_NEAREST)[:, 0]
        alike = _correlation(self.left[around], there, lambda grey: grey.mean(axis=1))
        return np.asarray(np.where(within > 0, alike, -1), np.float32)


def _correlation(one: Grey, other: Grey, mean: Callable[[Grey], NDArray[Any]]) -> Grey:
    """Of windows of one view with those of the other; mean: of each window."""
    means = [mean(each) for each in (one, other)]
    squares = [mean(each * each) - m * m for each, m in zip((one, other), means)]
    both = mean(one * other) - means[0] * means[1]
    return np.asarray(both / np.sqrt(np.maximum(squares[0] * squares[1], np.float32(1e-6))), np.float32)


def _means_around(grey: Grey) -> Grey:
    return np.asarray(cv2.boxFilter(grey, -1, (SIDE_PX, SIDE_PX)), np.float32)


def _in_the_right_view(fit: SolidFit, rig: StereoRig, places_px: Floats) -> tuple[Bools, Floats]:
    """Whether the right camera sees what the left one sees of a solid at these places (N, 2), and in which column."""
    ahead = np.c_[normalized(places_px, rig.left), np.ones(len(places_px))]
    left_eye, right_eye = rig.eyes_m
    depth_m = entered(fit, left_eye, ahead)
    share = entered(fit, right_eye, ahead * depth_m[:, None] - right_eye)
    shift_px = rig.left.P[0, 2] - rig.right.P[0, 2] + rig.focal_px * rig.baseline_m / depth_m
    return np.asarray(share > 1 - _HIDDEN), np.nan_to_num(places_px[:, 0] - shift_px, nan=-1.0)


def _well_within(
    fit: SolidFit, others: Sequence[SolidFit], camera: Camera, corner_px: tuple[int, int], shape: tuple[int, ...]
) -> Image:
    """Where in a part (h, w) of a view, with that upper left corner, windows show a solid and no other: 1, else 0."""
    covered = [np.zeros(shape, np.uint8) for _ in range(2)]
    for which, each in [(0, fit), *((1, other) for other in others)]:
        outline = np.round(each.silhouette_px(camera) - corner_px).astype(np.int32)
        cv2.fillPoly(covered[which], [outline], (1,))
    own = cv2.erode(covered[0], _AROUND, borderType=cv2.BORDER_CONSTANT, borderValue=(0,))
    return np.where(cv2.dilate(covered[1], _AROUND) > 0, 0, own).astype(np.uint8)
