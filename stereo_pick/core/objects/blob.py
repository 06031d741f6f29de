"""One object's outline in one rectified view."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import cv2
import numpy as np

from stereo_pick.core.arrays import Bools, Floats, floats
from stereo_pick.core.errors import ArrayError

MAX_CONCAVITY = 0.15
"""Depth of the deepest notch in the outline of one part, as a part of its width."""

SHARP = 0.25
"""Sharpness from which a contour point is on an edge, and not where light merely fades."""

MAY_BE_CUT = 0.25
"""Part of an outline that may lie on a cut, where nothing else tells that the rest is one part's."""

_ON_HULL_PX = 1.0
_CORNER = 0.25  # of a part's width, from a cut, that the shade between two parts reaches

CUT = -1.0
"""Sharpness of contour points where there is no edge: touching parts were cut apart there."""


@dataclass(frozen=True, eq=False)
class Blob:
    """An 8-connected object in a rectified view, given by its outer contour.

    contour_px: (N, 2) [px], sub-pixel, pixel centres at whole numbers; contrast: grey levels by
    which the object differs from its background; cut: whether the image border cuts it off;
    fault: why it must not be matched, a reason of `refusal.REASONS`, or empty; sharpness: (N,), how much of the
    change of light at each contour point is a step (see `edge_model`), CUT on a cut, or (0,) where that was not
    measured; peak: grey levels by which a tenth of the object differs.
    """

    contour_px: Floats
    contrast: float
    cut: bool = False
    fault: str = ""
    sharpness: Floats = field(default_factory=lambda: np.zeros(0))
    peak: float = 0.0

    def __post_init__(self) -> None:
        contour = floats("contour_px", self.contour_px, None, 2)
        if len(contour) < 3:
            raise ArrayError(f"contour_px has {len(contour)} points, needs 3")
        object.__setattr__(self, "contour_px", contour)

    @cached_property
    def area_px2(self) -> float:
        """Area inside the contour [px²]."""
        return abs(_signed_area(self.contour_px))

    @cached_property
    def centroid_px(self) -> Floats:
        """Centre of gravity (2,) of the area inside the contour (Green's theorem) [px]."""
        origin = self.contour_px[0]  # large coordinates cost digits
        x, y = (np.concatenate([self.contour_px, self.contour_px[:1]]) - origin).T
        cross = x[:-1] * y[1:] - x[1:] * y[:-1]
        first = np.array([(x[:-1] + x[1:]) @ cross, (y[:-1] + y[1:]) @ cross])
        if cross.sum() == 0:  # a line, there and back
            return np.asarray(self.contour_px.mean(axis=0))
        return np.asarray(origin + first / (3 * cross.sum()))

    @cached_property
    def rows_px(self) -> tuple[float, float]:
        """Top and bottom row of the contour [px]."""
        return float(self.contour_px[:, 1].min()), float(self.contour_px[:, 1].max())

    @cached_property
    def rectangle(self) -> tuple[float, float, float]:
        """Length and width [px] of the smallest enclosing rectangle, and the length's direction [rad]."""
        _, (a, b), degrees = cv2.minAreaRect(self.contour_px.astype(np.float32))
        if a < b:
            a, b, degrees = b, a, degrees + 90
        return float(a), float(b), float(np.deg2rad((degrees + 90) % 180 - 90))

    @property
    def fading(self) -> float:
        """The part of the outline, without cuts, where light fades instead of ending; 0 where that was not measured."""
        own = self.sharpness[self.sharpness > CUT]
        return float((own < SHARP).mean()) if len(own) else 0.0

    @property
    def fading_notch(self) -> float:
        """The part of the outline where light fades in a notch, and not in the corner beside a part it was cut from."""
        fades = (self.sharpness > CUT) & (self.sharpness < SHARP) & ~self.on_hull
        if fades.any() and self.cut_share > 0:
            cut_px = self.contour_px[self.sharpness <= CUT]
            off_px = np.linalg.norm(self.contour_px[:, None] - cut_px, axis=2).min(axis=1)
            fades &= off_px > _CORNER * self.rectangle[1]
        return float(fades.mean()) if len(fades) else 0.0

    @property
    def cut_share(self) -> float:
        """The part of the outline that lies on a cut."""
        return float((self.sharpness <= CUT).mean()) if len(self.sharpness) else 0.0

    @cached_property
    def on_hull(self) -> Bools:
        """Which contour points (N,) are on its convex hull: what lies in a notch is not the edge of one convex part."""
        hull = cv2.convexHull(self.contour_px.astype(np.float32))[:, 0].astype(np.float64)
        ahead = np.roll(hull, -1, axis=0) - hull
        inward = np.stack([-ahead[:, 1], ahead[:, 0]], axis=1) / np.linalg.norm(ahead, axis=1, keepdims=True)
        inward *= np.sign(_signed_area(hull))
        inside_px = (self.contour_px @ inward.T - (hull * inward).sum(axis=1)).min(axis=1)
        return np.asarray(inside_px < _ON_HULL_PX)

    @cached_property
    def concavity(self) -> float:
        """Depth of the deepest notch in the outline, as a part of the object's width.

        The outline of a convex part is convex, from wherever one looks. In the corner between two parts that were cut
        apart there is shade: only what is on edges counts there.
        """
        own = self.sharpness >= SHARP
        contour_px = self.contour_px[own] if self.cut_share > 0 and own.sum() > 3 else self.contour_px
        outline = np.round(contour_px * 16).astype(np.int32)
        hull = cv2.convexHull(outline, returnPoints=False)
        hull[::-1].sort(axis=0)
        defects = cv2.convexityDefects(outline, hull) if len(hull) > 3 else None
        if defects is None:
            return 0.0
        depth_px = float(defects[..., 3].max()) / 256 / 16
        return depth_px / max(self.rectangle[1], 1.0)


@dataclass(frozen=True, eq=False)
class Blobs:
    """The objects found in both rectified views, and the polarity that both were found with.

    view_faults: why the left and the right view cannot show all objects, a reason of `refusal.REASONS`, or empty;
    max_concavity: that of one part's outline; others: what may be objects of the other polarity, if there is any;
    moved_px: how far the surface was moved since it was learned, infinite where it no longer looks like that.
    """

    left: tuple[Blob, ...]
    right: tuple[Blob, ...]
    polarity: str
    view_faults: tuple[str, str] = ("", "")
    max_concavity: float = MAX_CONCAVITY
    others: Blobs | None = None
    moved_px: float = 0.0

    @property
    def may_be_shaded(self) -> bool:
        """Whether shadows may be among these, or be one with them: where they are what is darker than the table."""
        return self.polarity != "bright"

    def sound(self) -> tuple[list[Blob], list[Blob]]:
        """The objects of the left and of the right view that may be matched."""
        return [blob for blob in self.left if not blob.fault], [blob for blob in self.right if not blob.fault]


def _signed_area(contour: Floats) -> float:
    x, y = np.concatenate([contour, contour[:1]]).T
    return 0.5 * float(x[:-1] @ y[1:] - y[:-1] @ x[1:])
