"""What outlines alone leave open, and the edges around them tell, in rendered scenes with exact truth."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from family_scenes import found
from marks import first_of, more
from rendered_solids import FROM_ABOVE, PARTS, PLACED, RIG, centre_m, rectified, solid_of, true_fit
from rendering import Cylinder, Scene, Solid

from stereo_pick.core.correspondence.feature import Feature
from stereo_pick.core.edges.adjusted import Adjusted
from stereo_pick.core.edges.growing import stretched_by
from stereo_pick.core.edges.hypotheses import Images
from stereo_pick.core.edges.standing import down_to
from stereo_pick.core.edges.supported import Supported
from stereo_pick.core.found_late import evident, last_look, pieces
from stereo_pick.core.found_late.last_look import LastLook, Seen, may_be_found
from stereo_pick.core.matches.left_over import Unread
from stereo_pick.core.pipeline import Steps
from stereo_pick.core.places.overlap import reach_into_each_other
from stereo_pick.core.places.position import BlobPair, Located
from stereo_pick.core.shapes import SolidFit
from stereo_pick.core.shapes.solids import Solids
from stereo_pick.core.shapes.table import Table

NORMAL = RIG.left.R @ PLACED.rotation[:, 2]
TABLE = Table(NORMAL, -float(NORMAL @ RIG.left.R @ PLACED.translation), 5e-4)

A_PART_IS_LIT = [("bright_and_dark", 150, 0), ("glossy", 146, 4)]
MERGED_WITH_A_SHADOW = [("dark_on_light", 151, 2), ("planks_and_prints", 158, 1)]
LIES_AMONG_ITS_SHADOWS = [
    ("tubes", 19, 1),
    ("bright_and_dark", 150, 1),
    ("tubes", 147, 2),
]
ITS_TOP_SEEMED_FLAT = [("glossy", 9, 2)]
SEEMED_TO_HANG = [("bright_and_dark", 212, 0)]
THE_VIEWS_SHOW_DIFFERENT_PIECES = [("occluded", 240, 1), ("elevation_30_to_90", 5, 5)]
ITS_ENDS_ARE_AS_BRIGHT_AS_ITS_SIDE = [("occluded", 255, 0), ("occluded", 279, 0)]
AS_ROUGH_AS_THE_OTHERS = [("table_edge", 17, 3), ("many_small", 1, 8)]
IT_RISES_FROM_A_PRINT = [("planks_and_prints", 16, 0)]
IT_SHARES_AN_OUTLINE_WITH_A_PRINT = [("planks_and_prints", 17, 1)]
ITS_HIGH_LIGHT_AND_SHADOW_HAVE_MORE_EDGES = [("glossy", 26, 0)]
HALF_OF_IT_SHOWS = [("light_differences", 209, 1)]


@pytest.mark.parametrize(
    ("family", "seed", "which"),
    [
        *first_of(*LIES_AMONG_ITS_SHADOWS),
        *first_of(*ITS_ENDS_ARE_AS_BRIGHT_AS_ITS_SIDE),
        *first_of(*AS_ROUGH_AS_THE_OTHERS),
        *first_of(
            *SEEMED_TO_HANG,
            *HALF_OF_IT_SHOWS,
            *A_PART_IS_LIT,
            *MERGED_WITH_A_SHADOW,
            *ITS_TOP_SEEMED_FLAT,
            *THE_VIEWS_SHOW_DIFFERENT_PIECES,
            *ITS_HIGH_LIGHT_AND_SHADOW_HAVE_MORE_EDGES,
            *IT_RISES_FROM_A_PRINT,
            *IT_SHARES_AN_OUTLINE_WITH_A_PRINT,
        ),
    ],
)
def test_what_was_refused_is_found_by_the_edges_around_it(family: str, seed: int, which: int) -> None:
    result = found(family, seed)
    assert {each.which: each.distance_m for each in result.found}[which] < 5e-4
    assert result.wrong == 0 and len(result.ghosts_m) == 0


def test_without_a_last_look_what_was_refused_stays_so() -> None:
    result = found("occluded", 240, Steps(method=Feature(last_look=False)))
    assert result.missed == [1] and sum(result.refused.values()) == 1
    assert result.wrong == 0


def test_what_shows_nearly_all_of_its_silhouette_is_not_replaced_by_what_shows_less() -> None:
    """A lying cylinder whose end is as bright as the table; one 43 mm longer, behind another part, has that one's
    edges for its rim."""
    result = found("occluded", 151)
    assert len(result.missed) == 0 and max(each.distance_m for each in result.found) < 1e-3


def lone(part: Solid, **light: Any) -> tuple[Images, BlobPair, Scene]:
    """The views of a lone part, and its outlines."""
    scene = Scene((part,), PLACED, **(light or {"ambient": 0.5}))
    pair = rectified(RIG, scene)
    blobs, _ = Steps().correspond(pair)
    return Images(pair), (blobs.left[0], blobs.right[0]), scene


def at(
    images: Images, blobs: BlobPair, besides: list[Located], others: list[SolidFit], shown: float = 0.0
) -> Seen | None:
    return LastLook(images, TABLE, [], besides).at(blobs, others, shown)


@pytest.mark.parametrize("part", first_of(*PARTS.values()), ids=PARTS.keys())
def test_a_part_is_found_once_and_only_where_no_other_is(part: Solid) -> None:
    images, blobs, scene = lone(part)
    seen = at(images, blobs, [], [])
    assert seen is not None
    (_, where), there = seen
    np.testing.assert_allclose(there.fit.centre_m, centre_m(RIG, scene, part), atol=5e-4)
    without_solid = replace(where, fit=None)
    assert at(images, blobs, [], [there.fit]) is None
    assert at(images, blobs, [where], []) is None
    assert at(images, blobs, [without_solid], []) is None
    elsewhere = replace(without_solid, left_px=where.left_px + 80)
    assert at(images, blobs, [elsewhere], []) is not None
    assert at(images, blobs, [], [], shown=1.1) is None


@pytest.mark.parametrize("part", PARTS.values(), ids=PARTS.keys())
def test_what_rises_is_found_by_its_surface_or_by_its_edges_alone(monkeypatch: pytest.MonkeyPatch, part: Solid) -> None:
    """Windows at the edge of a sheet of paper on which it stands tell nothing of its surface."""
    images, blobs, scene = lone(part)
    true = solid_of(RIG, scene, part).turning_about(TABLE.normal)
    risen: Any = SimpleNamespace(solids=lambda *_: [], blobs=blobs)
    by_edges = LastLook(images, TABLE, [], []).at_risen(risen, [])
    monkeypatch.setattr(last_look, "solids_around", lambda *_: [])
    assert LastLook(images, TABLE, [], []).at_risen(risen, []) is None
    risen.solids = lambda *_: [true]
    by_surface = LastLook(images, TABLE, [], []).at_risen(risen, [])
    for seen in (by_edges, by_surface):
        assert seen is not None
        np.testing.assert_allclose(seen[1].fit.centre_m, true.centre_m[0], atol=5e-4)


@pytest.mark.parametrize("by", first_of(0.1, -0.4))
def test_a_cylinder_of_which_the_rim_shows_ends_there(monkeypatch: pytest.MonkeyPatch, by: float) -> None:
    """All that is hinted at ends elsewhere: in the shadow of the end, or in its own."""
    part = Cylinder(0.0, 0.0, (0.03, 0.03, 0.06), yaw_rad=1.2, lying=True)
    images, blobs, scene = lone(part, lamps=(FROM_ABOVE,), ambient=0.3)
    wrong = stretched_by(solid_of(RIG, scene, part), [(2, -1.0)], np.array([by * part.size_m[2]]))
    monkeypatch.setattr(last_look, "standing_candidates", lambda *_: [wrong.turning_about(TABLE.normal)])
    monkeypatch.setattr(last_look, "solids_around", lambda *_: [])
    seen = at(images, blobs, [], [])
    assert seen is not None
    np.testing.assert_allclose(seen[1].fit.centre_m, centre_m(RIG, scene, part), atol=5e-4)
    monkeypatch.setattr(last_look, "ended", lambda *_: [])
    assert at(images, blobs, [], []) is None


def believed(solid: Solids) -> Supported:
    size_m, covariance = solid.size_m()[0], 1e-9 * np.eye(3)
    fit = SolidFit(solid.kind.name, solid.centre_m[0], solid.rotation[0], size_m, 0.05, covariance)
    return Supported(fit, 0.9, 0.05, believable=True)


@pytest.mark.parametrize("name", ["standing", "box"])
def test_what_ends_above_the_table_does_not_reach_down_to_it(monkeypatch: pytest.MonkeyPatch, name: str) -> None:
    """It stands on something else, as a part on a box does; its foot shows where it is."""
    images, blobs, scene = lone(PARTS[name])
    true = solid_of(RIG, scene, PARTS[name])
    below = replace(TABLE, offset_m=TABLE.offset_m + 0.02)
    longer = down_to(true, below)
    assert longer is not None
    upright, reaching = believed(true), believed(longer)
    monkeypatch.setattr(last_look, "nearly", lambda *_: [reaching])
    assert LastLook(images, below, [], []).at(blobs, []) is None
    monkeypatch.setattr(pieces, "shortened", lambda *_: [])
    assert LastLook(images, below, [], []).at(blobs, []) is not None
    monkeypatch.undo()
    monkeypatch.setattr(last_look, "nearly", lambda *_: [upright])
    assert LastLook(images, TABLE, [], []).at(blobs, []) is not None


@pytest.mark.parametrize("end", [-1.0, 1.0])
def test_what_goes_on_beyond_a_part_is_none_of_it(monkeypatch: pytest.MonkeyPatch, end: float) -> None:
    """A version that never landed published a box and tape beside it as one box, 7 mm off, and sure of it."""
    images, blobs, scene = lone(PARTS["box"])
    true = solid_of(RIG, scene, PARTS["box"])
    wider = believed(stretched_by(true, [(1, end)], np.array([0.02])))
    monkeypatch.setattr(last_look, "nearly", lambda *_: [wider])
    monkeypatch.setattr(LastLook, "_clear_ones", lambda _, __, free, ___: free)
    seen = at(images, blobs, [], [])
    assert seen is not None
    np.testing.assert_allclose(seen[1].fit.centre_m, true.centre_m[0], atol=5e-4)


def test_where_it_is_open_which_of_two_it_is_neither_is_taken(monkeypatch: pytest.MonkeyPatch) -> None:
    images, blobs, _ = lone(PARTS["box"])
    other = PARTS["box"].__class__(0.065, 0.0, (0.05, 0.036, 0.045), yaw_rad=0.4)
    there = [solid_of(RIG, Scene((part,), PLACED), part) for part in (PARTS["box"], other)]
    alike = [believed(solid) for solid in there]
    monkeypatch.setattr(last_look, "nearly", lambda *_: alike)
    monkeypatch.setattr(last_look, "adjusted", lambda fits, *_, **__: ([Adjusted(fits[0], 0.9, 1.0, True, 0.0)], TABLE))
    assert at(images, blobs, [], []) is None
    monkeypatch.setattr(last_look, "nearly", lambda *_: alike[:1])
    assert at(images, blobs, [], []) is not None


@pytest.mark.parametrize(("residual_px", "may_be_it"), [(0.1, True), (0.4, False)])
def test_a_part_may_be_another_solid_that_shows_as_much_only_where_edges_put_that(
    residual_px: float, may_be_it: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    images, blobs, _ = lone(PARTS["box"])
    true = solid_of(RIG, Scene((PARTS["box"],), PLACED), PARTS["box"])
    fit = SolidFit("box", true.centre_m[0], true.rotation[0], true.size_m()[0], 0.05, 1e-9 * np.eye(3))
    rival = replace(fit, centre_m=fit.centre_m + 0.01 * true.rotation[0, :, 0], residual_px=residual_px)
    monkeypatch.setattr(last_look, "nearly", lambda *_: [Supported(rival, 0.8, 0.05, believable=True)])
    monkeypatch.setattr(last_look, "adjusted", lambda fits, *_, **__: ([Adjusted(fits[0], 0.8, 0.9, True, 0.1)], TABLE))
    another, off_m = LastLook(images, TABLE, [], []).instead(blobs, [], Adjusted(fit, 0.75, 1.0, True, 0.15))
    assert another is None
    assert np.linalg.norm(off_m) == pytest.approx(0.01 if may_be_it else 0.0)


def test_what_shows_its_creases_is_taken_before_what_shows_more_of_its_silhouette(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """A box of which another part's edge is taken for an end: 5 mm off."""
    images, blobs, _ = lone(PARTS["box"])
    scene = Scene((PARTS["box"],), PLACED)
    true = solid_of(RIG, scene, PARTS["box"])
    fit = SolidFit("box", true.centre_m[0], true.rotation[0], true.size_m()[0], 0.05, 1e-9 * np.eye(3))
    longer = replace(fit, centre_m=fit.centre_m + true.rotation[0, :, 0] * 0.005, size_m=fit.size_m + [0.01, 0, 0])
    several = [Supported(each, 0.9, 0.05, believable=True) for each in (longer, fit)]
    shows = {longer: (0.82, 0.6), fit: (0.75, 0.9)}
    monkeypatch.setattr(last_look, "nearly", lambda *_: several)
    monkeypatch.setattr(pieces, "shortened", lambda *_: [])
    monkeypatch.setattr(
        last_look, "adjusted", lambda fits, *_, **__: ([Adjusted(fits[0], *shows[fits[0]], True, 0.0)], TABLE)
    )
    found = at(images, blobs, [], [])
    assert found is not None and found[1].fit is fit


@pytest.mark.parametrize(("shown_longer", "is_longer"), [(0.85, True), (0.79, False)])
def test_a_longer_one_that_is_clear_as_well_is_taken_if_it_shows_as_much(
    shown_longer: float, is_longer: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A box before a rail, of which an edge may be the box's end: 5 mm off."""
    images, blobs, _ = lone(PARTS["box"])
    true = solid_of(RIG, Scene((PARTS["box"],), PLACED), PARTS["box"])
    fit = SolidFit("box", true.centre_m[0], true.rotation[0], true.size_m()[0], 0.05, 1e-9 * np.eye(3))
    longer = replace(fit, centre_m=fit.centre_m + true.rotation[0, :, 0] * 0.005, size_m=fit.size_m + [0.01, 0, 0])
    one, other = (Supported(each, 0.85, 0.05, believable=True) for each in (fit, longer))
    shows = {fit: 0.85, longer: shown_longer}
    monkeypatch.setattr(last_look, "nearly", lambda *_: [one])
    monkeypatch.setattr(Images, "longer", lambda *_: other)
    monkeypatch.setattr(pieces, "shortened", lambda *_: [])
    monkeypatch.setattr(
        last_look, "adjusted", lambda fits, *_, **__: ([Adjusted(fits[0], shows[fits[0]], 0.9, True, 0.0)], TABLE)
    )
    found = at(images, blobs, [], [])
    assert found is not None and found[1].fit is (longer if is_longer else fit)


@pytest.mark.parametrize(
    ("shown", "off_m", "sigma_m", "is_found"),
    [
        (0.76, 0.005, 1e-4, True),
        (0.6, 0.0, 1e-4, True),
        (0.6, 0.005, 1e-4, False),
        (0.6, 0.0, 4e-3, False),
        (0.45, 0.0, 1e-4, False),
    ],
)
def test_half_of_a_ball_is_enough_only_where_it_lies_on_the_table_by_itself(
    shown: float, off_m: float, sigma_m: float, is_found: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """off_m: by how much its edges alone put it higher; sigma_m: how well they know."""
    part = PARTS["sphere"]
    images, blobs, scene = lone(part)
    on_it = SolidFit("sphere", centre_m(RIG, scene, part), np.eye(3), np.array(part.size_m), 0.05, 1e-8 * np.eye(3))
    alone = replace(on_it, centre_m=on_it.centre_m + off_m * NORMAL, covariance=sigma_m**2 * np.eye(3))
    monkeypatch.setattr(last_look, "nearly", lambda *_: [Supported(on_it, shown, 0.05, believable=True)])
    on_a_table, without = (([Adjusted(fit, shown, 1.0, False, 0.2)], TABLE) for fit in (on_it, alone))
    monkeypatch.setattr(last_look, "adjusted", lambda *_, **__: on_a_table)
    monkeypatch.setattr(evident, "adjusted", lambda *_, **__: without)
    assert (at(images, blobs, [], []) is not None) == is_found


def test_what_both_views_show_whole_is_looked_for_first_the_largest_first_and_then_what_one_does() -> None:
    _, (left, right), _ = lone(PARTS["box"])
    small = replace(left, contour_px=left.contour_px / 3)
    cut, merged = replace(right, fault="cut_by_border"), replace(right, fault="merged")
    without_edges = replace(left, sharpness=np.empty(0))
    refused = [
        Unread("half_lit", small, right),
        Unread("merged", left, merged),
        Unread("merged", left, cut),
        Unread("merged", without_edges, right),
        Unread("left_only", left, None),
        Unread("left_only", without_edges, None),
        Unread("cut_by_border", None, cut),
        Unread("merged", None, merged),
        Unread("beside_bright", replace(left, fault="beside_bright"), None),
        Unread("beside_bright", replace(small, fault="beside_bright"), replace(right, fault="beside_bright")),
        *(Unread(reason, left, right) for reason in ("ambiguous", "out_of_focus", "saturated")),
    ]
    alone = sorted([refused[4], refused[7]], key=lambda each: -sum(blob.area_px2 for blob in each[1:] if blob))
    assert may_be_found(refused) == [refused[1], refused[0], refused[9], *alone]


@pytest.mark.parametrize(("apart_m", "reach"), [(0.027, True), (0.034, True), (0.05, False), (0.06, False)])
def test_bodies_reach_into_each_other_where_their_centres_do_not(apart_m: float, reach: bool) -> None:
    one = SolidFit("box", np.array([0.0, 0.0, 1.0]), np.eye(3), np.full(3, 0.05), 0.05, 1e-9 * np.eye(3))
    other = replace(one, centre_m=one.centre_m + [apart_m, 0.0, 0.0])
    assert reach_into_each_other(one, other) is reach
    assert not one.overlaps(other)


@more
def test_what_is_printed_on_planks_is_looked_for_and_not_found(monkeypatch: pytest.MonkeyPatch) -> None:
    looks: list[Seen | None] = []
    look = LastLook.at_refused

    def noted(self: LastLook, *args: Any) -> Seen | None:
        looks.append(look(self, *args))
        return looks[-1]

    monkeypatch.setattr(LastLook, "at_refused", noted)
    result = found("planks_and_prints", 7)
    assert len(looks) >= 3 and result.wrong == 0 and len(result.ghosts_m) == 0


@pytest.mark.parametrize("base_m", first_of(0.06, 0.05))
def test_a_body_seen_above_the_table_is_not_one_that_reaches_down_to_it(
    monkeypatch: pytest.MonkeyPatch, base_m: float
) -> None:
    """Half of its silhouette is that of a longer one, too; a lit top says nothing against that, but a body that ends
    above the table does, whatever it was taken for."""
    part = Cylinder(0.0, 0.0, (0.04, 0.04, 0.055), base_m=base_m)
    images, blobs, scene = lone(part)
    look, body = LastLook(images, TABLE, [], []), true_fit(RIG, scene, part)
    cap = replace(body, size_m=np.array([0.04, 0.04, 0.005]))
    for taken_for in (body, cap, None):
        assert look.at_refused(Unread("off_table", *blobs, taken_for), []) is None
    monkeypatch.setattr(pieces, "shortened", lambda *_: [])
    assert look.at_refused(Unread("off_table", *blobs, body), []) is None
    for taken_for in (cap, None):
        longer = look.at_refused(Unread("off_table", *blobs, taken_for), [])
        assert longer is not None
        np.testing.assert_allclose(longer[1].fit.size_m, (0.04, 0.04, base_m + 0.055), atol=5e-4)
