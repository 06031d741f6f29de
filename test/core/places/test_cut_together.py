"""Objects cut as both views together say, on drawn outlines whose parts are known."""

from __future__ import annotations

from collections.abc import Sequence

import cv2
import numpy as np
import pytest

from stereo_pick.core.arrays import Floats
from stereo_pick.core.matches.similarity import Similarity
from stereo_pick.core.objects import Blob
from stereo_pick.core.places.cut_together import Way, ways_to_cut

SIMILARITY = Similarity(1.5, 0.03, 1.5, (0.0, 200.0))
FINE = 8
SHIFT_PX = 60.0  # of all in the right view

Disc = tuple[float, float, float]


def outline(discs: Sequence[Disc]) -> Blob:
    """Of discs (x, y, radius) together, sharp all around."""
    mask = np.zeros((300 * FINE, 300 * FINE), np.uint8)
    for x, y, radius in discs:
        cv2.circle(mask, (round(x * FINE), round(y * FINE)), round(radius * FINE), 1, cv2.FILLED)
    contours, _ = cv2.findContours(mask, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
    (contour,) = contours
    points = contour[::FINE, 0] / FINE
    return Blob(points, 100.0, fault="merged", sharpness=np.full(len(points), 0.9))


def seen(discs: Sequence[Disc], closer_px: float = 0.0) -> list[Disc]:
    """Discs in the right view, where the second one is so much closer to the first."""
    return [(x - SHIFT_PX - closer_px * (k == 1), y, radius) for k, (x, y, radius) in enumerate(discs)]


def centres(way: Way) -> list[Floats]:
    """Of both parts in the left view, and in the right one: (2, 2) each."""
    return [np.array([pair[side].centroid_px for pair in way.pairs]) for side in (0, 1)]


SCENES: dict[str, list[Disc]] = {
    "one beside the other": [(140, 120, 22), (180, 124, 22)],
    "one behind the other": [(140, 120, 24), (152, 152, 20)],
    "a small one": [(140, 120, 26), (178, 110, 15)],
}


@pytest.mark.parametrize("name", SCENES)
def test_what_touches_in_both_views_is_cut_where_it_touches(name: str) -> None:
    discs = SCENES[name]
    left, right = outline(discs), outline(seen(discs, closer_px=2.0))
    way = ways_to_cut([left], [right], SIMILARITY, alike=True)[0]
    assert way.whole == way.cut == {left, right}
    for found, true in zip(centres(way), (discs, seen(discs, closer_px=2.0))):
        order = np.argsort(found[:, 0])
        np.testing.assert_allclose(found[order], np.array(sorted(true))[:, :2], atol=3.5)
    assert (np.diff(centres(way)[0], axis=0) * np.diff(centres(way)[1], axis=0) > 0)[0, 0]  # not exchanged


@pytest.mark.parametrize("name", SCENES)
@pytest.mark.parametrize("mirrored", [False, True])
def test_what_touches_in_one_view_is_cut_as_the_other_one_shows(name: str, mirrored: bool) -> None:
    one, other = SCENES[name]
    alone = [outline([one]), outline([(other[0] + 8, *other[1:])])]
    clump = outline(seen([one, other]))
    way = ways_to_cut(alone, [clump], SIMILARITY, alike=True)[0]
    if mirrored:
        wide = Similarity(1.5, 0.03, 1.5, (-200.0, 0.0))
        way = ways_to_cut([clump], alone, wide, alike=True)[0]
    assert way.whole == {*alone, clump} and way.cut == {clump}
    whole = {part: its for part, its in way.wholes}
    assert [whole[blob] for blob in alone] == [[blob] for blob in alone]
    for pair in way.pairs:
        part, partner = pair if mirrored else pair[::-1]
        assert part in whole[clump]
        assert abs(part.centroid_px[1] - partner.centroid_px[1]) < 3.5


def test_two_objects_in_each_view_need_no_cut() -> None:
    left = [outline([disc]) for disc in SCENES["a small one"]]
    right = [outline([disc]) for disc in seen(SCENES["a small one"])]
    assert ways_to_cut(left, right, SIMILARITY, alike=True) == []


def test_what_has_other_rows_is_not_cut_together() -> None:
    (x, y, radius), other = SCENES["one beside the other"]
    left = outline([(x, y, radius), other])
    assert (
        ways_to_cut(
            [left], [outline(seen([(x, y + 60, radius), (other[0], y + 64, other[2])]))], SIMILARITY, alike=True
        )
        == []
    )


def test_one_part_that_looks_alike_will_do_where_the_other_one_is_lit_in_part() -> None:
    """The light shows the upper half of the nearer one in the right view, and all of it in the left one."""
    near, far = SCENES["one behind the other"]
    clump = outline([near, far])
    x, y, radius = seen([near])[0]
    lit = outline([(x, y - radius / 2, radius / 2)])
    alone = outline([(far[0] - SHIFT_PX + 30, *far[1:])])
    assert ways_to_cut([clump], [lit, alone], SIMILARITY, alike=True) == []
    way = ways_to_cut([clump], [lit, alone], SIMILARITY, alike=False)[0]
    assert way.whole == {clump, lit, alone} and way.cut == {clump}
    part = {right: left for left, right in way.pairs}[alone]
    np.testing.assert_allclose(part.centroid_px, far[:2], atol=4)


def test_both_parts_must_not_be_unlike() -> None:
    clump = outline(SCENES["one behind the other"])
    halves = [outline([(x - SHIFT_PX, y - r / 2, r / 2)]) for x, y, r in ((140, 120, 24), (190, 152, 20))]
    assert ways_to_cut([clump], halves, SIMILARITY, alike=False) == []
