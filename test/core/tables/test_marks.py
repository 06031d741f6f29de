"""Many outlines on one plane on which something stands are marks on the table; on no other plane they are."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from evaluate_surroundings import scored
from marks import first_of, more
from outlines import disc
from rendered_solids import RIG, rectified, table_of, true_fit
from rendering import Box, Cylinder, Scene, Solid, Sphere, lamp_at, render_with_truth
from rendering.printed import Board, Holes
from rendering.rigs import table_before
from rendering.tabletop import Paint

from stereo_pick.core.configuration import steps
from stereo_pick.core.correspondence.feature import Feature
from stereo_pick.core.frames import RectifiedPair
from stereo_pick.core.objects import Blobs, Detector
from stereo_pick.core.pipeline import Pipeline
from stereo_pick.core.poses import ObjectPoses
from stereo_pick.core.tables.lying_flat import WarpedViews
from stereo_pick.core.tables.marks import Marks, marks_among
from stereo_pick.core.transform import Transform

OBLIQUE, OVERHEAD = table_before(RIG, 0.9, elevation_deg=50), table_before(RIG, 0.9, elevation_deg=88)
PARTS: tuple[Solid, ...] = (
    Cylinder(-0.1, 0.06, (0.045, 0.045, 0.05)),
    Box(0.1, 0.05, (0.06, 0.045, 0.04), 0.4),
    Sphere(0.11, -0.08, (0.045,) * 3),
)
HOLES, BOARD = Holes(0.025, 0.008, 0.3, 0.3), Board(-0.02, -0.09, 0.3, 0.016)
LAMP = lamp_at(70, 20, 1.2, 2.0, 0.2)


def scene_of(parts: tuple[Solid, ...], left_T_table: Transform, *paints: Paint) -> Scene:
    return Scene(parts, left_T_table, 0.25, paints=paints, lamps=(LAMP,), ambient=0.6, sky=0.7, shadows=True)


def marks_of(pair: RectifiedPair) -> tuple[list[Marks], Blobs]:
    blobs = Detector().detect(pair)
    return list(marks_among(blobs, pair, Feature().similarity(pair.rig))), blobs


def off_and_beyond(scene: Scene, **settings: str) -> tuple[list[float], int, ObjectPoses]:
    """How far the nearest pose is from each part [m], how many poses there are besides, and all."""
    frame, truth = render_with_truth(RIG, scene)
    poses = Pipeline(RIG, steps(settings)).run(frame).poses
    apart_m = np.linalg.norm(poses.xyz[:, None] - truth.centres_m, axis=2)
    return apart_m.min(axis=0, initial=np.inf).tolist(), int((apart_m.min(axis=1) > 0.02).sum()), poses


@pytest.mark.parametrize("left_T_table", [OBLIQUE, OVERHEAD], ids=["oblique", "overhead"])
@pytest.mark.parametrize("paint", [HOLES, BOARD], ids=["holes", "board"])
def test_marks_show_where_the_table_is(paint: Paint, left_T_table: Transform) -> None:
    """Those that repeat may show others as well."""
    found, _ = marks_of(rectified(RIG, scene_of(PARTS, left_T_table, paint)))
    true = table_of(RIG, left_T_table)
    (marks,) = [each for each in found if each.are_on(true, RIG)]
    assert len(marks.pairs) >= 20
    assert float(marks.table.normal @ true.normal) > np.cos(np.deg2rad(0.15))
    assert abs(marks.table.offset_m - true.offset_m) < 1e-3


@pytest.mark.parametrize("left_T_table", first_of(OBLIQUE, OVERHEAD), ids=["oblique", "overhead"])
def test_among_holes_parts_alone_are_found(left_T_table: Transform) -> None:
    """Looked straight down at, holes in a table were small black balls on another, and most parts were on none."""
    off_m, beyond, poses = off_and_beyond(scene_of(PARTS, left_T_table, HOLES))
    assert max(off_m) < 1e-3 and beyond == 0
    assert sum(each.reason == "flat" for each in poses.refused) >= 20


@pytest.mark.parametrize("higher_m", first_of(0.03, 0.0))
def test_marks_are_none_where_they_are_not_on_the_table_that_is_given(higher_m: float) -> None:
    scene = scene_of(PARTS, OBLIQUE, HOLES)
    true = table_of(RIG, OBLIQUE)
    text = " ".join(map(str, (*true.normal.tolist(), true.offset_m - higher_m)))
    off_m, beyond, _ = off_and_beyond(scene, **{"feature.table": text})
    assert beyond == 0
    assert (max(off_m) < 1e-3) == (higher_m == 0.0)


def test_tops_of_parts_that_are_alike_are_no_marks() -> None:
    places = [(x, y) for x in (-0.12, -0.04, 0.04, 0.12) for y in (-0.06, 0.06)]
    parts = tuple(Cylinder(x, y, (0.04, 0.04, 0.05)) for x, y in places)
    off_m, beyond, _ = off_and_beyond(scene_of(parts, OVERHEAD))
    assert max(off_m) < 1e-3 and beyond == 0


def test_what_is_no_mark_stays_an_object_and_what_one_view_alone_shows_is_none_if_it_is_as_small() -> None:
    pair = rectified(RIG, scene_of(PARTS, OBLIQUE, HOLES))
    (marks, *_), blobs = marks_of(pair)
    assert blobs.others is not None
    others, unread = marks.told_from(blobs, Feature().similarity(RIG))
    assert len(others.left) == len(others.right) == len(PARTS) and others.others is not None
    largest_px2 = max(blob.area_px2 for each in marks.pairs for blob in each)
    alone = [each.alone for each in unread if each.alone]
    assert alone and all(each.area_px2 <= largest_px2 for each in alone)
    before, after = len(blobs.left) + len(blobs.others.left), len(others.left) + len(others.others.left)
    assert before - after == sum(each.left is not None for each in unread)


def test_one_large_mark_says_nothing_of_how_large_marks_are() -> None:
    """The edge of a board counted as one, and a part that each view saw another piece of was none."""
    (marks, *_), blobs = marks_of(rectified(RIG, scene_of(PARTS, OBLIQUE, HOLES)))
    part = disc(40, 40, 25)
    with_part = replace(blobs, left=(*blobs.left, part))
    with_edge = replace(marks, pairs=[*marks.pairs, (disc(320, 240, 90), disc(300, 240, 90))])
    for each in (marks, with_edge):
        others, unread = each.told_from(with_part, Feature().similarity(RIG))
        assert part in others.left and not any(one.left is part for one in unread)


@pytest.mark.parametrize("part", PARTS, ids=["cylinder", "box", "sphere"])
def test_a_part_stands_before_what_is_printed_around_it(part: Solid) -> None:
    scene = scene_of(PARTS, OBLIQUE, HOLES)
    warped = WarpedViews(rectified(RIG, scene), table_of(RIG, OBLIQUE))
    assert not warped.is_seen_in_place_of_some(true_fit(RIG, scene, part))


@pytest.mark.parametrize("longer_m", [0.04, 0.06])
def test_what_is_printed_is_seen_through_a_part_that_is_taken_to_reach_over_it(longer_m: float) -> None:
    scene = scene_of(PARTS, OBLIQUE, HOLES)
    warped = WarpedViews(rectified(RIG, scene), table_of(RIG, OBLIQUE))
    _, box, _ = PARTS
    length_m, *others = box.size_m
    ahead = np.array([np.cos(box.yaw_rad), np.sin(box.yaw_rad)]) * longer_m / 2
    longer = Box(box.x_m + ahead[0], box.y_m + ahead[1], (length_m + longer_m, *others), box.yaw_rad)
    assert warped.is_seen_in_place_of_some(true_fit(RIG, scene, longer))


@pytest.mark.parametrize(
    ("family", "seed"),
    [("markers", 0), pytest.param("chessboard", 4, marks=more), pytest.param("thick_board", 0, marks=more)],
)
def test_nothing_wrong_is_found_among_markers_and_boards(family: str, seed: int) -> None:
    """A box and a marker beside it were one box, 20 mm off; squares of a board were boxes and a cylinder, and a piece
    of a thicker one, within an outline that the image cuts, a plate."""
    found = scored(None, (family, seed))
    assert found.required - len(found.missed) >= 3 and found.wrong == 0
    assert found.published <= found.required
