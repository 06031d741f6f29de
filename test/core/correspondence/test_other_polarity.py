"""Dark objects among bright ones: found, and not taken for shadows, nor shadows for them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from families import staged
from family_scenes import found
from marks import first_of
from outlines import disc
from rendering import Box, Carton, Cylinder, Scene, Solid, Sphere, lamp_at, render
from rendering.rigs import table_before
from rigs import RIGS

from stereo_pick.core.arrays import Floats
from stereo_pick.core.correspondence.other_polarity import joined
from stereo_pick.core.correspondence.reading import Reading
from stereo_pick.core.objects import Detector
from stereo_pick.core.pipeline import Pipeline, Result, Steps
from stereo_pick.core.places.position import Located, Row
from stereo_pick.core.refusal import count_reasons
from stereo_pick.core.shapes import SolidFit
from stereo_pick.core.shapes.table import Table

RIG = RIGS["thesis"]
PLACED = table_before(RIG, 0.9, elevation_deg=50)
BRIGHT = (
    Cylinder(-0.09, -0.05, (0.045, 0.045, 0.05)),
    Box(0.09, -0.06, (0.06, 0.04, 0.035), yaw_rad=0.5),
    Cylinder(0.0, 0.08, (0.04, 0.04, 0.045)),
)
DARK = (
    Box(0.0, -0.02, (0.05, 0.045, 0.04), yaw_rad=0.3, albedo=0.06),
    Cylinder(0.1, 0.05, (0.05, 0.05, 0.04), albedo=0.08),
    Sphere(-0.1, 0.06, (0.045,) * 3, albedo=0.05),
)
LOW_LAMP = (lamp_at(25, 40, 1.5, 1.5, 0.03),)


def seen(parts: Sequence[Solid], detector: Detector | None = None, **of_scene: object) -> tuple[Scene, Result]:
    scene = Scene(tuple(parts), PLACED, **{"table_albedo": 0.3, **of_scene})
    return scene, Pipeline(RIG, Steps(detector=detector or Detector())).run(render(RIG, scene, seed=1))


def off_m(result: Result, positions_m: Floats) -> Floats:
    return np.asarray(np.linalg.norm(result.poses.xyz[:, None] - positions_m, axis=2).min(axis=1))


@pytest.mark.parametrize(
    "parts",
    [BRIGHT + DARK, BRIGHT + DARK[:1], BRIGHT[:1] + DARK],
    ids=["as many", "one dark among bright", "one bright among dark"],
)
def test_bright_and_dark_parts_of_one_table_are_all_found(parts: tuple[Solid, ...]) -> None:
    scene, result = seen(parts)
    assert len(result.poses) == len(parts) and not result.poses.refused
    assert off_m(result, scene.positions_m()).max() < 1e-3


def test_a_polarity_that_is_given_is_the_only_one() -> None:
    for polarity, parts in (("bright", BRIGHT), ("dark", DARK)):
        _, result = seen(BRIGHT + DARK, Detector(polarity=polarity))
        assert len(result.poses) == len(parts)


def test_shadows_of_bright_parts_are_no_dark_parts() -> None:
    scene, result = seen(BRIGHT, lamps=LOW_LAMP, ambient=0.3, shadows=True)
    assert result.blobs.others is not None  # the shadows were seen
    assert len(result.poses) == len(BRIGHT) and off_m(result, scene.positions_m()).max() < 1e-3
    assert set(count_reasons(result.poses.refused)) <= {"faint"}


def test_a_dark_print_is_no_dark_part_and_is_not_spoken_of() -> None:
    scene, result = seen(BRIGHT, paints=(Carton(0.0, -0.03, 0.05, 0.04, 0.4, albedo=0.06, ink=1.0),))
    assert result.blobs.others is not None
    assert len(result.poses) == len(BRIGHT) and off_m(result, scene.positions_m()).max() < 1e-3
    assert not result.poses.refused


def test_what_is_dark_beside_a_bright_part_is_nothing_but_a_part_where_dark_parts_are_the_rule() -> None:
    """In contact it could be the bright one's shadow or dark side, too: of its outline it is spoken."""
    beside = Cylinder(-0.09, 0.0, (0.045, 0.045, 0.03), albedo=0.05)
    scene, result = seen((*DARK, BRIGHT[0], beside))
    assert result.blobs.polarity == "dark"
    assert len(result.poses) >= len(DARK) and off_m(result, scene.positions_m()).max() < 1e-3
    assert "beside_bright" in count_reasons(result.poses.refused)


@pytest.mark.parametrize("seed", first_of(0, 1))
def test_in_scenes_of_both_none_is_found_where_none_is(seed: int) -> None:
    scene = staged("bright_and_dark", seed)
    frame, truth = scene.taken()
    result = Pipeline(scene.rig, Steps()).run(frame)
    nearest = off_m(result, np.array([each.centre_m for each in truth.objects]))
    assert len(nearest) >= 4 and (nearest < 0.01).all()


def test_a_shadow_beside_a_bright_part_is_no_part_of_unknown_shape() -> None:
    """Seen from low above; the shadow of one of two cylinders was published."""
    scene = staged("two_cylinders", 61)
    frame, truth = scene.taken()
    result = Pipeline(scene.rig, Steps()).run(frame)
    assert len(result.poses) == 2 and off_m(result, truth.centres_m).max() < 1e-3


@pytest.mark.parametrize("seed", first_of(4, 5))
def test_dark_parts_that_are_not_found_are_spoken_of_where_others_are(seed: int) -> None:
    """Beside bright parts that were the rule one was lost without a word."""
    result = found("bright_and_dark", seed)
    assert sum(result.refused.values()) >= len(result.missed)


def test_a_dark_part_is_found_among_the_shadows_of_bright_ones() -> None:
    result = found("bright_and_dark", 8)
    assert {each.which: each.distance_m for each in result.found}[2] < 5e-4


def test_dark_parts_that_share_their_outlines_with_shadows_are_found_by_what_of_them_rises() -> None:
    """They were lost without a word: as a rule such outlines are shadows."""
    result = found("bright_and_dark", 11)
    assert {0, 1} <= {each.which for each in result.found} and len(result.ghosts_m) == 0
    assert max(each.distance_m for each in result.found) < 5e-4


def test_a_dark_solid_that_does_not_stand_on_the_table_of_the_bright_ones_is_not_lost_without_a_word() -> None:
    """By its outlines and a strip of its shadow, a lying cylinder was a box that hung in the air."""
    result = found("bright_and_dark", 205)
    assert len(result.found) >= 5 and sum(result.refused.values()) >= len(result.missed)


@pytest.mark.parametrize(("offset_m", "reason"), [(0.9, "off_table"), (None, "flat")])
def test_what_is_dark_and_no_body_is_refused_by_what_is_known_of_the_table(offset_m: float | None, reason: str) -> None:
    sheet = SolidFit("box", np.array([0.0, 0.0, 0.8]), np.eye(3), np.array([0.05, 0.04, 0.001]), 0.1, 1e-8 * np.eye(3))
    row = (disc(300, 200), disc(150, 200)), Located(np.array([300.0, 200]), np.array([150.0, 200]), 0.1, sheet)
    table = None if offset_m is None else Table(np.array([0.0, 0.0, -1.0]), offset_m, 1e-3)
    bright = Reading([], [], table)
    joint = joined(bright, Reading([row], [], table), bright, RIG)
    assert not joint.kept and not joint.unread and [each.reason for each in joint.for_good] == [reason]


@pytest.mark.parametrize(("above_m", "is_found"), [(0.0, True), (0.001, True), (0.02, False)])
def test_what_surely_stands_on_the_table_is_no_high_light_on_something_dark(above_m: float, is_found: bool) -> None:
    """As bright parts in a dark tray, which were not even spoken of; high lights are above it."""
    ball = SolidFit("sphere", np.array([0.0, 0.0, 0.88 - above_m]), np.eye(3), np.full(3, 0.04), 0.1, 1e-8 * np.eye(3))
    bright: Row = (disc(300, 200), disc(150, 200)), Located(np.zeros(2), np.zeros(2), 0.1, ball)
    dark: Row = (disc(300, 200, 80), disc(150, 200, 80)), Located(np.zeros(2), np.zeros(2), 0.1, None)
    table = Table(np.array([0.0, 0.0, -1.0]), 0.9, 1e-3)
    one, other = Reading([bright], [], table), Reading([dark], [], table)
    for chosen in (one, other):
        assert (bright in joined(one, other, chosen, RIG).kept) == is_found
    assert bright not in joined(replace(one, table=None), replace(other, table=None), one, RIG).kept


@pytest.mark.parametrize("is_kept", [True, False])
def test_what_may_be_a_high_light_is_refused_where_what_it_is_on_is_no_object(is_kept: bool) -> None:
    """Bright parts in a dark tray of which nothing was told were lost without a word."""
    at_m, sure = np.array([0.0, 0.0, 0.8]), 1e-8 * np.eye(3)
    ball = SolidFit("sphere", at_m, np.eye(3), np.full(3, 0.02), 0.1, sure)
    box = SolidFit("box", at_m, np.eye(3), np.full(3, 0.1), 0.1, sure) if is_kept else None
    bright: Row = (disc(300, 200), disc(150, 200)), Located(np.zeros(2), np.zeros(2), 0.1, ball)
    dark: Row = (disc(300, 200, 80), disc(150, 200, 80)), Located(np.zeros(2), np.zeros(2), 0.1, box)
    one, other = Reading([bright], [], None), Reading([dark], [], None)
    joint = joined(one, other, one, RIG)
    assert joint.kept == ([dark] if is_kept else [])
    assert [each.reason for each in (joint.aside if is_kept else joint.unread)] == ["half_lit"]
    assert not (joint.unread if is_kept else joint.aside)
