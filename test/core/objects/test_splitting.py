"""Touching parts taken apart: unions of convex shapes whose parts are known."""

from __future__ import annotations

from collections.abc import Sequence

import cv2
import numpy as np
import pytest

from stereo_pick.core.arrays import Floats
from stereo_pick.core.objects import Blob
from stereo_pick.core.objects.blob import CUT
from stereo_pick.core.objects.splitting import divisions, split

MAX_CONCAVITY = 0.15
FINE = 8
MIDDLE = np.array([120.0, 120.0])


def disc(x_px: float, y_px: float, radius_px: float) -> Floats:
    angle = np.linspace(0, 2 * np.pi, 120, endpoint=False)
    return np.stack([x_px + radius_px * np.cos(angle), y_px + radius_px * np.sin(angle)], axis=1)


def rectangle(x_px: float, y_px: float, length_px: float, width_px: float, turn_deg: float = 0.0) -> Floats:
    corners = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)]) * (length_px / 2, width_px / 2)
    c, s = np.cos(np.deg2rad(turn_deg)), np.sin(np.deg2rad(turn_deg))
    return corners @ np.array([[c, s], [-s, c]]) + (x_px, y_px)


def union(shapes: Sequence[Floats]) -> Blob:
    """The outline of shapes (K, 2) together, sharp all around."""
    mask = np.zeros((240 * FINE, 240 * FINE), np.uint8)
    for shape in shapes:
        cv2.fillPoly(mask, [np.round(shape * FINE).astype(np.int32)], 1)
    contours, _ = cv2.findContours(mask, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
    (contour,) = contours
    points = contour[::FINE, 0] / FINE
    return Blob(points, 100.0, fault="merged", sharpness=np.full(len(points), 0.9))


UNIONS = {
    "two discs": [disc(100, 120, 22), disc(140, 124, 22)],
    "two discs of two sizes": [disc(100, 120, 26), disc(138, 110, 16)],
    "three discs in a row": [disc(80, 120, 20), disc(118, 122, 20), disc(156, 118, 20)],
    "three discs in a triangle": [disc(100, 110, 20), disc(136, 110, 20), disc(118, 141, 20)],
    "a rectangle lying across another": [rectangle(110, 120, 60, 24), rectangle(128, 95, 24, 40)],
    "a turned rectangle at a corner": [rectangle(95, 120, 50, 34), rectangle(138, 112, 50, 34, 35)],
    "a disc and a rectangle": [disc(100, 120, 22), rectangle(142, 120, 46, 30, 20)],
}


@pytest.mark.parametrize("name", UNIONS)
def test_a_union_is_taken_apart_into_its_parts(name: str) -> None:
    shapes = UNIONS[name]
    whole = union(shapes)
    parts = split(whole, MAX_CONCAVITY)
    assert len(parts) == len(shapes)
    for shape in shapes:
        part = min(parts, key=lambda part: float(np.linalg.norm(part.centroid_px - shape.mean(axis=0))))
        size_px = np.sqrt(cv2.contourArea(shape.astype(np.float32)))
        assert np.linalg.norm(part.centroid_px - shape.mean(axis=0)) < 0.12 * size_px
        assert part.concavity <= MAX_CONCAVITY
    assert sum(part.area_px2 for part in parts) == pytest.approx(whole.area_px2, rel=1e-6)


@pytest.mark.parametrize("name", UNIONS)
def test_points_are_of_the_outline_or_of_a_cut_and_those_of_a_cut_are_not_sharp(name: str) -> None:
    whole = union(UNIONS[name])
    outline = {tuple(point) for point in whole.contour_px}
    parts = split(whole, MAX_CONCAVITY)
    for part in parts:
        own = np.array([tuple(point) in outline for point in part.contour_px])
        assert (part.sharpness[own] == 0.9).sum() >= own.sum() - 2 * len(parts)
        assert (part.sharpness[~own] == CUT).all() and (~own).any()
    seen = {tuple(point) for part in parts for point in part.contour_px[part.sharpness > 0]}
    assert seen == outline


@pytest.mark.parametrize(
    "shape",
    [disc(120, 120, 25), rectangle(120, 120, 70, 30, 20), rectangle(120, 120, 90, 12), disc(120, 120, 6)],
    ids=["disc", "rectangle", "bar", "small disc"],
)
@pytest.mark.parametrize("max_concavity", [0.05, MAX_CONCAVITY])
def test_one_convex_part_is_never_cut(shape: Floats, max_concavity: float) -> None:
    whole = union([shape])
    assert split(whole, max_concavity) == [whole]


def crescent() -> Floats:
    """What is lit of a ball from the side: no cut makes convex parts of it."""
    angle = np.linspace(-np.pi / 2, np.pi / 2, 80)
    outer = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    return MIDDLE + 30 * np.concatenate([outer, (outer * (0.55, 1))[::-1]])


def star(arms: int = 9) -> Floats:
    angle = np.linspace(0, 2 * np.pi, 2 * arms, endpoint=False)
    return MIDDLE + np.tile([45.0, 20.0], arms)[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=1)


@pytest.mark.parametrize("shape", [crescent(), star()], ids=["crescent", "star"])
def test_what_no_cut_explains_stays_whole(shape: Floats) -> None:
    whole = union([shape])
    assert whole.concavity > MAX_CONCAVITY
    assert split(whole, MAX_CONCAVITY) == [whole]


OVERLAPS = {
    **{name: shapes for name, shapes in UNIONS.items() if len(shapes) == 2},
    "a disc before a corner": [rectangle(100, 120, 60, 50, 15), disc(132, 136, 18)],
    "a disc before a long side": [rectangle(110, 110, 80, 40), disc(112, 136, 18)],
}


@pytest.mark.parametrize("name", OVERLAPS)
def test_one_of_the_divisions_is_the_true_one(name: str) -> None:
    """Each part has the whole of its own outline, up to what the other part hides."""
    shapes = OVERLAPS[name]
    whole = union(shapes)
    assert any(
        all(own_share(part, shape) > 0.9 for part, shape in zip(order, shapes))
        for each in divisions(whole)
        for order in (each.parts, each.parts[::-1])
    )


def own_share(part: Blob, shape: Floats) -> float:
    """The share of a part's points off the cut that lie on a shape's outline."""
    line = shape.astype(np.float32)
    off_px = [
        abs(cv2.pointPolygonTest(line, (float(x), float(y)), True)) for x, y in part.contour_px[part.sharpness > 0]
    ]
    return float((np.array(off_px) < 0.5).mean())


@pytest.mark.parametrize("name", OVERLAPS)
def test_divisions_are_of_the_whole_and_differ(name: str) -> None:
    whole = union(OVERLAPS[name])
    found = divisions(whole)
    assert [each.unexplained for each in found] == sorted(each.unexplained for each in found)
    for each in found:
        assert sum(part.area_px2 for part in each.parts) == pytest.approx(whole.area_px2, rel=1e-6)
    ends = [{tuple(part.contour_px[i]) for part in each.parts[:1] for i in (0, -1)} for each in found]
    assert all(one != other for k, one in enumerate(ends) for other in ends[:k])


@pytest.mark.parametrize("shape", [disc(120, 120, 25), rectangle(120, 120, 70, 30, 20)], ids=["disc", "rectangle"])
def test_a_convex_part_has_no_division(shape: Floats) -> None:
    assert not divisions(union([shape]))


def test_without_sharpness_nothing_can_be_cut() -> None:
    outline = union(UNIONS["two discs"]).contour_px
    whole = Blob(outline, 100.0)
    assert split(whole, MAX_CONCAVITY) == [whole]
