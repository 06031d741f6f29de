"""Method `feature`: 8-connected objects matched between the views (thesis 3.8)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from stereo_pick.core.arrays import Floats
from stereo_pick.core.correspondence.ambiguity import ambiguous_pairs, uncrossed
from stereo_pick.core.correspondence.apart import Matching, taken_apart
from stereo_pick.core.correspondence.assignment import assign
from stereo_pick.core.correspondence.correspondences import Correspondences, Match, collect
from stereo_pick.core.correspondence.extent import extent_of
from stereo_pick.core.correspondence.left_over import left_over
from stereo_pick.core.correspondence.located import locate
from stereo_pick.core.correspondence.method import Method
from stereo_pick.core.correspondence.on_table import SecondLook, lit_parts
from stereo_pick.core.correspondence.overlap import one_in_each_place
from stereo_pick.core.correspondence.position import BlobPair, Located, Row, with_dark_ends
from stereo_pick.core.correspondence.reference_point import CHOICES, moved_px, reference_point_m
from stereo_pick.core.correspondence.similarity import Similarity
from stereo_pick.core.errors import ArrayError, ParameterError
from stereo_pick.core.frames import RectifiedPair
from stereo_pick.core.objects import Blob, Blobs
from stereo_pick.core.objects.focus import lens_blur_px
from stereo_pick.core.params import parameter
from stereo_pick.core.refusal import Refusal
from stereo_pick.core.rig import StereoRig
from stereo_pick.core.shapes import common_normal
from stereo_pick.core.shapes.edge_map import USUAL_BLUR_PX
from stereo_pick.core.shapes.hypotheses import Images
from stereo_pick.core.shapes.table import FOUND, NONE, Table

Pairs = list[tuple[int, int]]

_PLAIN_SIGMA_PX = 0.3  # of a centroid of whole pixels: shading moves its edges along whole arcs


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
    reference_point: str = parameter(
        "volume",
        "Which point of an object its position is: the centre of its volume, the middle of its top, or the point of "
        "its surface nearest to the left camera. The last two need a solid that explains the object.",
        choices=CHOICES,
    )
    flat_parts: bool = parameter(
        False,
        "Whether parts may be flat. The lit top of a body whose sides are as bright as the table looks like a flat "
        "part, centimetres above the body's centre: what shows one flat face only is refused, unless this is set.",
    )
    table: str = parameter(
        FOUND,
        "What the objects stand on: `found` from those that are seen best; `none` where they may stand or hang "
        "anywhere; or the plane itself, as its normal towards the cameras and its offset, `nx ny nz d`: the points "
        "p [m] in the rectified left camera frame with n p + d = 0.",
    )
    ambiguity_margin: float = parameter(
        0.25,
        "How much better (0 the same, 1 from perfect to barely possible) a match must be than what is left over.",
        low=0.0,
        high=1.0,
    )

    def __post_init__(self) -> None:
        """Read the table, if it is given."""
        super().__post_init__()
        try:
            self._given_table()
        except ArrayError as error:
            raise ParameterError(f"table = {self.table!r}: {error}") from None

    def _given_table(self) -> Table | None:
        return None if self.table in (FOUND, NONE) else Table.parsed(self.table)

    def match(self, pair: RectifiedPair, blobs: Blobs) -> Correspondences:
        """Return the centres of matched objects, left to right in the left view."""
        if self.assignment == "area":
            left, right = blobs.sound()
            matched = [(left[i], right[j]) for i, j in least_area_difference(left, right)]
            return self._collected(_images(pair, blobs), blobs, matched, [])
        matched, doubtful = self._paired(pair.rig, blobs.left, blobs.right)
        return self._collected(_images(pair, blobs), blobs, matched, doubtful)

    def _paired(
        self, rig: StereoRig, left: Sequence[Blob], right: Sequence[Blob]
    ) -> tuple[list[BlobPair], list[BlobPair]]:
        """The pairs of objects that belong together, and those that might as well be paired otherwise."""
        one, other = _located_blobs(left), _located_blobs(right)
        cost = self.similarity(rig).costs(one, other)
        pairs = uncrossed(assign(cost, unmatched_cost=1.0), cost, one, other)
        doubtful = ambiguous_pairs(pairs, cost, self.ambiguity_margin)
        sure = [(one[i], other[j]) for i, j in pairs if (i, j) not in doubtful]
        return sure, [(one[i], other[j]) for i, j in sorted(doubtful)]

    def _collected(
        self, images: Images, blobs: Blobs, matched: list[BlobPair], doubtful: list[BlobPair]
    ) -> Correspondences:
        kept, lost = _told_apart(self._located(images, matched, blobs.max_concavity))
        unclear = [blob for each in doubtful for blob in each]
        matching = Matching(
            self.similarity(images.rig),
            lambda left, right: self._paired(images.rig, left, right)[0],
            lambda pairs: self._located(images, pairs, blobs.max_concavity),
        )
        blobs, rows = taken_apart(blobs, _blobs_of(kept) + unclear, matching)
        found, lost_parts = _told_apart(rows)
        kept, twice = one_in_each_place(kept + found)
        lost = lost + lost_parts + twice
        kept, off, table = self._on_table(images, blobs, kept, unclear)
        lost = lost + off
        lost = [row for row in lost if not _any_of(row[0], _blobs_of(kept)) and _all_of(row[0], blobs)]
        refused = [Refusal(where.reason, where.left_px, where.right_px) for _, where in lost]
        refused += [Refusal("ambiguous", left.centroid_px, right.centroid_px) for left, right in doubtful]
        kept = [(each, with_dark_ends(images.rig, each, where)) for each, where in kept]
        normal = table.normal if table else common_normal([where.fit for _, where in kept])
        kept, unknown = self._of_known_reference(kept, normal)
        refused += [Refusal("no_solid", where.left_px, where.right_px) for _, where in unknown]
        kept = sorted(kept, key=lambda row: float(row[1].left_px[0]))
        matches = [self._match(images.rig, left, where, normal) for (left, _), where in kept]
        dealt_with = _blobs_of(kept + lost + unknown) + unclear
        return collect(matches, [*refused, *left_over(blobs, dealt_with, self.similarity(images.rig))])

    def _on_table(
        self, images: Images, blobs: Blobs, kept: list[Row], unclear: list[Blob]
    ) -> tuple[list[Row], list[Row], Table | None]:
        """What is found with the table, what is refused because of it, and the table."""
        if not _have_edges(blobs):
            return kept, [], self._given_table()
        left, right = (_without(side, _blobs_of(kept) + unclear) for side in (blobs.left, blobs.right))
        look = SecondLook(images, lit_parts(left, right, self.disparities_px(images.rig)), self.flat_parts)
        table = self._given_table()
        if self.table == FOUND:
            table = look.found_table(kept)
        return (kept, [], None) if table is None else (*look.seen_on(table, kept), table)

    def _of_known_reference(self, rows: list[Row], normal: Floats | None) -> tuple[list[Row], list[Row]]:
        """Those of which the reference point is known, and the others."""
        if self.reference_point == "volume":
            return rows, []
        if self.reference_point == "top" and normal is None:
            return [], rows
        return [row for row in rows if row[1].fit], [row for row in rows if not row[1].fit]

    def _located(self, images: Images, matched: list[BlobPair], max_concavity: float) -> list[Row]:
        if all(len(blob.sharpness) for each in matched for blob in each):
            return list(zip(matched, locate(images, matched, max_concavity, self.flat_parts)))
        return [((one, two), Located(one.centroid_px, two.centroid_px, _PLAIN_SIGMA_PX, None)) for one, two in matched]

    def _match(self, rig: StereoRig, left: Blob, where: Located, normal: Floats | None) -> Match:
        length, width, direction = left.rectangle
        sigma = where.sigma_px, where.sigma_px
        if where.fit is None:
            return Match(where.left_px, where.right_px, sigma, (length, width), direction)
        extent = extent_of(where.fit, normal)
        point_m = reference_point_m(where.fit, extent, self.reference_point)
        left_px = where.left_px + moved_px(where.fit, point_m, rig.left)
        right_px = where.right_px + moved_px(where.fit, point_m, rig.right)
        return Match(left_px, right_px, sigma, (length, width), direction, extent)

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


def _images(pair: RectifiedPair, blobs: Blobs) -> Images:
    sides = (blobs.left, pair.left), (blobs.right, pair.right)
    outlines = [([blob.contour_px for blob in side], image) for side, image in sides]
    return Images(pair, [lens_blur_px(*each) if each[0] else USUAL_BLUR_PX for each in outlines])


def _told_apart(rows: Sequence[Row]) -> tuple[list[Row], list[Row]]:
    """Those whose place is known, and those that must be refused."""
    return [row for row in rows if not row[1].reason], [row for row in rows if row[1].reason]


def _blobs_of(rows: Sequence[Row]) -> list[Blob]:
    return [blob for blobs, _ in rows for blob in blobs]


def _without(blobs: Sequence[Blob], others: Sequence[Blob]) -> list[Blob]:
    return [blob for blob in _located_blobs(blobs) if blob not in others]


def _any_of(pair: BlobPair, others: Sequence[Blob]) -> bool:
    return any(blob in others for blob in pair)


def _all_of(pair: BlobPair, blobs: Blobs) -> bool:
    return all(blob in (*blobs.left, *blobs.right) for blob in pair)


def _have_edges(blobs: Blobs) -> bool:
    return all(len(blob.sharpness) for blob in _located_blobs((*blobs.left, *blobs.right)))


def _located_blobs(blobs: Sequence[Blob]) -> list[Blob]:
    """Those whose place can be known: touching or half-lit parts too, as far as a solid explains them."""
    return [blob for blob in blobs if blob.fault == "" or (blob.fault == "merged" and len(blob.sharpness))]
