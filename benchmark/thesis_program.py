"""The thesis's two methods as a program of their own, written for speed: what their steps cost, not what they find.

Each step of 3.7.2 works on the whole image, as the thesis describes it; `by_contours` takes the way round that finds
the same objects without labelling every pixel.
"""

from __future__ import annotations

from collections.abc import Callable

import cv2
import numpy as np
from numpy.typing import NDArray

from stereo_pick.core.arrays import Floats, Image
from stereo_pick.core.frames import RectifiedPair
from stereo_pick.core.rays import closest_points

MIN_AREA_PX = 60
_DISC = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (5, 5))
_HALF_PX = 1

Objects = tuple[Floats, Floats]
"""Areas (N,) [px²] and centroids (N, 2) [px]."""


def by_labels(grey: Image) -> Objects:
    """Threshold, regions below 60 pixels out, closed, holes filled; the 8-connected objects that are left (3.7.2)."""
    _, mask = cv2.threshold(grey, 0, 1, cv2.THRESH_BINARY + cv2.THRESH_OTSU)
    _, labels, stats, _ = cv2.connectedComponentsWithStats(mask, connectivity=8)
    keep = (stats[:, cv2.CC_STAT_AREA] >= MIN_AREA_PX).astype(np.uint8)
    keep[0] = 0
    closed = cv2.morphologyEx(keep[labels], cv2.MORPH_CLOSE, _DISC)
    _, _, stats, centroids = cv2.connectedComponentsWithStats(_filled(closed), connectivity=8)
    return stats[1:, cv2.CC_STAT_AREA].astype(np.float64), centroids[1:]


def by_contours(grey: Image) -> Objects:
    """The same from the outer contours alone: a hole is filled by not being looked at."""
    _, mask = cv2.threshold(grey, 0, 1, cv2.THRESH_BINARY + cv2.THRESH_OTSU)
    closed = cv2.morphologyEx(mask, cv2.MORPH_CLOSE, _DISC)
    contours, _ = cv2.findContours(closed, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
    moments = [cv2.moments(contour) for contour in contours]
    kept = [m for m in moments if m["m00"] >= MIN_AREA_PX]
    areas = np.array([m["m00"] for m in kept])
    return areas, np.array([(m["m10"], m["m01"]) for m in kept]).reshape(-1, 2) / np.maximum(areas, 1)[:, None]


def feature(find: Callable[[Image], Objects], pair: RectifiedPair) -> Floats:
    """Positions (N, 3) of the objects paired by the least difference of area (eq. 3.11), triangulated (3.9)."""
    (left_areas, left_px), (right_areas, right_px) = find(pair.left), find(pair.right)
    if not len(left_areas) or not len(right_areas):
        return np.zeros((0, 3))
    partner = np.abs(left_areas[:, None] - right_areas).argmin(axis=1)
    return _positions(pair, left_px, right_px[partner])


def modified_ssd(find: Callable[[Image], Objects], pair: RectifiedPair) -> Floats:
    """Positions (N, 3) of the left centroids, found again along their rows by the least SSD of 3 x 3 (3.6, 3.7)."""
    left_px = find(pair.left)[1]
    return _positions(pair, left_px, np.array([_along_row(pair, here) for here in left_px]).reshape(-1, 2))


def _along_row(pair: RectifiedPair, here_px: Floats) -> Floats:
    height, width = pair.left.shape
    column, row = np.clip(np.round(here_px).astype(int), _HALF_PX, np.array([width, height]) - 1 - _HALF_PX)
    rows = np.s_[row - _HALF_PX : row + _HALF_PX + 1]
    window = pair.left[rows, column - _HALF_PX : column + _HALF_PX + 1]
    misfit = cv2.matchTemplate(pair.right[rows], window, cv2.TM_SQDIFF)
    return np.array([int(misfit.argmin()) + _HALF_PX, row], np.float64)


def _positions(pair: RectifiedPair, left_px: Floats, right_px: Floats) -> Floats:
    left, right, right_T_left = pair.rig.left, pair.rig.right, pair.rig.right_T_left
    return closest_points(left.rays(left_px), right.rays(right_px), right_T_left)[0]


def _filled(mask: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """What cannot be reached from the border is object."""
    flooded = cv2.copyMakeBorder(mask, 1, 1, 1, 1, cv2.BORDER_CONSTANT, value=[0])
    cv2.floodFill(flooded, None, (0, 0), [2])
    return np.asarray(cv2.compare(flooded[1:-1, 1:-1], 2, cv2.CMP_NE), np.uint8)
