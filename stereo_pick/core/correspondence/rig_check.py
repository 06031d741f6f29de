"""Whether the images fit the calibration at all, before single objects are believed.

On cameras that look towards each other, exchanged images can give depths that look quite possible, and so can single
chance matches under a wrong calibration. What gives both away is how many of the objects fit between the views.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from stereo_pick.core.camera import Camera
from stereo_pick.core.correspondence.assignment import assign
from stereo_pick.core.correspondence.feature import Feature
from stereo_pick.core.objects import Blob, Blobs
from stereo_pick.core.rig import StereoRig

_CONVINCING_COST = 0.1  # on the scale of `Similarity.costs`, where 1 is barely possible
_CLEARLY_WORSE = 4.0


def rig_fault(blobs: Blobs, rig: StereoRig) -> str:
    """Why no object of this pair may be believed: `swapped`, `misaligned`, or nothing.

    swapped: the objects fit only, or clearly better, when left and right change places. misaligned: at most half of
    the objects that could have a partner have one; what hides an object hides it from one camera, not half from each.
    """
    left, right = blobs.sound()
    possible = min(len(left), len(right))
    count, cost = _fit(left, right, rig)
    if count == possible and cost < _CONVINCING_COST:
        return ""
    other_count, other_cost = _fit(_seen_by(right, rig.right, rig.left), _seen_by(left, rig.left, rig.right), rig)
    if other_count > count or (0 < other_count == count and cost > _CLEARLY_WORSE * other_cost):
        return "swapped"
    return "misaligned" if possible >= 2 and 2 * count <= possible else ""


def _fit(left: list[Blob], right: list[Blob], rig: StereoRig) -> tuple[int, float]:
    """How many objects can be paired, and the mean cost of the pairs."""
    cost = Feature().similarity(rig).costs(left, right)
    pairs = assign(cost, unmatched_cost=1.0)
    return len(pairs), float(np.mean([cost[pair] for pair in pairs])) if pairs else np.inf


def _seen_by(blobs: Sequence[Blob], taken_for: Camera, real: Camera) -> list[Blob]:
    """The outlines as the other camera's calibration would have rectified them."""
    return [replace(blob, contour_px=real.rectified(taken_for.unrectified(blob.contour_px))) for blob in blobs]
