"""Refusal of the objects that segmentation has found faulty, each once although both cameras see it."""

from __future__ import annotations

from stereo_pick.core.correspondence.assignment import assign
from stereo_pick.core.correspondence.similarity import Similarity
from stereo_pick.core.objects import Blobs
from stereo_pick.core.refusal import Refusal


def faulty(blobs: Blobs, similarity: Similarity) -> list[Refusal]:
    """The refusals of faulty objects; those that fit between the views are one, with its place in both."""
    left = [blob for blob in blobs.left if blob.fault]
    right = [blob for blob in blobs.right if blob.fault]
    partner = dict(assign(similarity.costs(left, right), unmatched_cost=1.0))
    refused = []
    for i, blob in enumerate(left):
        other = right[partner[i]] if i in partner else None
        refused.append(Refusal(blob.fault, blob.centroid_px, None if other is None else other.centroid_px))
    alone = [blob for j, blob in enumerate(right) if j not in partner.values()]
    return refused + [Refusal(blob.fault, None, blob.centroid_px) for blob in alone]
