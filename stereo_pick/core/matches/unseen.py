"""What becomes of a pair of which one view cannot show its objects."""

from __future__ import annotations

import numpy as np

from stereo_pick.core.arrays import Floats, Image
from stereo_pick.core.frames import RectifiedPair
from stereo_pick.core.objects import Blobs
from stereo_pick.core.refusal import Refusal


def unseen(blobs: Blobs, pair: RectifiedPair) -> list[Refusal]:
    """One refusal for each view with a fault, at its centre, and one for each object that the other view shows."""
    left_fault, right_fault = blobs.view_faults
    refused = []
    if left_fault:
        refused.append(Refusal(left_fault, _centre_px(pair.left), None))
    if right_fault:
        refused.append(Refusal(right_fault, None, _centre_px(pair.right)))
    refused += [Refusal(blob.fault or right_fault or "left_only", blob.centroid_px, None) for blob in blobs.left]
    return refused + [Refusal(blob.fault or left_fault or "right_only", None, blob.centroid_px) for blob in blobs.right]


def _centre_px(view: Image) -> Floats:
    return (np.array(view.shape[::-1]) - 1) / 2
