"""Where, in outlines of several things, a part may be: discs inscribed in them, clear of the solids that are known.

Parts share one outline with what they touch and look like, as with a print or a shadow: its middle and its length say
nothing of any of them.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import cv2
import numpy as np

from stereo_pick.core.arrays import Floats
from stereo_pick.core.found_late.carried import without_edges
from stereo_pick.core.matches.left_over import Unread
from stereo_pick.core.objects import Blob
from stereo_pick.core.rig import StereoRig
from stereo_pick.core.shapes.solid_fit import SolidFit

# Of which the outlines may be those of several things, or of a part of one
_REASONS = ("merged", "cut_by_border", "beside_bright", "left_only", "right_only", "off_table", "other_shape")
_MOST = 8  # discs
_MOST_EACH = 4  # ... in one outline
_LEAST_PX = 6.0  # their radius ...
_LEAST = 0.4  # ... by the largest in the same outline
_APART = 1.5  # radii from the middle of a larger one
_AROUND = 1.4  # radii: so long as a part is that is this thick, as a rule
_MARGIN_PX = 3.0  # from the edge of a view
_TURN = np.arange(24) * (2 * np.pi / 24)
_CIRCLE = np.stack([np.cos(_TURN), np.sin(_TURN)], axis=1)


class Disc(NamedTuple):
    """A disc in an outline of one view, of 0 left and 1 right."""

    outline: Blob
    view: int
    centre_px: Floats
    radius_px: float

    @property
    def unread(self) -> Unread:
        """A circle about it as an outline that this view alone shows, and that has no edges."""
        circle = without_edges(self.outline, self.centre_px + _AROUND * self.radius_px * _CIRCLE)
        return Unread("merged", *((circle, None) if self.view == 0 else (None, circle)))

    def is_filled_by(self, fit: SolidFit, rig: StereoRig) -> bool:
        """Whether a solid, all of which both views show, is as large as the disc: what is smaller is a mark on it."""
        sides = [fit.silhouette_px(camera) for camera in (rig.left, rig.right)]
        last_px = np.array(rig.left.frame_size) - 1 - _MARGIN_PX
        if not all(((side >= _MARGIN_PX) & (side <= last_px)).all() for side in sides):
            return False
        return cv2.contourArea(sides[self.view].astype(np.float32)) > np.pi * self.radius_px**2


def discs_within(refused: Sequence[Unread], fits: Sequence[SolidFit], rig: StereoRig) -> list[Disc]:
    """The largest discs inscribed in what is refused, the largest first; fits: the solids that are known."""
    outlines = [(each.left, 0) if each.left else (each.right, 1) for each in refused if each.reason in _REASONS]
    silhouettes = [[fit.silhouette_px(camera) for fit in fits] for camera in (rig.left, rig.right)]
    found = [disc for outline, view in outlines if outline for disc in _inscribed(outline, view, silhouettes[view])]
    return sorted(found, key=lambda disc: -disc.radius_px)[:_MOST]


def _inscribed(outline: Blob, view: int, known_px: Sequence[Floats]) -> Iterator[Disc]:
    """The largest ones in an outline; known_px: (K, 2), silhouettes that are no part of it."""
    first_px = np.floor(outline.contour_px.min(axis=0)) - 2
    width, height = (np.ceil(outline.contour_px.max(axis=0)) - first_px + 3).astype(int)
    rest = np.zeros((height, width), np.uint8)
    for polygon_px, value in [(outline.contour_px, 1), *((each, 0) for each in known_px)]:
        cv2.fillPoly(rest, [np.round(polygon_px - first_px).astype(np.int32)], value)
    away_px = cv2.distanceTransform(rest, cv2.DIST_L2, cv2.DIST_MASK_5)
    least_px = max(_LEAST_PX, _LEAST * float(away_px.max()))
    for _ in range(_MOST_EACH):
        _, radius_px, _, (x, y) = cv2.minMaxLoc(away_px)
        if radius_px < least_px:
            return
        yield Disc(outline, view, first_px + (x, y), radius_px)
        cv2.circle(away_px, (x, y), int(_APART * radius_px), 0.0, cv2.FILLED)
