"""Several closed contours in one array, end to end: what is done to one is done to all at once."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from stereo_pick.core.arrays import Floats, Ints

_SMOOTHING_PX = 2.0
_REACH = int(3 * _SMOOTHING_PX)
_MIN_POINTS = 16


@dataclass(frozen=True, eq=False)
class Rings:
    """points_px: (N, 2), the points of all contours; first: (C,), the index of each contour's first point;
    wrapped: (N + 2 C reach,), the indices of the points of each contour with its end before it and its beginning
    behind it; own: (N,), where in those each point stands."""

    points_px: Floats
    first: Ints
    wrapped: Ints
    own: Ints

    @staticmethod
    def of(contours_px: Sequence[Floats]) -> Rings:
        """These contours, with a point each pixel of their length, without the steps of their pixels."""
        points, counts = _even(contours_px)
        first = np.cumsum(counts) - counts
        ring = np.repeat(np.arange(len(counts)), counts + 2 * _REACH)
        place = np.arange(len(ring)) - (first + 2 * _REACH * np.arange(len(counts)))[ring] - _REACH
        inner = (place >= 0) & (place < counts[ring])
        wrapped = np.asarray(first[ring] + place % counts[ring], np.int64)
        rings = Rings(points, np.asarray(first, np.int64), wrapped, np.flatnonzero(inner))
        return rings.at(rings.smoothed(points))

    def at(self, points_px: Floats) -> Rings:
        """The same contours with other points (N, 2)."""
        return Rings(points_px, self.first, self.wrapped, self.own)

    def split(self, values: NDArray[np.float64]) -> list[Floats]:
        """Values (N, ...) contour by contour."""
        return np.split(values, self.first[1:])

    def numbers(self) -> Ints:
        """The number (N,) of each point's contour."""
        return np.repeat(np.arange(len(self.first)), np.diff(self.first, append=len(self.points_px)))

    def smoothed(self, values: Floats) -> Floats:
        """Values (N, M) along the contours, each averaged with its neighbours."""
        smooth = cv2.filter2D(values[self.wrapped], cv2.CV_64F, _KERNEL, borderType=cv2.BORDER_REPLICATE)
        return np.asarray(smooth[self.own])

    def inward_normals(self) -> Floats:
        """Unit normals (N, 2) that point inwards."""
        smooth = self.smoothed(self.points_px)[self.wrapped]
        x, y = (smooth[self.own + 2] - smooth[self.own - 2]).T
        normal = np.stack([-y, x], axis=1)
        normal *= (np.sign(self._signed_areas()) / (np.hypot(x, y) + 1e-9))[:, None]
        return normal

    def _signed_areas(self) -> Floats:
        """Twice the area (N,) [px²] of each point's contour, positive where inside is to the left of its way."""
        x, y = self.points_px.T
        x_next, y_next = self.points_px[self.wrapped[self.own + 1]].T
        areas = np.add.reduceat(x * y_next - y * x_next, self.first)
        return np.asarray(areas[self.numbers()])


def _even(contours_px: Sequence[Floats]) -> tuple[Floats, Ints]:
    """Points at even distances along all contours (N, 2), and how many there are on each (C,)."""
    closed = np.concatenate([corner for contour in contours_px for corner in (contour, contour[:1])])
    ends = np.cumsum([len(contour) + 1 for contour in contours_px])
    step = np.diff(closed, axis=0, prepend=closed[:1])
    along = np.cumsum(np.hypot(step[:, 0], step[:, 1]))
    begin, end = along[np.r_[0, ends[:-1]]], along[ends - 1]
    counts = np.maximum((end - begin).astype(np.int64), _MIN_POINTS)
    ring = np.repeat(np.arange(len(counts)), counts)
    part = (np.arange(len(ring)) - (np.cumsum(counts) - counts)[ring]) / counts[ring]
    at = begin[ring] + part * (end - begin)[ring]
    return np.stack([np.interp(at, along, closed[:, axis]) for axis in (0, 1)], axis=1), counts


def _kernel() -> Floats:
    weight = np.exp(-0.5 * (np.arange(-_REACH, _REACH + 1) / _SMOOTHING_PX) ** 2)
    return np.asarray((weight / weight.sum())[:, None])


_KERNEL = _kernel()
