"""The objects that gave no match, each once although both cameras see it."""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np

from stereo_pick.core.matches.assignment import assign
from stereo_pick.core.matches.similarity import Similarity
from stereo_pick.core.objects import Blob, Blobs
from stereo_pick.core.refusal import Refusal
from stereo_pick.core.shapes import SolidFit


class Unread(NamedTuple):
    """An object that is refused: a reason of `refusal.REASONS`, its outlines in the views that show it, and the solid
    that these were taken for, if it must not be that."""

    reason: str
    left: Blob | None
    right: Blob | None
    fit: SolidFit | None = None

    @property
    def pair(self) -> tuple[Blob, Blob] | None:
        """The outlines that both views show; None where one alone does."""
        return (self.left, self.right) if self.left and self.right else None

    @property
    def alone(self) -> Blob | None:
        """The outline that one view alone shows; None where both do."""
        return None if self.left and self.right else self.left or self.right

    @property
    def refusal(self) -> Refusal:
        """It, at the centroids of its outlines."""
        left_px, right_px = (blob.centroid_px if blob else None for blob in (self.left, self.right))
        return Refusal(self.reason, left_px, right_px)


def left_over(blobs: Blobs, dealt_with: Iterable[Blob], similarity: Similarity) -> list[Unread]:
    """All objects but those `dealt_with`: faulty ones, and those that none of the other view fits.

    A faulty object and one of the other view that fits it are the same.
    """
    known = {id(blob) for blob in dealt_with}
    left = [blob for blob in blobs.left if id(blob) not in known]
    right = [blob for blob in blobs.right if id(blob) not in known]
    cost = similarity.costs(left, right)
    cost[np.ix_([not blob.fault for blob in left], [not blob.fault for blob in right])] = np.inf
    partner = dict(assign(cost, unmatched_cost=1.0))
    unread = []
    for i, blob in enumerate(left):
        other = right[partner[i]] if i in partner else None
        unread.append(Unread(blob.fault or (other.fault if other else "left_only"), blob, other))
    alone = [blob for j, blob in enumerate(right) if j not in partner.values()]
    return unread + [Unread(blob.fault or "right_only", None, blob) for blob in alone]
