"""Shadows cut off dark objects: an object is darker than its shadow and ends at once, a shadow fades at its rim.

A lamp has a size, so the rim of a shadow is as wide as the lamp looks from there: wider than the blur of the lens,
which is that of the edges of all objects in the view.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

import cv2
import numpy as np
from numpy.typing import NDArray

from stereo_pick.core.arrays import Bools, Floats, Image, Ints
from stereo_pick.core.objects.blob import SHARP, Blob
from stereo_pick.core.objects.focus import lens_blur_px, local_blur_px, normals
from stereo_pick.core.objects.foreground import Contrast
from stereo_pick.core.objects.outline import parts

_MAY_BE_SHADED = 0.05  # part of an outline that may run along a shadow before it is cut off
_WIDER = 1.3  # than the blur of the lens
_LIGHTER = 0.75  # part of an object's contrast that a shadow has at most, ...
_WHERE_THEY_TOUCH = 0.9  # ... and where it meets the object
_DARKEST = 0.9  # part of an object's pixels that may be lighter than the object itself
_STEP = 0.25  # part of an object's contrast, of an edge of it
_INSIDE_PX = 3.5  # from an edge to where the level inside is seen
_LEVELS = (0.4, 0.5, 0.6, 0.7, 0.8, 0.88)  # parts of an object's contrast above which a shadow may end
_OUTER = 0.4  # part of a shadow's rim, at least, that does not lie on the object
_MUST_GAIN = 0.02
_BESIDE_PX = 2
_SHADED = 0.1  # sharpness of what is no edge of an object

_SQUARE = np.ones((3, 3), np.uint8)

Option = tuple[int, list[Blob]]
"""The number of a blob, and pieces that may be left of it without its shadow."""

Refine = Callable[[list[Blob]], list[Blob]]


@dataclass(frozen=True, eq=False)
class Shadows:
    """What is known of the shadows of a view: its contrast, and the blur of its lens [px, one sigma]."""

    contrast: Contrast
    lens_blur_px: float

    @staticmethod
    def of(blobs: Sequence[Blob], contrast: Contrast) -> Shadows:
        """To be asked about dark blobs, with refined outlines."""
        return Shadows(contrast, lens_blur_px([blob.contour_px for blob in blobs], contrast.view.image))

    def cut_off(self, blobs: Sequence[Blob], refine: Refine, min_area_px: int) -> list[Blob]:
        """What is left of blobs without their shadows; where a shadow stays, its rim is no edge.

        The level is taken above which most of the outline is clear of shadows, the lowest of equal ones.
        """
        darkness = [self._darkness(blob) for blob in blobs]
        shaded = self._shaded(blobs, darkness, _LIGHTER)
        doubtful = [i for i, blob in enumerate(blobs) if shaded[i].mean() > _MAY_BE_SHADED]
        options = [
            (i, pieces) for i in doubtful for pieces in self._options(blobs[i], darkness[i], shaded[i], min_area_px)
        ]
        refined = iter(refine([piece for _, pieces in options for piece in pieces]))
        options = [(i, [blobs[i]]) for i in doubtful] + [(i, [next(refined) for _ in pieces]) for i, pieces in options]
        best = self._best(options, darkness)
        left = [(piece, darkness[i]) for i, blob in enumerate(blobs) for piece in best.get(i, [blob])]
        return [
            replace(blob, sharpness=np.where(soft, np.minimum(blob.sharpness, _SHADED), blob.sharpness))
            for (blob, _), soft in zip(left, self._shaded(*_columns(left), _LIGHTER))
        ]

    def _best(self, options: Sequence[Option], darkness: Sequence[float]) -> dict[int, list[Blob]]:
        """For each blob the pieces with the longest outline off shadows, and off where they meet the object, less half
        of the outline along them; as parts of the first option's length."""
        every = [(piece, darkness[i]) for i, pieces in options for piece in pieces]
        shaded = iter(self._shaded(*_columns(every), _WHERE_THEY_TOUCH))
        best: dict[int, list[Blob]] = {}
        most: dict[int, float] = {}
        length: dict[int, int] = {}
        for i, pieces in options:
            along = np.concatenate([next(shaded) for _ in pieces])
            clear = float((~along).sum() - along.sum() / 2) / length.setdefault(i, len(along))
            if clear > most.get(i, -np.inf) + _MUST_GAIN:
                best[i], most[i] = pieces, clear
        return best

    def _shaded(self, blobs: Sequence[Blob], darkness: Sequence[float], lighter: float) -> list[Bools]:
        """Which points (N,) of each outline run along the rim of a shadow: soft, and lighter inside than the object."""
        if not blobs:
            return []
        contours = [blob.contour_px for blob in blobs]
        blur_px, step = local_blur_px(contours, self.contrast.view.image)
        least = np.repeat(darkness, [len(contour) for contour in contours])
        soft = (blur_px > _WIDER * self.lens_blur_px) | (step < _STEP * least)
        soft |= np.concatenate([blob.sharpness for blob in blobs]) < SHARP
        light = self._excess_inside(contours) < lighter * least
        shaded = (soft | self._at_border(contours)) & light
        return np.split(shaded, np.cumsum([len(contour) for contour in contours])[:-1])

    def _at_border(self, contours_px: Sequence[Floats]) -> Bools:
        """Which points (N,) of outlines are at the border of the view, where a shadow ends as sharply as an object."""
        view = self.contrast.view
        return np.asarray(~view.core[view.nearest(np.concatenate(contours_px))])

    def _excess_inside(self, contours_px: Sequence[Floats]) -> Floats:
        """By how much (N,) the view is darker than its background just inside of outlines [grey levels]."""
        view = self.contrast.view
        turns = [np.sign(cv2.contourArea(contour.astype(np.float32), oriented=True)) for contour in contours_px]
        inward = np.repeat(turns, [len(contour) for contour in contours_px])[:, None] * normals(contours_px)
        rows, columns = view.nearest(np.concatenate(contours_px) + _INSIDE_PX * inward)
        low, high = (rows.min(), columns.min()), (rows.max() + 1, columns.max() + 1)
        excess = self.contrast.excess("dark", np.s_[low[0] : high[0], low[1] : high[1]])
        return np.asarray(excess[rows - low[0], columns - low[1]], np.float64)

    def _darkness(self, blob: Blob) -> float:
        """Grey levels by which the object in a blob is darker than its background."""
        _, member, excess = self._window(blob)
        inside = excess[member.view(np.bool_)]
        return float(np.quantile(inside, _DARKEST)) if inside.size else 0.0

    def _options(self, blob: Blob, darkness: float, shaded: Bools, min_area_px: int) -> Iterator[list[Blob]]:
        """The pieces of a blob that are darker than its background by each of some levels, with those light places in
        them that do not lie at the rim of a shadow: high lights, and lighter faces."""
        view = self.contrast.view
        corner, member, excess = self._window(blob)
        at = np.round((blob.contour_px + 0.5) / view.reduction - 0.5 - corner).astype(np.int64)
        before = member
        for level in _LEVELS:
            light = member & (excess <= level * darkness)
            kept = _without(member, light, at, shaded, view.reduction)
            if (kept == before).all():
                continue
            before = kept
            pieces = list(parts(view, kept, excess, corner, min_area_px))
            if pieces:
                yield pieces

    def _window(self, blob: Blob) -> tuple[tuple[int, int], Image, NDArray[np.float32]]:
        """The upper left corner (column, row) in the reduced view, the mask and the excess of a blob."""
        view = self.contrast.view
        contour = np.round((blob.contour_px + 0.5) / view.reduction - 0.5).astype(np.int32)
        x, y, width, height = cv2.boundingRect(contour)
        x, y = max(x, 0), max(y, 0)
        excess = self.contrast.excess("dark", np.s_[y : y + height, x : x + width])
        member = np.zeros(excess.shape, np.uint8)
        cv2.drawContours(member, [contour], -1, 1, cv2.FILLED, offset=(-x, -y))
        return (x, y), member, excess


def _without(member: Image, light: Image, outline_px: Ints, shaded: Bools, reduction: int) -> Image:
    """A mask less those light places in it along which most of its outline (N, 2), (column, row), is shaded."""
    wide = cv2.morphologyEx(light, cv2.MORPH_OPEN, _SQUARE)  # not the blurred rim of the object itself
    count, label = cv2.connectedComponents(wide, connectivity=4)
    near = _largest_around(np.asarray(label, np.int32), outline_px)
    soft, sharp = np.bincount(near[shaded], minlength=count), np.bincount(near[~shaded], minlength=count)
    rim = label * (wide - cv2.erode(wide, _SQUARE))
    shadow = (soft > sharp) & (soft + sharp > _OUTER * reduction * np.bincount(rim.reshape(-1), minlength=count))
    shadow[0] = False
    cast = np.asarray(cv2.dilate(shadow[label].astype(np.uint8), _SQUARE))
    return np.where((cast > 0) & (light > 0), np.uint8(0), member)


def _largest_around(label: NDArray[np.int32], at: Ints) -> Ints:
    """The greatest label (N,) in a small window around points (N, 2) of an image (column, row)."""
    size = 2 * _BESIDE_PX + 1
    grown = cv2.dilate(label.astype(np.float32), np.ones((size, size), np.uint8))
    columns, rows = np.clip(at, 0, np.array(label.shape[::-1]) - 1).T
    return np.asarray(grown[rows, columns], np.int64)


def _columns(pieces: Sequence[tuple[Blob, float]]) -> tuple[list[Blob], list[float]]:
    return [blob for blob, _ in pieces], [darkness for _, darkness in pieces]
