"""Prints are no objects, however much their outlines look like a solid's; and objects are none."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import product

import numpy as np
import pytest
from family_scenes import found
from marks import first_of, more
from rendering import Box, Cylinder, Label, Paint, Planks, Scene, Solid, Sphere, render
from rendering.rigs import table_before
from rigs import RIGS
from solid_outlines import Part, contour_px, contours_px

from stereo_pick.core.arrays import Floats
from stereo_pick.core.correspondence.feature import Feature
from stereo_pick.core.doubts.prints import prints_among
from stereo_pick.core.objects import Blob
from stereo_pick.core.pipeline import Pipeline, Result, Steps
from stereo_pick.core.places.position import Row, by_solid
from stereo_pick.core.refusal import count_reasons
from stereo_pick.core.shapes import SolidFit
from stereo_pick.core.shapes.table import Table

RIG = RIGS["thesis"]
LABELS = {
    "a bar": [Label(0.02, 0.0, 0.03, 0.012, 0.4, 0.7)],
    "a small bar": [Label(0.02, 0.0, 0.01, 0.006, 0.4, 0.7)],
    "a round one": [Label(0.0, 0.02, 0.045, 0.045, 0.0, 0.7, is_round=True)],
    "bars of a size": [Label(x, y, 0.03, 0.012, 0.4, 0.7) for x, y in ((-0.08, 0), (0.08, 0.02), (0, -0.05))],
    "round ones of a size": [
        Label(x, y, 0.03, 0.03, 0.0, 0.7, is_round=True)
        for x, y in ((-0.08, 0.04), (0.08, 0.02), (0, -0.05), (0.02, 0.06))
    ],
}
ALONE, SEVERAL = ("a bar", "a small bar", "a round one"), ("bars of a size", "round ones of a size")
PARTS = (Cylinder(-0.05, -0.03, (0.04, 0.04, 0.05)), Box(0.06, -0.04, (0.05, 0.036, 0.04), yaw_rad=0.4))


def seen(
    elevation_deg: float, parts: Sequence[Solid], paints: Sequence[Paint], ambient: float = 0.7, **options: bool
) -> Result:
    scene = Scene(tuple(parts), table_before(RIG, 0.9, elevation_deg), paints=tuple(paints), ambient=ambient)
    return Pipeline(RIG, Steps(method=Feature(**options))).run(render(RIG, scene, seed=2))


@pytest.mark.parametrize(
    ("name", "elevation_deg"),
    [
        *product(ALONE, (40, 65, 78, 88)),
        *(each for name in SEVERAL for each in first_of(*product([name], (65, 40, 78, 88)))),
    ],
)
def test_labels_on_a_table_are_refused(name: str, elevation_deg: float) -> None:
    result = seen(elevation_deg, (), LABELS[name])
    assert len(result.poses) == 0
    reasons = count_reasons(result.poses.refused)
    assert sum(reasons.values()) >= len(LABELS[name]) and set(reasons) <= {"flat", "half_lit", "other_shape"}


@pytest.mark.parametrize("elevation_deg", first_of(65, 85))
def test_labels_on_planks_are_refused(elevation_deg: float) -> None:
    result = seen(elevation_deg, (), [Planks(contrast=0.05), *LABELS["round ones of a size"]])
    assert len(result.poses) == 0 and len(result.poses.refused) >= len(LABELS["round ones of a size"])


@pytest.mark.parametrize("elevation_deg", first_of(50, 85))
def test_among_labels_the_parts_are_found(elevation_deg: float) -> None:
    labels = [Label(x, 0.05, 0.02, 0.015, 0.4, 0.7, is_round=x > 0) for x in (-0.06, 0.0, 0.06)]
    result = seen(elevation_deg, PARTS, labels)
    kinds = sorted(extent.kind for extent in result.correspondences.extents if extent)
    assert kinds == ["box", "cylinder"] and count_reasons(result.poses.refused)["flat"] == len(labels)


def test_a_part_that_may_be_flat_is_taken_for_what_it_seems() -> None:
    assert len(seen(88, (), LABELS["a round one"], flat_parts=True).poses) == 1


@pytest.mark.parametrize(
    ("part", "elevation_deg"), [(Sphere(0.0, 0.0, (0.045,) * 3), 85), (Cylinder(0.0, 0.0, (0.045, 0.045, 0.05)), 60)]
)
def test_a_lone_part_is_found_whose_light_or_sides_show_that_it_stands(part: Solid, elevation_deg: float) -> None:
    assert len(seen(elevation_deg, (part,), (), ambient=0.4).poses) == 1


def blob(contour: Floats) -> Blob:
    return Blob(contour, 100.0, sharpness=np.ones(len(contour)))


def row_of(part: Part, contours: tuple[Floats, Floats] | None = None) -> Row:
    """A solid that was found by its own outlines, or by others."""
    size_m = 2 * part.half_m[[0, 0, -1]]
    fit = SolidFit(part.kind, part.centre_m, part.rotation, size_m, 0.1, 1e-8 * np.eye(3))
    left, right = contours or contours_px(part, RIG)
    return (blob(left), blob(right)), by_solid(RIG, fit, 1.0)


def ball(x_m: float = 0.0) -> Part:
    return Part("sphere", np.array([0.1 + x_m, 0.0, 0.85]), np.eye(3), np.array([0.02]))


def below(part: Part, by_m: float) -> Table:
    return Table(np.array([0.0, 0.0, -1.0]), float(part.centre_m[2]) + by_m, 2e-4)


def test_only_a_table_below_it_shows_that_a_ball_in_even_light_is_no_label() -> None:
    row = row_of(ball())
    assert prints_among([row], RIG, None, False) == [row]
    assert prints_among([row], RIG, below(ball(), 0.02), True) == []
    assert prints_among([row], RIG, below(ball(), 0.0), True) == [row]


def test_a_table_that_is_not_known_well_does_not_show_it() -> None:
    unsure = Table(*(getattr(below(ball(), 0.02), name) for name in ("normal", "offset_m")), 0.02)
    assert prints_among([row_of(ball())], RIG, unsure, True) != []


def test_the_lit_top_of_a_solid_with_more_edges_is_no_label() -> None:
    """A cylinder from above: a face of it is all that is outlined, the rest is known by faint edges."""
    assert prints_among([from_above(0.1, 0.15, 0.88)], RIG, None, False) == []


def from_above(x_m: float, y_m: float, foot_m: float) -> Row:
    """A cylinder that stands at that depth, of which only the top is outlined."""
    part = Part("cylinder", np.array([x_m, y_m, foot_m - 0.03]), np.eye(3), np.array([0.02, 0.03]))
    return row_of(part, disc_px(part.centre_m - (0, 0, 0.03)))


def disc_px(centre_m: Floats) -> tuple[Floats, Floats]:
    """What both views show of a disc that faces them."""
    angle = np.linspace(0, 2 * np.pi, 200, endpoint=False)
    rim = centre_m + 0.02 * np.c_[np.cos(angle), np.sin(angle), np.zeros(200)]
    left, right = (contour_px(rim - eye_m, camera) for eye_m, camera in zip(RIG.eyes_m, (RIG.left, RIG.right)))
    return left, right


def test_labels_do_not_vouch_for_a_table_of_their_own() -> None:
    """Three round ones are three balls on a plane half a diameter below."""
    rows = [row_of(ball(x_m), disc_px(ball(x_m).centre_m)) for x_m in (-0.06, 0.0, 0.06)]
    table = below(ball(), 0.02)
    assert prints_among(rows, RIG, table, is_known=False) == rows
    assert prints_among(rows, RIG, table, is_known=True) == []


def test_labels_do_not_put_the_table_below_where_others_stand() -> None:
    """The same, where two cylinders stand on what the labels lie on, and all of them were thought to stand."""
    labels = [row_of(ball(x_m), disc_px(ball(x_m).centre_m)) for x_m in (-0.06, 0.0, 0.06)]
    others = [from_above(x_m, 0.15, float(ball().centre_m[2])) for x_m in (-0.05, 0.12)]
    table = Table(np.array([0.0, 0.0, -1.0]), float(ball().centre_m[2]) + 0.02, 2e-4)
    assert prints_among([*labels, *others], RIG, table, is_known=False) == labels
    assert prints_among([*labels, *others], RIG, table, is_known=True) == []


@pytest.mark.parametrize(("lower_m", "are_refused"), [(0.0, True), (0.02, False)])
def test_where_one_other_tells_of_no_table_labels_are_what_it_stands_on(lower_m: float, are_refused: bool) -> None:
    """Two, taken for balls on a table that they drew along, and a cylinder on their plane, or lower."""
    labels = [row_of(ball(x_m), disc_px(ball(x_m).centre_m)) for x_m in (-0.06, 0.06)]
    foot_m = float(ball().centre_m[2])
    table = Table(np.array([0.0, 0.0, -1.0]), foot_m + 0.02, 2e-4)
    rows = [*labels, from_above(0.12, 0.15, foot_m + lower_m)]
    assert prints_among(rows, RIG, table, is_known=False) == (labels if are_refused else [])


@pytest.mark.parametrize(("lower_m", "is_refused"), [(0.0, True), (0.02, False)])
def test_labels_that_are_refused_already_count_as_what_another_stands_on(lower_m: float, is_refused: bool) -> None:
    """One was taken for a cylinder, which put the table below the others."""
    one, other = (row_of(ball(x_m), disc_px(ball(x_m).centre_m)) for x_m in (-0.06, 0.06))
    foot_m = float(ball().centre_m[2])
    table = Table(np.array([0.0, 0.0, -1.0]), foot_m + 0.02, 2e-4)
    rows = [one, from_above(0.12, 0.15, foot_m + lower_m)]
    assert prints_among(rows, RIG, table, is_known=False) == []
    assert prints_among(rows, RIG, table, is_known=False, refused=[other[0]]) == ([one] if is_refused else [])


def test_strokes_that_run_into_each_other_do_not_vouch_for_the_table_of_others() -> None:
    """Their outline lies on no plane, and no solid explains it."""
    labels = [row_of(ball(x_m), disc_px(ball(x_m).centre_m)) for x_m in (-0.06, 0.0, 0.06)]
    blobs, where = standing(0.1, 45)
    strokes = blobs, replace(where, fit=None)
    table = below(ball(), 0.02)
    assert prints_among([*labels, strokes], RIG, table, is_known=False) == labels
    assert prints_among([*labels, (blobs, where)], RIG, table, is_known=False) == []


def level_rows(elevation_deg: float, kind: str) -> tuple[Row, Table]:
    """A lit top 30 mm above the table, taken for a ball or for a lying cylinder there; and the table."""
    placed = table_before(RIG, 0.9, elevation_deg)
    normal = RIG.left.R @ placed.rotation[:, 2]
    table = Table(normal, -float(normal @ RIG.left.R @ placed.translation), 2e-4)
    corners = np.array([(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)]) * (0.025, 0.015, 0) + (0.0, 0.0, 0.03)
    top = placed.apply(corners) @ RIG.left.R.T
    left, right = (contour_px(top - eye_m, camera) for eye_m, camera in zip(RIG.eyes_m, (RIG.left, RIG.right)))
    half = {"sphere": (0.02,), "cylinder": (0.015, 0.025)}[kind]
    return row_of(Part(kind, top.mean(axis=0), np.eye(3), np.array(half)), (left, right)), table


@pytest.mark.parametrize(("elevation_deg", "is_refused"), [(45, True), (60, True), (85, False)])
def test_a_level_outline_high_above_the_table_is_a_top_unless_seen_from_above(
    elevation_deg: float, is_refused: bool
) -> None:
    row, table = level_rows(elevation_deg, "cylinder")
    assert prints_among([row], RIG, table, is_known=True) == ([row] if is_refused else [])


def standing(x_m: float, elevation_deg: float) -> Row:
    """A cylinder that shows more than one face."""
    placed = table_before(RIG, 0.9, elevation_deg)
    rotation = RIG.left.R @ placed.rotation
    centre = RIG.left.R @ np.ravel(placed.apply(np.array([[x_m, 0.0, 0.025]])))
    return row_of(Part("cylinder", centre, rotation, np.array([0.02, 0.025])))


def test_what_faces_the_cameras_where_others_stand_otherwise_is_no_label() -> None:
    """Without a table; a label would lie as they stand."""
    facing = row_of(ball())
    assert prints_among([facing], RIG, None, False) == [facing]
    others = [standing(x_m, 45) for x_m in (-0.06, 0.06)]
    assert prints_among([facing, *others], RIG, None, False) == []


def test_without_a_table_balls_are_believed_that_have_planes_of_their_own() -> None:
    """Several balls in even light; of two parts that are none, none is."""
    near = [row_of(ball(x_m)) for x_m in (-0.08, 0.08)]
    lower = row_of(Part("sphere", np.array([0.1, 0.08, 0.95]), np.eye(3), np.array([0.02])))
    assert prints_among([near[0], lower], RIG, None, False) == []
    bar, _ = level_rows(85, "cylinder")
    assert prints_among([bar, lower], RIG, None, False) == [bar]


def test_outlines_without_a_row_in_common_are_left_to_others() -> None:
    (left, right), where = row_of(ball())
    row = (left, blob(right.contour_px + (0.0, 200.0))), where
    assert prints_among([row], RIG, None, False) == prints_among([row], RIG, below(ball(), 0.02), True) == []


@more
def test_a_carton_that_is_as_flat_as_the_planks_below_it_is_no_box() -> None:
    """It was one, 18 mm high, that lacked its creases."""
    result = found("planks_and_prints", 97)
    assert len(result.ghosts_m) == 0 and result.wrong == 0 and result.missed == []


def test_where_the_table_is_seen_no_part_shares_the_outline_of_a_print() -> None:
    """Marks of it passed for a box, 24 mm high, on a table that was not known to a tenth of that."""
    result = found("planks_and_prints", 338)
    assert len(result.ghosts_m) == 0 and result.wrong == 0 and result.missed == []


def test_one_stroke_of_many_is_no_rod_on_a_table_that_a_few_of_them_leave_open() -> None:
    """Two were, which tilted the table until the cameras hardly saw it; and so another was."""
    assert found("empty", 392).published == 0
