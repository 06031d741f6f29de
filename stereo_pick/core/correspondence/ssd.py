"""Method `ssd`: the thesis's modified SSD (3.6 and 3.7): the centroids of the left view, found again by correlation."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from stereo_pick.core.arrays import Bools, Floats
from stereo_pick.core.correspondence.correspondences import Correspondences, Match, collect
from stereo_pick.core.correspondence.feature import Feature
from stereo_pick.core.correspondence.method import Method
from stereo_pick.core.frames import RectifiedPair
from stereo_pick.core.matches.left_over import left_over
from stereo_pick.core.noise import noise_dn
from stereo_pick.core.objects import Blob, Blobs
from stereo_pick.core.params import parameter
from stereo_pick.core.refusal import Refusal
from stereo_pick.core.windows.matching import Evidence, WindowMatching
from stereo_pick.core.windows.refinement import refine
from stereo_pick.core.windows.texture import predicted_sigma_at
from stereo_pick.core.windows.window import Grey, factor, misfit_along_row, window_at

_MODEL_SIGMA_PX = 0.6  # in each view: a window seen from two sides is not the same picture; see docs/accuracy.md
_FULL_WINDOW_PX = 3
_ONE_PLACE_PX = 3  # noise makes more than one minimum of a broad one


@dataclass(frozen=True)
class Ssd(Method, WindowMatching):
    """Correlates the window around each left centroid along its epipolar line; finds a point of the surface.

    Needs texture: on a plain part there is nothing to correlate, and the part is refused. Windows stay within the
    outline as far as they can: behind the edge lies another depth, and that of a round part is no fixed line on it.
    """

    search: str = parameter(
        "epipolar",
        "Where the window is looked for: along the epipolar line within the region of interest, checked and to a part "
        "of a pixel; or, as in the thesis's unmodified method, SSD of 3 x 3 over the whole right image, taken as it "
        "comes.",
        choices=("epipolar", "full"),
    )

    def match(self, pair: RectifiedPair, blobs: Blobs) -> Correspondences:
        """Return left centroids and where their surroundings appear in the right view, left to right."""
        left, right = blobs.sound()
        images = pair.left.astype(np.float32), pair.right.astype(np.float32)
        line = _Line(images, noise_dn(images[0]), left, right, self.disparities_px(pair.rig))
        matches: list[Match] = []
        refused = [each.refusal for each in left_over(blobs, [*left, *right], Feature().similarity(pair.rig))]
        for blob in left:
            if self.search == "full":
                matches.append(_match(blob, _full_search(*images, blob.centroid_px), _FULL_WINDOW_PX))
                continue
            found = self._find(line, blob)
            if isinstance(found, Refusal):
                refused.append(found)
            else:
                matches.append(_match(blob, *found))
        matches, doubled = _without_doubles(matches, self.narrowest_window_px if self.search == "epipolar" else 0)
        return collect(matches, [*refused, *doubled])

    def _find(self, line: _Line, blob: Blob) -> tuple[Floats, float] | Refusal:
        """Right point (2,) of a left centroid and its sigma [px], or why there is none.

        Tried with the narrowest window that the texture allows, and with wider ones until one is believed.
        """
        here = blob.centroid_px
        columns = line.columns(here)
        if not columns.any():
            return Refusal("left_only", here, None)
        sizes, narrowest_px = _within_outline(blob, self.sizes_px()), self.narrowest_window_px
        if not sizes:
            return Refusal("no_texture", here, None, f"the narrowest window, {narrowest_px} px, is wider than it")
        refusal = Refusal("no_texture", here, None)
        for window_px in sizes:
            predicted_px = predicted_sigma_at(line.images[0], here, line.noise_dn, window_px, self.cost)
            if predicted_px > self.enough_px(last=window_px == sizes[-1]):
                continue
            column_px, evidence = line.look(here, columns, window_px, self)
            reason = str(self.judge(evidence)[0])
            if not reason:
                return np.array([column_px, here[1]]), float(evidence.sigma_px[0])
            refusal = Refusal(reason, here, None, self.detail(reason, evidence))
        return refusal


@dataclass(frozen=True, eq=False)
class _Line:
    """Where the objects of both views are, for looking along a row; disparities_px: the least and the greatest."""

    images: tuple[Grey, Grey]
    noise_dn: float
    left: list[Blob]
    right: list[Blob]
    disparities_px: tuple[float, float]

    def columns(self, here_px: Floats) -> Bools:
        """Mask (W,) of the right view's columns in which a left point (2,) may be found."""
        least, most = self.disparities_px
        limits_px = float(here_px[0]) - most, float(here_px[0]) - least
        return _region_of_interest(self.right, float(here_px[1]), self.images[1].shape[1], limits_px)

    def look(self, here_px: Floats, columns: Bools, window_px: int, matching: WindowMatching) -> tuple[float, Evidence]:
        """Column of the right view that fits a left point (2,) best, and what speaks for it."""
        cost = matching.cost
        along = misfit_along_row(*self.images, here_px, window_px, cost)
        best = int(np.where(columns, along, np.inf).argmin())
        elsewhere = columns & (np.abs(np.arange(len(along)) - best) > window_px // 2)
        next_best = float(np.where(elsewhere, along, np.inf).min())
        if matching.min_uniqueness > 1 and self._repeats(here_px, along, best, window_px, matching):
            next_best = along[best]
        fit = refine(self.images, here_px[None], np.array([float(best)]), window_px, cost)
        column_px = float(fit.column_px[0])
        least, most = self.disparities_px
        evidence = Evidence(
            sigma_px=fit.sigma_px,
            similarity=fit.similarity,
            within=np.array([least <= here_px[0] - column_px <= most]),
            uniqueness=np.array([factor(next_best, along[best])]),
            return_px=np.array([self._back(np.array([column_px, here_px[1]]), window_px, cost) - here_px[0]]),
        )
        return column_px, evidence

    def _repeats(self, here_px: Floats, along: Floats, best: int, window_px: int, matching: WindowMatching) -> bool:
        """Whether the misfits (W,) along a row have another minimum that would be believed, too: at the next period of
        a print, however much better the best one fits; that may be it, where an outline is refused at the right one."""
        column = np.arange(len(along))
        least, most = self.disparities_px
        elsewhere = (
            (np.abs(column - best) > _ONE_PLACE_PX) & (column >= here_px[0] - most) & (column <= here_px[0] - least)
        )
        variance = float(window_at(self.images[0], here_px, window_px).var())
        is_alike = along <= (1 - matching.min_similarity) * variance
        return bool((elsewhere & is_alike & _is_least(along)).any())

    def _back(self, there_px: Floats, window_px: int, cost: str) -> float:
        """Left column to which a point (2,) of the right view leads back."""
        views = self.images[1], self.images[0]
        columns = _region_of_interest(self.left, float(there_px[1]), views[1].shape[1], (-np.inf, np.inf))
        along = misfit_along_row(*views, there_px, window_px, cost)
        best = float(np.where(columns, along, np.inf).argmin())
        return float(refine(views, there_px[None], np.array([best]), window_px, cost).column_px[0])


def _within_outline(blob: Blob, sizes_px: list[int]) -> list[int]:
    """The windows around the centroid that show nothing but the object; else the narrowest, if its corners alone show
    more; what is behind an object has a depth of its own, and texture, perhaps."""
    centre = float(blob.centroid_px[0]), float(blob.centroid_px[1])
    reach_px = cv2.pointPolygonTest(blob.contour_px.astype(np.float32), centre, True)
    within = [size for size in sizes_px if size <= np.sqrt(2) * reach_px]
    return within or [size for size in sizes_px[:1] if size <= 2 * reach_px]


def _is_least(along: Floats) -> Bools:
    """Where values (W,) are no greater than both of their neighbours."""
    wide = np.pad(along, 1, constant_values=np.inf)
    return np.asarray((along <= wide[:-2]) & (along <= wide[2:]))


def _region_of_interest(blobs: list[Blob], row_px: float, width_px: int, limits_px: tuple[float, float]) -> Bools:
    """Mask (W,) of the columns that hold an object on this row: the automatic region of interest (3.7.1)."""
    columns = np.zeros(width_px, np.bool_)
    for blob in blobs:
        if blob.rows_px[0] <= row_px <= blob.rows_px[1]:
            first, last = blob.contour_px[:, 0].min(), blob.contour_px[:, 0].max()
            columns[max(0, int(first)) : int(last) + 1] = True
    u = np.arange(width_px)
    return columns & (u >= limits_px[0]) & (u <= limits_px[1])


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
