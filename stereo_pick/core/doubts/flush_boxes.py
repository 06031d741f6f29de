"""Two boxes that are hardly two: pieces of one part, as the flanges of an angle bracket, or the arms of a T.

Parts that only touch do so at any angle, or have sides that are not flush. Equal ones may well stand in a row. Of such
pieces the one is often found too short, where the other hides it.
"""

from __future__ import annotations

import numpy as np

from stereo_pick.core.arrays import Floats
from stereo_pick.core.shapes.kinds import BOX
from stereo_pick.core.shapes.solid_fit import SolidFit

_FLUSH = 0.02  # of the largest size, by which what is flush may be off
_EQUAL = 0.1  # of the larger of two, by which the sizes of equal boxes may differ
_MISSING = 1 / 2  # of the largest size, that may be hidden between two, or in the shadow
_BOTH_STAND = 1  # pair of faces that is flush where both stand on a table


def are_flush(one: SolidFit, other: SolidFit, *, touch: bool, open_m: float = 0.0) -> bool:
    """Whether two boxes are next to each other, or reach into each other, with parallel faces, though of different
    sizes, and are flush in more than how they stand; touch: whether their outlines do, in both views; open_m: how far
    off either may be, of which no more counts than as much again: a sure one is not doubted for what is not."""
    if one.kind != BOX.name or other.kind != BOX.name:
        return False
    return any(_is_flush_to(*pair, touch, open_m) for pair in ((one, other), (other, one)))  # each is turned a little


def _is_flush_to(one: SolidFit, other: SolidFit, touch: bool, open_m: float) -> bool:
    """The same of two boxes by the faces of the first."""
    largest_m = float(max(one.size_m.max(), other.size_m.max()))
    flush_m = _FLUSH * largest_m + min(open_m, _FLUSH * largest_m)
    turn = np.abs(one.rotation.T @ other.rotation)
    order = turn.argmax(axis=1)
    # a face is off by that from the middle of the largest size to its end
    if turn.max(axis=1).min() < np.sqrt(max(0.0, 1 - (2 * flush_m / largest_m) ** 2)):
        return False
    sizes_m = np.array([one.size_m, other.size_m[order]])
    if (np.abs(sizes_m[0] - sizes_m[1]) < _EQUAL * sizes_m.max(axis=0)).all():
        return False
    ends_m = _ends_m(sizes_m, (other.centre_m - one.centre_m) @ one.rotation)
    gap_m, off_m = ends_m[:, 0].max(axis=0) - ends_m[:, 1].min(axis=0), np.abs(ends_m[0] - ends_m[1])
    beside = int(gap_m.argmax())
    flush = int((np.delete(off_m, beside, axis=1) < flush_m).sum())
    if flush <= _BOTH_STAND or gap_m[beside] > _MISSING * largest_m:
        return False
    return flush > _BOTH_STAND + 1 or touch or bool(gap_m[beside] < flush_m)


def moved_m(one: SolidFit, other: SolidFit) -> float:
    """How far the centre of both is from that of the first."""
    share = float(np.prod(other.size_m) / (np.prod(one.size_m) + np.prod(other.size_m)))
    return share * float(np.linalg.norm(other.centre_m - one.centre_m))


def _ends_m(sizes_m: Floats, apart_m: Floats) -> Floats:
    """Where two boxes (2, 3) begin and end (2, 2, 3) along the axes of the first."""
    middles_m = np.array([np.zeros(3), apart_m])
    return np.stack([middles_m - sizes_m / 2, middles_m + sizes_m / 2], axis=1)
