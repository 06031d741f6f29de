"""Whether the images fit the calibration at all, before single objects are believed.

On cameras that look towards each other, exchanged images can give depths that look quite possible, and so can single
chance matches under a wrong calibration. What gives both away is how many of the objects fit between the views.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from stereo_pick.core.arrays import Floats
from stereo_pick.core.camera import Camera
from stereo_pick.core.correspondence.feature import Feature
from stereo_pick.core.matches.assignment import assign
from stereo_pick.core.objects import Blob, Blobs
from stereo_pick.core.rig import StereoRig

Sides = tuple[list[Blob], list[Blob]]
"""Outlines in the left and in the right view."""

_CONVINCING_COST = 0.1  # on the scale of `Similarity.costs`, where 1 is barely possible
_CLEARLY_WORSE = 4.0
_SAME_PART = 3.0  # factor of the areas of one part where a view shows only half of it, or its shadow or neighbour too
_MAY_BE_ITS_TOP = 5.0  # ... where it shows the top of a tall one alone
_SEVERAL = 3


def rig_fault(blobs: Blobs, rig: StereoRig) -> str:
    """Why no object of this pair may be believed: `swapped`, `misaligned`, or nothing.

    swapped: the objects fit only, or clearly better, when left and right change places. misaligned: see
    `_is_misaligned`.
    """
    if _is_swapped(*blobs.sound(), rig):
        return "swapped"
    return "misaligned" if _is_misaligned(blobs, rig) else ""


def _is_swapped(left: list[Blob], right: list[Blob], rig: StereoRig) -> bool:
    count, cost = _fit(left, right, rig)
    if count == min(len(left), len(right)) and cost < _CONVINCING_COST:
        return False
    other_count, other_cost = _fit(_seen_by(right, rig.right, rig.left), _seen_by(left, rig.left, rig.right), rig)
    return other_count > count or (0 < other_count == count and cost > _CLEARLY_WORSE * other_cost)


def _is_misaligned(blobs: Blobs, rig: StereoRig) -> bool:
    """Whether the rows at which the outlines begin and end do not fit the calibration.

    An epipolar plane that touches a part touches it for both cameras. Half light, shadows and neighbours move the top
    or the bottom of an outline, each in its own way; a camera that has turned moves both, and those of all parts. So
    each part is asked for that end that fits better: at most half of the parts have one that fits (what hides a part
    hides it from one camera, not half of them from each), or those of several are off to one side. Outlines with
    notches, prints among them, may outnumber the others: where most of those without fit, the rest does not count. Nor
    does any of it where most of the other polarity fits: shadows may differ where lit parts do not.
    """
    asked = [sides for sides in (_whole(blobs.sound(), blobs, rig), _located(blobs, rig)) if _are_several(sides)]
    if not asked:
        return False
    if not any(_most_fit(sides, rig) for sides in asked):
        others = _located(blobs.others, rig) if blobs.others else ([], [])
        return not (_are_several(others) and _most_fit(others, rig))
    offsets_px = _fitting_px(*asked[-1], rig)
    return len(offsets_px) >= _SEVERAL and abs(float(np.median(offsets_px))) > Feature().epipolar_tolerance_px


def _located(blobs: Blobs, rig: StereoRig) -> Sides:
    return _whole((_of(blobs.left, "", "merged"), _of(blobs.right, "", "merged")), blobs, rig)


def _whole(sides: Sides, blobs: Blobs, rig: StereoRig) -> Sides:
    """The same but those that the border may cut in the other view."""
    left, right = sides
    cut_left, cut_right = (_of(side, "cut_by_border") for side in (blobs.left, blobs.right))
    if not cut_left and not cut_right:
        return sides
    pairs = fitting_pairs([*left, *cut_left], [*right, *cut_right], rig, _MAY_BE_ITS_TOP)
    partly_left = {i for i, j in pairs if j >= len(right)}
    partly_right = {j for i, j in pairs if i >= len(left)}
    return _but(left, partly_left), _but(right, partly_right)


def _of(side: Sequence[Blob], *faults: str) -> list[Blob]:
    return [blob for blob in side if blob.fault in faults]


def _but(side: list[Blob], some: set[int]) -> list[Blob]:
    return [blob for i, blob in enumerate(side) if i not in some]


def _are_several(sides: Sides) -> bool:
    return min(map(len, sides)) >= 2


def _most_fit(sides: Sides, rig: StereoRig) -> bool:
    return 2 * len(_fitting_px(*sides, rig)) > min(map(len, sides))


def fitting_pairs(
    left: list[Blob], right: list[Blob], rig: StereoRig, area_ratio: float = _SAME_PART
) -> list[tuple[int, int]]:
    """The parts of both views that fit one another, by the better end of their outlines."""
    if not left or not right:
        return []
    method = Feature()
    offset_px = _end_offsets_px(left, right)
    tolerance_px = method.epipolar_tolerance_px + method.shape_tolerance * _lesser_heights_px(left, right)
    cost = (offset_px / tolerance_px) ** 2
    areas = _area_differences(left, right)
    disparity_px = _columns_px(left)[:, None] - _columns_px(right)
    least_px, most_px = method.disparities_px(rig)
    may_be = (cost <= 1) & (areas < np.log(area_ratio)) & (disparity_px >= least_px) & (disparity_px <= most_px)
    return assign(np.where(may_be, cost, np.inf), unmatched_cost=1.0)


def _fitting_px(left: list[Blob], right: list[Blob], rig: StereoRig) -> list[float]:
    """By how many rows [px] the parts of both views differ, of those that fit one another."""
    pairs = fitting_pairs(left, right, rig, _MAY_BE_ITS_TOP)
    return [float(px) for px in _end_offsets_px(left, right)[tuple(zip(*pairs))]] if pairs else []


def _end_offsets_px(left: list[Blob], right: list[Blob]) -> Floats:
    """By how many rows (N, M) the tops or the bottoms of two outlines differ, whichever fit better [px]."""
    ends = np.array([blob.rows_px for blob in left])[:, None] - np.array([blob.rows_px for blob in right])
    return np.asarray(np.where(np.abs(ends[..., 0]) < np.abs(ends[..., 1]), ends[..., 0], ends[..., 1]))


def _lesser_heights_px(left: list[Blob], right: list[Blob]) -> Floats:
    """The lesser of the heights of two outlines (N, M) [px]."""
    one, other = (np.diff([blob.rows_px for blob in side])[:, 0] for side in (left, right))
    return np.asarray(np.minimum(one[:, None], other))


def _area_differences(left: list[Blob], right: list[Blob]) -> Floats:
    """How the areas (N, M) of two outlines differ, as logarithms; one with a notch may hold several of the others, and
    be as much larger as they are."""
    one, other = (np.log([blob.area_px2 for blob in side]) for side in (left, right))
    has_notch, other_has = (np.array([blob.fault == "merged" for blob in side]) for side in (left, right))
    larger_by = one[:, None] - other
    may_be_several = np.where(larger_by > 0, has_notch[:, None], other_has)
    return np.where(may_be_several, 0.0, np.abs(larger_by))


def _columns_px(blobs: list[Blob]) -> Floats:
    return np.array([blob.centroid_px[0] for blob in blobs])


def _fit(left: list[Blob], right: list[Blob], rig: StereoRig) -> tuple[int, float]:
    """How many objects can be paired, and the mean cost of the pairs."""
    cost = Feature().similarity(rig).costs(left, right)
    pairs = assign(cost, unmatched_cost=1.0)
    return len(pairs), float(np.mean([cost[pair] for pair in pairs])) if pairs else np.inf


def _seen_by(blobs: Sequence[Blob], taken_for: Camera, real: Camera) -> list[Blob]:
    """The outlines as the other camera's calibration would have rectified them."""
    return [replace(blob, contour_px=real.rectified(taken_for.unrectified(blob.contour_px))) for blob in blobs]
