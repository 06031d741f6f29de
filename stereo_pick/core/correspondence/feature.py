"""Method `feature`: 8-connected objects matched between the views (thesis 3.8)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from stereo_pick.core.arrays import Floats
from stereo_pick.core.correspondence.correspondences import Correspondences, Match, collect
from stereo_pick.core.correspondence.found_table import FoundTable
from stereo_pick.core.correspondence.method import Method
from stereo_pick.core.correspondence.reading import Reader
from stereo_pick.core.correspondence.scene import FirstLooks, Scene, scene_on, scene_on_found_table
from stereo_pick.core.doubts.certainty import by_certainty
from stereo_pick.core.doubts.prints import prints_among
from stereo_pick.core.edges.edge_map import USUAL_BLUR_PX
from stereo_pick.core.edges.hypotheses import Images
from stereo_pick.core.errors import ArrayError, ParameterError
from stereo_pick.core.frames import RectifiedPair
from stereo_pick.core.matches.left_over import Unread
from stereo_pick.core.matches.similarity import Similarity
from stereo_pick.core.objects import Blob, Blobs
from stereo_pick.core.objects.focus import lens_blur_px
from stereo_pick.core.params import parameter
from stereo_pick.core.places.extent import extent_of
from stereo_pick.core.places.position import BlobPair, Located, Row
from stereo_pick.core.places.reference_point import CHOICES, moved_px, reference_point_m
from stereo_pick.core.refusal import Refusal
from stereo_pick.core.rig import StereoRig
from stereo_pick.core.shapes import SolidFit, common_normal
from stereo_pick.core.shapes.common_table import common_table, stands_on
from stereo_pick.core.shapes.table import FOUND, NONE, Table
from stereo_pick.core.tables.checkered import told_from_boards
from stereo_pick.core.tables.given_table import misplaced_m
from stereo_pick.core.tables.grain import grained_table
from stereo_pick.core.tables.marks import marks_among, more_marks
from stereo_pick.core.tables.shaded_table import shaded_tables

Pairs = list[tuple[int, int]]


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
        "part, centimetres above the body's centre, and so does a print: what nothing shows to stand up is refused, "
        "unless this is set.",
    )
    last_look: bool = parameter(
        True,
        "Whether what was refused is looked for once more, by all edges around it, once the table and the other "
        "objects are known. Where there is much beside the parts, as prints, shadows and walls, that takes as long "
        "again as all else (docs/speed.md); without it more is refused there.",
    )
    edge_radius_m: float = parameter(
        0.0003,
        "How far the edges of parts are rounded: one sigma of their radius. Outlines hardly tell, and what is rounded "
        "seems smaller than it is, and elsewhere: the larger this is, the wider are the stated covariances.",
        low=0.0,
        high=0.005,
    )
    table: str = parameter(
        FOUND,
        "What the objects stand on: `found` by marks on it, by its own grain, from the objects that are seen best, or "
        "by the shadows on it; `none` where they may stand or hang anywhere; or the plane itself, as its normal "
        "towards the cameras and its offset, `nx ny nz d`: the points p [m] in the rectified left camera frame with "
        "n p + d = 0; `stereo-pick table` measures it.",
    )
    max_sigma_of_width: float = parameter(
        0.5,
        "One sigma of an object's depth, as a part of its middle size, from which it is refused: a gripper might miss.",
        low=0.01,
        high=10.0,
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

    def _known_table(self, pair: RectifiedPair, blobs: Blobs, fits: list[SolidFit]) -> Table | None:
        """The table that is given, or seen by its grain; but what no object stands on is the floor beyond a table."""
        if self.table != FOUND:
            return self._given_table()
        table = grained_table(pair, blobs, self.disparities_px(pair.rig))
        if table is None or (fits and not any(stands_on(table, fit) for fit in fits)):
            return None
        return table

    def match(self, pair: RectifiedPair, blobs: Blobs) -> Correspondences:
        """Return the centres of matched objects, left to right in the left view."""
        similarity = self.similarity(pair.rig)
        images, is_given = _images(pair, blobs), self._given_table() is not None
        reader = Reader(images, similarity, self.ambiguity_margin, self.flat_parts, self.last_look, is_given)
        marked = self._on_marks(reader, blobs)
        if marked is not None:
            return marked
        blobs, printed = self._told_from_boards(blobs, similarity)
        looks = self._looks(reader, blobs)
        known = self._known_table(pair, blobs, looks.fits)
        if known is not None and self.table != FOUND and (off_m := misplaced_m(known, looks.fits)) is not None:
            unread = reader.read(looks.first, None).unread
            return collect([], [*_off_table(looks.kept, off_m), *(each.refusal for each in [*unread, *printed])])
        if known is not None or self.table != FOUND:
            there = FoundTable(known, True) if known else None
            return self._collected(pair.rig, scene_on(reader, looks, there, self.edge_radius_m), printed)
        shaded = partial(shaded_tables, pair, self.disparities_px(pair.rig))
        return self._collected(pair.rig, scene_on_found_table(reader, looks, shaded, self.edge_radius_m), printed)

    def _told_from_boards(self, blobs: Blobs, similarity: Similarity) -> tuple[Blobs, list[Unread]]:
        return (blobs, []) if self.flat_parts or self.assignment == "area" else told_from_boards(blobs, similarity)

    def _looks(self, reader: Reader, blobs: Blobs) -> FirstLooks:
        if self.assignment == "area":
            return FirstLooks(reader.look_at(blobs, _by_area(blobs), []), None)
        return FirstLooks(reader.look(blobs), reader.look(blobs.others) if blobs.others else None)

    def _on_marks(self, reader: Reader, blobs: Blobs) -> Correspondences | None:
        """What stands on a table that marks show, or are on; None where none do."""
        if self.flat_parts or self.table == NONE or self.assignment == "area":
            return None
        rig, given = reader.images.rig, self._given_table()
        for marks in marks_among(blobs, reader.images.pair, reader.similarity):
            if given is not None and not marks.are_on(given, rig):
                continue
            others, unread = marks.told_from(blobs, reader.similarity)
            looks = self._looks(reader, others)
            if given is not None or marks.bear(looks.fits):
                there = FoundTable(given or marks.table, True)
                return self._collected(rig, scene_on(reader, looks, there, self.edge_radius_m), unread)
            below = common_table(looks.fits)
            if below is not None and marks.are_on_a_plate(below, rig):
                shaded = partial(shaded_tables, reader.images.pair, self.disparities_px(rig))
                return self._collected(rig, scene_on_found_table(reader, looks, shaded, self.edge_radius_m), unread)
        return None

    def _collected(self, rig: StereoRig, scene: Scene, marks: Sequence[Unread] = ()) -> Correspondences:
        together, table = scene.together, scene.together.table
        flat = [each.pair for each in together.refused if each.reason == "flat" and each.pair]
        prints = [] if self.flat_parts else prints_among(together.kept, rig, table, scene.is_known, flat)
        prints += [row for row in more_marks(together.kept, marks) if row not in prints]
        objects = [row for row in together.kept if row not in prints]
        normal = table.normal if table else common_normal([where.fit for _, where in objects])
        is_choosy = self.assignment == "global"  # the thesis takes what comes
        beyond = [row for row in objects if is_choosy and not self._is_in_range(row[1], rig)]
        objects = [row for row in objects if row not in beyond]
        looks_at_shadows = is_choosy and self.table == FOUND  # those of what hangs are elsewhere
        shaded = [row for row in objects if looks_at_shadows and scene.may_be_shaded(row, rig)]
        kept, unknown = self._of_known_reference([row for row in objects if row not in shaded], normal)
        most = self.max_sigma_of_width if is_choosy else np.inf
        unread = [*together.refused, *scene.reading.for_good, *marks, *(Unread("flat", *each) for each, _ in prints)]
        unread += [Unread("out_of_range", *each) for each, _ in beyond]
        unread += [Unread("shaded", *each) for each, _ in shaded]
        unread += [Unread("no_solid", *each) for each, _ in unknown]
        sure, unsure = by_certainty(kept, unread, rig, most, together.warped)
        sure.sort(key=lambda row: float(row[1].left_px[0]))
        matches = [self._match(rig, left, where, normal) for (left, _), where in sure]
        return collect(matches, [each.refusal for each in unread + unsure])

    def _is_in_range(self, where: Located, rig: StereoRig) -> bool:
        least_px, most_px = self.disparities_px(rig)
        return bool(least_px <= where.left_px[0] - where.right_px[0] <= most_px)

    def _of_known_reference(self, rows: list[Row], normal: Floats | None) -> tuple[list[Row], list[Row]]:
        """Those of which the reference point is known, and the others."""
        if self.reference_point == "volume":
            return rows, []
        if self.reference_point == "top" and normal is None:
            return [], rows
        return [row for row in rows if row[1].fit], [row for row in rows if not row[1].fit]

    def _match(self, rig: StereoRig, left: Blob, where: Located, normal: Floats | None) -> Match:
        length, width, direction = left.rectangle
        sigma = where.sigma_px, where.sigma_px
        if where.fit is None:
            size_px = length, width
            return Match(where.left_px, where.right_px, sigma, size_px, direction, covariance=where.covariance)
        extent = extent_of(where.fit, normal)
        point_m = reference_point_m(where.fit, extent, self.reference_point)
        left_px = where.left_px + moved_px(where.fit, point_m, rig.left)
        right_px = where.right_px + moved_px(where.fit, point_m, rig.right)
        return Match(left_px, right_px, sigma, (length, width), direction, extent, where.covariance)

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


def _by_area(blobs: Blobs) -> list[BlobPair]:
    left, right = blobs.sound()
    return [(left[i], right[j]) for i, j in least_area_difference(left, right)]


def _off_table(rows: list[Row], off_m: float) -> list[Refusal]:
    side = "above" if off_m > 0 else "below"
    detail = f"what objects stand on is {abs(off_m) * 1000:.1f} mm {side} the table that is given: measure it again"
    return [Refusal("off_table", left.centroid_px, right.centroid_px, detail) for (left, right), _ in rows]


def _images(pair: RectifiedPair, blobs: Blobs) -> Images:
    sides = (blobs.left, pair.left), (blobs.right, pair.right)
    outlines = [([blob.contour_px for blob in side], image) for side, image in sides]
    return Images(pair, [lens_blur_px(*each) if each[0] else USUAL_BLUR_PX for each in outlines])
