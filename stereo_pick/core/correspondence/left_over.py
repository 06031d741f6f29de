"""Refusal of the objects that gave no match, each once although both cameras see it."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from stereo_pick.core.correspondence.assignment import assign
from stereo_pick.core.correspondence.similarity import Similarity
from stereo_pick.core.objects import Blob, Blobs
from stereo_pick.core.refusal import Refusal


def left_over(blobs: Blobs, dealt_with: Iterable[Blob], similarity: Similarity) -> list[Refusal]:
    """The refusals of all objects but those `dealt_with`: faulty ones, and those that none of the other view fits.

    A faulty object and one of the other view that fits it are the same: one refusal, with its place in both views.
    """
    known = {id(blob) for blob in dealt_with}
    left = [blob for blob in blobs.left if id(blob) not in known]
    right = [blob for blob in blobs.right if id(blob) not in known]
    cost = similarity.costs(left, right)
    cost[np.ix_([not blob.fault for blob in left], [not blob.fault for blob in right])] = np.inf
    partner = dict(assign(cost, unmatched_cost=1.0))
    refused = []
    for i, blob in enumerate(left):
        other = right[partner[i]] if i in partner else None
        fault = blob.fault or (other.fault if other else "left_only")
        refused.append(Refusal(fault, blob.centroid_px, other.centroid_px if other else None))
    alone = [blob for j, blob in enumerate(right) if j not in partner.values()]
    return refused + [Refusal(blob.fault or "right_only", None, blob.centroid_px) for blob in alone]
