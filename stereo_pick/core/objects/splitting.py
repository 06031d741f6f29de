"""Touching parts taken apart by the shape of their common outline.

Only geometry cuts: along shading or a raised threshold a single part would fall to pieces as well.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import lru_cache

import cv2
import numpy as np
from numpy.typing import NDArray

from stereo_pick.core.arrays import Ints
from stereo_pick.core.objects.blob import CUT, Blob

_MIN_NOTCH = 0.25  # of the deepest one: shallower notches are not where a cut begins
_BEGINNINGS = 4
_ENDS = 60  # points of the outline at which a cut may end
_MIN_PART = 0.1  # of the area
_MUST_GAIN = 0.5  # part of the missing area (hull less outline) that a cut must explain
_CLEARLY_GAINS = 0.75  # ... and of a shallow notch, in a part of what is known to be several
_NEARLY_ALL = 0.65
_NOTICED = 0.012  # part of the area, beyond the noise of an outline
_MAX_PARTS = 6
_WORTHWHILE = 0.25  # ... and where the other view has a say
_MOST = 16  # divisions of one blob
_CLEARLY_ANOTHER = 0.04  # part of the outline
_CUT_COST = 0.02


def split(blob: Blob, max_concavity: float) -> list[Blob]:
    """The convex parts of a blob with notches, or the blob itself where cuts from notch to notch explain no notch.

    The points of a part's contour that lie on a cut are not on an edge of the object: their sharpness is CUT.
    """
    if blob.concavity <= max_concavity or not len(blob.sharpness):
        return [blob]
    parts: list[Blob] = [blob]
    whole: list[Blob] = []
    while parts and len(parts) + len(whole) <= _MAX_PARTS:
        part = parts.pop()
        halves = _best_cut(part, _MUST_GAIN if part.concavity > max_concavity else _CLEARLY_GAINS)
        if halves is not None and part.concavity > max_concavity / 2:
            parts += halves
        elif part.concavity <= max_concavity:
            whole.append(part)
        else:
            return [blob]
    return [blob] if parts else whole


@dataclass(frozen=True, eq=False)
class Division:
    """A blob cut in two; unexplained: the part of what its outline lacks of being convex that the cut leaves."""

    parts: tuple[Blob, Blob]
    unexplained: float


@lru_cache(maxsize=64)  # asked for twice: parts alike in both views, and those that are not
def divisions(blob: Blob) -> tuple[Division, ...]:
    """The cuts of a blob in two that explain most, best first, each clearly another one than those before it."""
    missing = _missing_area(_drawn(blob))
    if missing < _NOTICED * blob.area_px2 or not len(blob.sharpness):
        return ()
    count = len(blob.contour_px)
    found = [
        ((left + _CUT_COST * _cut_length(blob, begin, end) ** 2) / missing, begin, end)
        for begin, end, left in _halves(blob, (1 - _WORTHWHILE) * missing)
    ]
    kept: list[tuple[float, int, int]] = []
    for each in sorted(found):
        if each[0] > 1 - _WORTHWHILE or len(kept) == _MOST:
            break
        if all(_differ(each[1:], known[1:], count) > _CLEARLY_ANOTHER * count for known in kept):
            kept.append(each)
    return tuple(Division(_parts(blob, begin, end), left) for left, begin, end in kept)


def _differ(one: tuple[int, int], other: tuple[int, int], count: int) -> int:
    """How many points of the outline lie between the ends of two cuts, at the end where it is more."""

    def between(i: int, j: int) -> int:
        return min((i - j) % count, (j - i) % count)

    straight = max(between(one[0], other[0]), between(one[1], other[1]))
    return min(straight, max(between(one[0], other[1]), between(one[1], other[0])))


def may_be_two(blob: Blob) -> bool:
    """Whether one cut would explain nearly all that the outline lacks of being convex, as between two parts of which
    one stands behind the other; the open end of a tube is in no way explained by a cut."""
    missing = _missing_area(_drawn(blob))
    if missing < _NOTICED * blob.area_px2:
        return False
    return any(True for _ in _halves(blob, (1 - _NEARLY_ALL) * missing))


def _best_cut(blob: Blob, must_gain: float) -> tuple[Blob, Blob] | None:
    """The two parts of least missing area, if that is clearly less than the missing area of the whole."""
    missing = _missing_area(_drawn(blob))
    best, least = None, (1 - must_gain) * missing
    for begin, end, left in _halves(blob, least):
        cost = left + _cut_length(blob, begin, end) ** 2 * _CUT_COST
        if cost < least:
            best, least = (begin, end), cost
    if best is None:
        return None
    return _parts(blob, *best)


def _halves(blob: Blob, less_px2: float) -> Iterator[tuple[int, int, float]]:
    """The ends of each cut that leaves no sliver, and the missing area of both halves together, if less than this."""
    count, drawn = len(blob.contour_px), _drawn(blob)
    twice = np.concatenate([drawn, drawn])  # every arc in one piece
    for begin, end in _cuts(blob):
        first, last = min(begin, end), max(begin, end)
        halves = twice[first : last + 1], twice[last : first + count + 1]
        one, other = (cv2.contourArea(half) for half in halves)
        if min(one, other) < _MIN_PART * blob.area_px2:
            continue
        left = _hull_area(halves[0]) - one
        if left < less_px2 and (left := left + (_hull_area(halves[1]) - other)) < less_px2:
            yield begin, end, left


def _cuts(blob: Blob) -> Iterator[tuple[int, int]]:
    """From each of the deepest notches to points all around the outline, other notches among them."""
    outline = np.round(blob.contour_px * 16).astype(np.int32)
    hull = cv2.convexHull(outline, returnPoints=False)
    hull[::-1].sort(axis=0)
    defects = cv2.convexityDefects(outline, hull)
    if defects is None:
        return
    deepest = defects[:, 0][np.argsort(-defects[:, 0, 3])][:_BEGINNINGS]
    notches = [int(point) for _, _, point, depth in deepest if depth >= _MIN_NOTCH * deepest[0, 3]]
    count = len(outline)
    around = np.unique(np.linspace(0, count, _ENDS, endpoint=False).astype(int))
    for k, begin in enumerate(notches):
        for end in [*notches[k + 1 :], *(int(i) for i in around)]:
            if min((begin - end) % count, (end - begin) % count) >= 3:
                yield begin, end


def _parts(blob: Blob, begin: int, end: int) -> tuple[Blob, Blob]:
    count = len(blob.contour_px)
    return _part(blob, _arc(begin, end, count)), _part(blob, _arc(end, begin, count))


def _part(blob: Blob, arc: Ints) -> Blob:
    """The part inside an arc of the contour and the cut between its ends."""
    contour, sharpness = blob.contour_px[arc], blob.sharpness[arc]
    gap = contour[0] - contour[-1]
    steps = max(int(np.linalg.norm(gap)), 1)
    cut = contour[-1] + np.arange(1, steps)[:, None] / steps * gap
    return replace(blob, contour_px=np.concatenate([contour, cut]), sharpness=np.r_[sharpness, np.full(len(cut), CUT)])


def _arc(first: int, last: int, count: int) -> Ints:
    return np.arange(first, last + 1 if last > first else last + count + 1) % count


def _cut_length(blob: Blob, begin: int, end: int) -> float:
    return float(np.linalg.norm(blob.contour_px[begin] - blob.contour_px[end]))


def _drawn(blob: Blob) -> NDArray[np.float32]:
    """The contour (N, 2) [px] as OpenCV takes it."""
    return blob.contour_px.astype(np.float32)


def _missing_area(contour_px: NDArray[np.float32]) -> float:
    """What the convex hull has more than the contour [px²]."""
    return _hull_area(contour_px) - cv2.contourArea(contour_px)


def _hull_area(contour_px: NDArray[np.float32]) -> float:
    return cv2.contourArea(cv2.convexHull(contour_px))
