"""Method `ssd`: the thesis's modified SSD (3.6 and 3.7): the centroids of the left view, found again by correlation."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from stereo_pick.core.arrays import Bools, Floats
from stereo_pick.core.correspondence.correspondences import Correspondences, Match, collect
from stereo_pick.core.correspondence.feature import Feature
from stereo_pick.core.correspondence.left_over import left_over
from stereo_pick.core.correspondence.method import Method
from stereo_pick.core.correspondence.window import Grey, WindowFit, refine, ssd_along_row, window_at
from stereo_pick.core.errors import ParameterError
from stereo_pick.core.frames import RectifiedPair
from stereo_pick.core.objects import Blob, Blobs
from stereo_pick.core.params import parameter
from stereo_pick.core.refusal import Refusal

_MODEL_SIGMA_PX = 0.6  # in each view: a window seen from two sides is not the same picture; see docs/accuracy.md
_FULL_WINDOW_PX = 3


@dataclass(frozen=True)
class Ssd(Method):
    """Correlates the window around each left centroid along its epipolar line; finds a point of the surface.

    Needs texture: on a plain part there is nothing to correlate, and the part is refused.
    """

    search: str = parameter(
        "epipolar",
        "Where the window is looked for: along the epipolar line within the region of interest, checked and to a part "
        "of a pixel; or, as in the thesis's unmodified method, 3 x 3 over the whole right image, taken as it comes.",
        choices=("epipolar", "full"),
    )
    window_px: int = parameter(15, "Width and height of the window; odd.", low=3, high=101)
    max_sigma_px: float = parameter(
        0.15, "Uncertainty of the match, by its texture and residual, from which it is refused.", low=0.01, high=2.0
    )
    min_similarity: float = parameter(
        0.5, "Part of the window's own variation that the match must explain.", low=0.0, high=1.0
    )
    min_uniqueness: float = parameter(
        1.2, "By what factor the next best place on the line must correlate worse.", low=1.0, high=10.0
    )
    left_right_tolerance_px: float = parameter(
        1.0, "How far the match, looked for in the left view, may come out from where it started.", low=0.05, high=10.0
    )

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.window_px % 2 == 0:
            raise ParameterError(f"window_px = {self.window_px} must be odd")

    def match(self, pair: RectifiedPair, blobs: Blobs) -> Correspondences:
        """Return left centroids and where their surroundings appear in the right view, left to right."""
        left, right = blobs.sound()
        images = pair.left.astype(np.float32), pair.right.astype(np.float32)
        disparities_px = self.disparities_px(pair.rig)
        matches: list[Match] = []
        refused = left_over(blobs, [*left, *right], Feature().similarity(pair.rig))
        for blob in left:
            if self.search == "full":
                matches.append(_match(blob, _full_search(*images, blob.centroid_px), _FULL_WINDOW_PX))
                continue
            found = self._find(images, blob, left, right, disparities_px)
            if isinstance(found, Refusal):
                refused.append(found)
            else:
                matches.append(_match(blob, np.array([found.column_px, blob.centroid_px[1]]), found.sigma_px))
        matches, doubled = _without_doubles(matches, self.window_px if self.search == "epipolar" else 0)
        return collect(matches, [*refused, *doubled])

    def _find(
        self,
        images: tuple[Grey, Grey],
        blob: Blob,
        left: list[Blob],
        right: list[Blob],
        disparities_px: tuple[float, float],
    ) -> WindowFit | Refusal:
        """The window's place on the epipolar line of a left centroid, or why there is none."""
        here = blob.centroid_px
        least, most = disparities_px
        columns = _region_of_interest(right, float(here[1]), images[1].shape[1], (here[0] - most, here[0] - least))
        if not columns.any():
            return Refusal("left_only", here, None)
        cost = ssd_along_row(images[0], images[1], here, self.window_px)
        best = int(np.where(columns, cost, np.inf).argmin())
        fit = refine(images[0], images[1], here, float(best), self.window_px)
        if fit.sigma_px > self.max_sigma_px:
            return Refusal("no_texture", here, None, f"sigma {fit.sigma_px:.2f} px")
        if fit.similarity < self.min_similarity:
            return Refusal("poor_match", here, None, f"similarity {fit.similarity:.2f}")
        if not here[0] - most <= fit.column_px <= here[0] - least:
            return Refusal("left_only", here, None, "fits beyond the depth range")
        if _next_best(cost, columns, best, self.window_px) <= self.min_uniqueness * cost[best]:
            return Refusal("ambiguous", here, None)
        returned_px = self._return(images, here, fit.column_px, left)
        if abs(returned_px - here[0]) > self.left_right_tolerance_px:
            return Refusal("poor_match", here, None, f"leads back {returned_px - here[0]:+.1f} px beside its start")
        return fit

    def _return(self, images: tuple[Grey, Grey], here: Floats, column_px: float, left: list[Blob]) -> float:
        """Left column to which the right view's window at `column_px` leads back."""
        there = np.array([column_px, here[1]])
        columns = _region_of_interest(left, float(here[1]), images[0].shape[1], (-np.inf, np.inf))
        cost = ssd_along_row(images[1], images[0], there, self.window_px)
        best = float(np.where(columns, cost, np.inf).argmin())
        return refine(images[1], images[0], there, best, self.window_px).column_px


def _region_of_interest(blobs: list[Blob], row_px: float, width_px: int, limits_px: tuple[float, float]) -> Bools:
    """Mask (W,) of the columns that hold an object on this row: the automatic region of interest (3.7.1)."""
    columns = np.zeros(width_px, np.bool_)
    for blob in blobs:
        if blob.rows_px[0] <= row_px <= blob.rows_px[1]:
            first, last = blob.contour_px[:, 0].min(), blob.contour_px[:, 0].max()
            columns[max(0, int(first)) : int(last) + 1] = True
    u = np.arange(width_px)
    return columns & (u >= limits_px[0]) & (u <= limits_px[1])


def _next_best(cost: Floats, columns: Bools, best: int, window_px: int) -> float:
    """Least cost on the line, further than half a window from the best place."""
    elsewhere = columns & (np.abs(np.arange(len(cost)) - best) > window_px // 2)
    return float(np.where(elsewhere, cost, np.inf).min())


def _full_search(left: Grey, right: Grey, here_px: Floats) -> Floats:
    """The thesis's unmodified search (3.5, eq. 3.8): least SSD of a 3 x 3 window over all pixels of the right image."""
    window: NDArray[np.float32] = window_at(left, np.round(here_px), _FULL_WINDOW_PX)
    cost = cv2.matchTemplate(right, window, cv2.TM_SQDIFF)
    _, _, (column, row), _ = cv2.minMaxLoc(cost)
    return np.array([column, row], np.float64) + _FULL_WINDOW_PX // 2


def _match(blob: Blob, right_px: Floats, sigma_px: float) -> Match:
    length, width, direction = blob.rectangle
    right_sigma_px = float(np.hypot(sigma_px, _MODEL_SIGMA_PX))
    return Match(blob.centroid_px, right_px, (_MODEL_SIGMA_PX, right_sigma_px), (length, width), direction)


def _without_doubles(matches: list[Match], within_px: int) -> tuple[list[Match], list[Refusal]]:
    """Take out matches that lead several left objects to the same place in the right view."""

    def doubled(match: Match) -> bool:
        return any(
            other is not match and float(np.abs(other.right_px - match.right_px).max()) < within_px / 2
            for other in matches
        )

    refused = [Refusal("ambiguous", match.left_px, match.right_px) for match in matches if doubled(match)]
    return [match for match in matches if not doubled(match)], refused
