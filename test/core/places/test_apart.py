"""Which parts of touching objects count, whatever finds their solids; and on renderings, whether they are found."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
import pytest
from marks import first_of
from outlines import seen
from rendered_solids import half_lit_scene
from rendering import Cylinder, Scene, render
from rendering.rigs import table_before
from rigs import RIGS

from stereo_pick.core.arrays import Floats
from stereo_pick.core.matches.similarity import Similarity
from stereo_pick.core.objects import Blob
from stereo_pick.core.pipeline import Pipeline, Steps
from stereo_pick.core.places.apart import Matching, Row, taken_apart
from stereo_pick.core.places.position import BlobPair, Located
from stereo_pick.core.refusal import count_reasons
from stereo_pick.core.shapes import SolidFit

SIMILARITY = Similarity(1.5, 0.03, 1.5, (-100.0, 100.0))
BALL_M = 0.02


def two_discs(radius_px: float = 20.0, gap_px: float = -4.0) -> Blob:
    """The outline of two discs beside each other that overlap."""
    reach = radius_px + gap_px / 2
    half = np.arccos(reach / radius_px)
    angle = np.linspace(half, 2 * np.pi - half, 60)
    left = np.stack([radius_px * np.cos(angle) - reach, radius_px * np.sin(angle)], axis=1)
    contour = np.concatenate([left, -left])[::-1] + 120
    return Blob(contour, 100.0, fault="merged", sharpness=np.full(len(contour), 0.9))


def ball_at(centre_m: Floats, size_m: float) -> SolidFit:
    return SolidFit("sphere", centre_m, np.eye(3), np.full(3, size_m), 0.05, 1e-9 * np.eye(3))


def matching(
    place_m: Callable[[Blob], Floats | None],
    paired: bool = True,
    size_m: Callable[[Blob], float] = lambda part: BALL_M,
) -> Matching:
    """Finds balls where a part of the left view says, so large as it says, or nothing; may pair what each view alone is
    cut into."""

    def located(pairs: list[BlobPair]) -> list[Row]:
        return [(pair, of(*pair)) for pair in pairs]

    def of(left: Blob, right: Blob) -> Located:
        centre_m = place_m(left)
        if centre_m is None:
            return Located(left.centroid_px, right.centroid_px, 1.0, None, "merged")
        return Located(left.centroid_px, right.centroid_px, 1.0, ball_at(centre_m, size_m(left)))

    def in_order(left: Sequence[Blob], right: Sequence[Blob]) -> list[BlobPair]:
        return list(zip(*(sorted(side, key=lambda b: float(b.centroid_px[0])) for side in (left, right))))

    return Matching(SIMILARITY, in_order if paired else lambda left, right: [], located)


def as_seen(part: Blob) -> Floats:
    """A millimetre a pixel."""
    return np.append(part.centroid_px / 1000, 1.0)


@pytest.mark.parametrize("paired", [True, False], ids=["cut alone", "cut together"])
def test_two_bodies_are_two_parts_and_nothing_is_left(paired: bool) -> None:
    blobs, rows = taken_apart(seen([two_discs()], [two_discs()]), [], matching(as_seen, paired))
    assert len(rows) == 2 and not any(where.reason for _, where in rows)
    assert {blob for each, _ in rows for blob in each} == {*blobs.left, *blobs.right}
    assert sorted(float(left.centroid_px[0]) for (left, _), _ in rows) == pytest.approx([102, 138], abs=1)


def test_one_body_in_both_halves_is_one() -> None:
    blobs, rows = taken_apart(
        seen([two_discs()], [two_discs()]), [], matching(lambda part: np.array([0.0, 0.0, 1.0]), paired=False)
    )
    assert len(rows) == 1 and len(blobs.left) == len(blobs.right) == 1


def test_one_body_that_reaches_over_another_leaves_that_one_refused() -> None:
    """Only where each holds the other's centre they are one: else nothing that was seen may vanish."""
    spread = matching(as_seen, paired=False, size_m=lambda part: 0.1 if part.centroid_px[0] < 110 else BALL_M)
    blobs, rows = taken_apart(seen([two_discs()], [two_discs()]), [], spread)
    assert sorted(where.reason for _, where in rows) == ["", "merged"]
    assert {blob for each, _ in rows for blob in each} == {*blobs.left, *blobs.right} and len(blobs.left) == 2


def test_one_part_that_is_found_counts_and_the_other_is_left() -> None:
    only_left = matching(lambda part: as_seen(part) if part.centroid_px[0] < 110 else None)
    blobs, rows = taken_apart(seen([two_discs()], [two_discs()]), [], only_left)
    assert [where.reason for _, where in rows].count("") == 1
    assert len(blobs.left) == len(blobs.right) == 2


def test_where_no_part_is_found_nothing_is_cut() -> None:
    whole = seen([two_discs()], [two_discs()])
    blobs, rows = taken_apart(whole, [], matching(lambda part: None))
    assert (blobs.left, blobs.right, rows) == (whole.left, whole.right, [])


def test_what_is_dealt_with_is_not_cut() -> None:
    whole = seen([two_discs()], [two_discs()])
    blobs, rows = taken_apart(whole, [*whole.left, *whole.right], matching(as_seen))
    assert (blobs.left, blobs.right, rows) == (whole.left, whole.right, [])


@pytest.mark.parametrize("number", [2, 4, 6])
def test_what_is_tried_in_vain_grows_with_the_objects_and_not_with_their_combinations(number: int) -> None:
    """Marks on a carton look like parts that may be cut in any combination."""
    tried: list[BlobPair] = []

    def noted(pairs: list[BlobPair]) -> list[Row]:
        tried.extend(pairs)
        return [(pair, Located(pair[0].centroid_px, pair[1].centroid_px, 1.0, None, "merged")) for pair in pairs]

    side = [moved(two_discs(), 150.0 * i) for i in range(number)]
    anywhere = Similarity(1.5, 0.03, 1.5, (-2000.0, 2000.0))
    taken_apart(seen(side, side), [], Matching(anywhere, lambda left, right: [], noted))
    ways_of_each, pairs_of_each = 8, 2
    assert number <= len(tried) <= 2 * ways_of_each * pairs_of_each * number


def moved(blob: Blob, by_px: float) -> Blob:
    return replace(blob, contour_px=blob.contour_px + [by_px, 0.0])


RIG = RIGS["thesis"]
DIRECTIONS = 6  # in half a turn, which exchanges two parts that are alike


def pair_of_cylinders(turn_rad: float, sides: float) -> Scene:
    """Two that stand in contact, the sides of which are so much brighter than the table."""
    table = table_before(RIG, 0.9, elevation_deg=50)
    x, y = 0.02 * np.cos(turn_rad), 0.02 * np.sin(turn_rad)
    parts = tuple(Cylinder(s * x, s * y, (0.0398, 0.0398, 0.045)) for s in (-1, 1))
    return half_lit_scene(parts, table, sides)


@pytest.mark.parametrize("sides", first_of(0.3, 0.1), ids=["bright", "dim"])
def test_cylinders_in_contact_are_both_found_unless_one_hides_much_of_the_other(sides: float) -> None:
    for k in range(DIRECTIONS):
        turn_rad = np.pi * k / DIRECTIONS
        scene = pair_of_cylinders(turn_rad, sides)
        poses = Pipeline(RIG, Steps()).run(render(RIG, scene, seed=k)).poses
        off_m = np.linalg.norm(poses.xyz[:, None] - scene.positions_m(), axis=2)
        if abs(np.sin(turn_rad)) < 0.99:  # the cameras look along the table's second axis
            assert len(poses) == 2 and sorted(off_m.argmin(axis=1)) == [0, 1]
            assert off_m.min(axis=1).max() < 1.5e-3
        else:
            assert (off_m.min(axis=1) < 5e-3).all()
            assert len(poses) == 2 or count_reasons(poses.refused)
