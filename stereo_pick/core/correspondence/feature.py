"""Method `feature`: 8-connected objects matched between the views (thesis 3.8)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from stereo_pick.core.correspondence.ambiguity import ambiguous_pairs, uncrossed
from stereo_pick.core.correspondence.assignment import assign
from stereo_pick.core.correspondence.correspondences import Correspondences, Match, collect
from stereo_pick.core.correspondence.left_over import left_over
from stereo_pick.core.correspondence.method import Method
from stereo_pick.core.correspondence.similarity import Similarity
from stereo_pick.core.frames import RectifiedPair
from stereo_pick.core.objects import Blob, Blobs
from stereo_pick.core.params import parameter
from stereo_pick.core.refusal import Refusal
from stereo_pick.core.rig import StereoRig

Pairs = list[tuple[int, int]]

_EDGE_SIGMA_PX = 0.8
_INDEPENDENT_ARCS = 8  # shading moves an edge along whole arcs of the outline, not point by point


@dataclass(frozen=True)
class Feature(Method):
    """Matches whole objects by rows and area; their centroids are the corresponding points."""

    assignment: str = parameter(
        "global",
        "How objects are paired: one-to-one for all objects together, or by the thesis's least difference of area "
        "(eq. 3.11) for each object alone, which neither is one-to-one nor knows epipolar lines.",
        choices=("global", "area"),
    )
    epipolar_tolerance_px: float = parameter(
        1.5, "By how many rows an object's top, bottom and centroid may differ between the views.", low=0.1, high=50.0
    )
    shape_tolerance: float = parameter(
        0.03,
        "The same, in addition, as a part of the object's height: hollow parts look different from two sides.",
        low=0.0,
        high=0.5,
    )
    max_area_ratio: float = parameter(
        1.5, "By what factor an object's areas in the two views may differ.", low=1.0, high=10.0
    )
    ambiguity_margin: float = parameter(
        0.25,
        "How much better (0 the same, 1 from perfect to barely possible) a match must be than what is left over.",
        low=0.0,
        high=1.0,
    )

    def match(self, pair: RectifiedPair, blobs: Blobs) -> Correspondences:
        """Return centroids of matched objects, left to right in the left view."""
        left, right = blobs.sound()
        if self.assignment == "area":
            pairs, doubtful = least_area_difference(left, right), set()
        else:
            cost = self.similarity(pair.rig).costs(left, right)
            pairs = uncrossed(assign(cost, unmatched_cost=1.0), cost, left, right)
            doubtful = ambiguous_pairs(pairs, cost, self.ambiguity_margin)
        kept = [_match(left[i], right[j]) for i, j in pairs if (i, j) not in doubtful]
        refused = [Refusal("ambiguous", left[i].centroid_px, right[j].centroid_px) for i, j in sorted(doubtful)]
        paired = [left[i] for i, _ in pairs] + [right[j] for _, j in pairs]
        return collect(kept, [*refused, *left_over(blobs, paired, self.similarity(pair.rig))])

    def similarity(self, rig: StereoRig) -> Similarity:
        """By how much an object may differ between the views of this rig."""
        return Similarity(
            self.epipolar_tolerance_px, self.shape_tolerance, self.max_area_ratio, self.disparities_px(rig)
        )


def least_area_difference(left: list[Blob], right: list[Blob]) -> Pairs:
    """The thesis's pairing (eq. 3.11): for each left object the right one of nearest area."""
    if not right:
        return []
    areas = np.array([blob.area_px2 for blob in right])
    return [(i, int(np.abs(areas - blob.area_px2).argmin())) for i, blob in enumerate(left)]


def _match(left: Blob, right: Blob) -> Match:
    sigma_px = _EDGE_SIGMA_PX / np.sqrt(_INDEPENDENT_ARCS)
    length, width, direction = left.rectangle
    return Match(left.centroid_px, right.centroid_px, (sigma_px, sigma_px), (length, width), direction)
