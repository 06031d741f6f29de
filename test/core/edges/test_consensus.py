"""What most edges around a place agree on, in rendered scenes with exact truth."""

from __future__ import annotations

import numpy as np
import pytest
from rendered_solids import PARTS, PLACED, RIG, rectified, solid_of
from rendering import HexPrism, Scene, Solid, hex_prism_size

from stereo_pick.core.arrays import Bools, Floats
from stereo_pick.core.edges.consensus import solids_around
from stereo_pick.core.edges.edge_map import EdgeMap
from stereo_pick.core.edges.edgels import edgels_around
from stereo_pick.core.edges.hypotheses import Images
from stereo_pick.core.frames import RectifiedPair
from stereo_pick.core.shapes.sight import normalized
from stereo_pick.core.shapes.solids import Solids
from stereo_pick.core.shapes.table import Table

NORMAL = RIG.left.R @ PLACED.rotation[:, 2]
TABLE = Table(NORMAL, -float(NORMAL @ RIG.left.R @ PLACED.translation), 5e-4)
ALL = {**PARTS, "hexprism": HexPrism(0.0, 0.01, hex_prism_size(0.045, 0.04), yaw_rad=0.3)}
TABLE_GREY = 0.2
REACH_PX = 60.0


def seen(part: Solid, off_px: float = 0.0) -> tuple[Images, Solids, list[Floats]]:
    """The views of a lone part, what it is, and places so far beside its centre in both views."""
    scene = Scene((part,), PLACED, TABLE_GREY, ambient=0.5)
    solid = solid_of(RIG, scene, part)
    places = [each.P @ np.append(solid.centre_m[0], 1.0) for each in (RIG.left, RIG.right)]
    return Images(rectified(RIG, scene)), solid, [place[:2] / place[2] + off_px for place in places]


@pytest.mark.parametrize("off_px", [0.0, 7.0])
@pytest.mark.parametrize("part", ALL.values(), ids=ALL.keys())
def test_a_part_is_among_them_wherever_in_it_they_are_looked_for(part: Solid, off_px: float) -> None:
    images, true, places_px = seen(part, off_px)
    found = [each for each in solids_around(images.maps, RIG, TABLE, places_px, REACH_PX) if each.kind is true.kind]
    off_m = [np.linalg.norm(each.centre_m - true.centre_m) for each in found]
    half_off_m = [np.abs(np.sort(each.half_m) - np.sort(true.half_m)).max() for each in found]
    assert np.maximum(off_m, half_off_m).min() < 1.5e-3


@pytest.mark.parametrize("off_px", [0.0, 7.0])
@pytest.mark.parametrize("part", ALL.values(), ids=ALL.keys())
def test_brought_onto_its_edges_the_best_of_them_is_the_part(part: Solid, off_px: float) -> None:
    images, true, places_px = seen(part, off_px)
    found = images.all_locked(solids_around(images.maps, RIG, TABLE, places_px, REACH_PX), TABLE)
    best = max((each for each in found if each.is_exact), key=lambda each: each.score)
    assert best.fit.kind == true.kind.name
    np.testing.assert_allclose(best.fit.centre_m, true.centre_m[0], atol=5e-4)


@pytest.mark.parametrize("part", ALL.values(), ids=ALL.keys())
def test_by_the_edges_of_its_upper_half_alone_a_part_is_among_them(part: Solid) -> None:
    """Whatever edges lie where its foot would be."""
    images, true, places_px = seen(part)
    several = solids_around(images.maps, RIG, TABLE, places_px, REACH_PX, in_shadow=True)
    off_m = [np.linalg.norm(each.centre_m - true.centre_m) for each in several if each.kind is true.kind]
    assert min(off_m) < 1.5e-3


def test_all_of_them_touch_the_table() -> None:
    images, _, places_px = seen(PARTS["box"])
    found = solids_around(images.maps, RIG, TABLE, places_px, REACH_PX)
    assert len(found) > 4
    assert max(abs(TABLE.under(each)[0][0]) for each in found) < 1e-9


def test_the_same_images_give_the_same_solids() -> None:
    images, _, places_px = seen(PARTS["lying"])
    one, other = (solids_around(images.maps, RIG, TABLE, places_px, REACH_PX) for _ in range(2))
    assert [each.kind for each in one] == [each.kind for each in other]
    np.testing.assert_array_equal([each.centre_m for each in one], [each.centre_m for each in other])


def test_an_empty_table_has_none() -> None:
    images = Images(rectified(RIG, Scene((), PLACED, TABLE_GREY, ambient=0.5)))
    middle = np.array([320.0, 240.0])
    assert solids_around(images.maps, RIG, TABLE, [middle, middle], REACH_PX) == []


def test_edges_that_are_all_parallel_are_no_error() -> None:
    """Of many guesses the systems are singular: no solution, or any."""
    stripes = np.tile((np.arange(640) // 16 % 2 * 120 + 60).astype(np.uint8), (480, 1))
    images, middle = Images(RectifiedPair(stripes, stripes, RIG, 0)), np.array([320.0, 240.0])
    for each in solids_around(images.maps, RIG, TABLE, [middle, middle], REACH_PX):
        assert np.isfinite(each.centre_m).all() and np.isfinite(each.half_m).all()


@pytest.mark.parametrize("view", [0, 1])
def test_edges_of_something_else_in_one_view_do_not_count(view: int) -> None:
    images, _, places_px = seen(PARTS["sphere"])
    lens = (RIG.left, RIG.right)[view]
    middle = normalized(places_px[view][None], lens)[0]

    def all_of_it(places: Floats, i: int) -> Bools:
        assert np.abs(places).max() < 1  # normalized
        return np.full(len(places), i == view)

    def nothing_of_it(places: Floats, i: int) -> Bools:
        return np.full(len(places), False) if i != view else places[:, 0] > middle[0] + 1

    assert solids_around(images.maps, RIG, TABLE, places_px, REACH_PX, all_of_it) == []
    assert len(solids_around(images.maps, RIG, TABLE, places_px, REACH_PX, nothing_of_it)) > 0


def test_beyond_the_horizon_there_is_no_table() -> None:
    """The same edges, of a table that the camera sees from below."""
    images, _, places_px = seen(PARTS["sphere"])
    turned_away = Table(-TABLE.normal, TABLE.offset_m, TABLE.sigma_m)
    assert solids_around(images.maps, RIG, TABLE, places_px, REACH_PX) != []
    assert solids_around(images.maps, RIG, turned_away, places_px, REACH_PX) == []


def test_places_at_the_border_and_reaches_beyond_it_are_no_error() -> None:
    images, _, _ = seen(PARTS["sphere"])
    corner = np.array([0.0, 0.0])
    solids_around(images.maps, RIG, TABLE, [corner, corner], 50_000.0)


@pytest.mark.parametrize("inside_is", [40.0, 200.0])
def test_rays_find_the_edge_all_around_whichever_side_is_brighter(inside_is: float) -> None:
    """A disc of 20 px, from a place off its middle: edges 20 px from its middle, normals away from it."""
    y, x = np.mgrid[:120, :160]
    off = np.hypot(x - 80, y - 60) - 20
    image = 120 + (inside_is - 120) * np.clip(0.5 - off, 0, 1)
    view = EdgeMap.of(image.astype(np.float32), RIG.left)
    edgels = edgels_around(view, np.array([86.0, 57.0]), 45.0)
    from_middle = edgels.points - [80.0, 60.0]
    radius = np.linalg.norm(from_middle, axis=2)
    assert edgels.found.any(axis=1).all() and edgels.found.sum() == len(edgels.found)
    np.testing.assert_allclose(radius[edgels.found], 20.0, atol=0.8)
    outward = (edgels.normals * from_middle).sum(axis=2) / radius
    assert outward[edgels.found].min() > 0.99
