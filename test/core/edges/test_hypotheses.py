"""Which longer solids speak against a shorter one: those that have the edges that it lacks."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from rendered_solids import half_lit_scene, rectified, solid_of
from rendering import Box, Cylinder, HexPrism, Solid, hex_prism_size
from rendering.rigs import table_before
from rigs import RIGS
from solid_outlines import contour_px

from stereo_pick.core.edges.hypotheses import Images
from stereo_pick.core.edges.supported import carries
from stereo_pick.core.frames import RectifiedPair
from stereo_pick.core.shapes import Outline, SolidFit
from stereo_pick.core.shapes.fitting import Pair

RIG = RIGS["thesis"]
TABLE = table_before(RIG, 0.9, elevation_deg=50)
TOWARDS_CAMERAS = TABLE.rotation.T @ (0.0, 1.0, 0.0)
PART = Cylinder(0.0, 0.0, (0.04, 0.04, 0.05))


def before(distance_m: float) -> Solid:
    """A low box that stands across in front of the part."""
    x, y = TOWARDS_CAMERAS[:2] / np.linalg.norm(TOWARDS_CAMERAS[:2]) * distance_m
    return Box(float(x), float(y), (0.1, 0.01, 0.01), yaw_rad=float(np.arctan2(y, x)) + np.pi / 2)


@pytest.mark.parametrize("distance_m", [0.04, 0.05, 0.06])
def test_the_edges_of_a_neighbour_make_no_whole_body_longer(distance_m: float) -> None:
    scene = half_lit_scene([PART, before(distance_m)], TABLE, 0.3)
    assert Images(rectified(RIG, scene)).contradicts(solid_of(RIG, scene, PART)) is None


@pytest.mark.parametrize("height_m", [0.001, 0.01, 0.02, 0.03])
@pytest.mark.parametrize("sides", [0.05, 0.1, 0.15])
def test_a_piece_of_a_body_is_told_by_the_edges_beyond_it(height_m: float, sides: float) -> None:
    scene = half_lit_scene([PART], TABLE, sides)
    piece = solid_of(RIG, scene, PART, height_m=height_m)
    longer = Images(rectified(RIG, scene)).contradicts(piece)
    assert longer is not None and longer.fit.size_m[2] > PART.height_m - 1e-3


def test_where_no_view_shows_an_edge_nothing_is_believed() -> None:
    scene = half_lit_scene([PART], TABLE, 0.1)
    pair = rectified(RIG, scene)
    dark = replace(pair, left=np.zeros_like(pair.left), right=np.zeros_like(pair.right))
    found = Images(dark).locked(solid_of(RIG, scene, PART).turning_freely())
    assert not found.believable and not found.raises_doubt and found.support == 0


def broken_outlines(part: Solid, hidden: float) -> tuple[Images, Pair]:
    """A part, evenly lit, and its outlines, of which this share at the bottom is not trusted."""
    scene = half_lit_scene([part], TABLE, 0.4)
    hull_m = scene.left_T_table.apply(part.hull_m()) @ RIG.left.R.T
    outlines = []
    for eye_m, camera in zip(RIG.eyes_m, (RIG.left, RIG.right)):
        contour = contour_px(hull_m - eye_m, camera)
        outlines.append(Outline.from_contour(contour, contour[:, 1] < np.quantile(contour[:, 1], 1 - hidden)))
    return Images(rectified(RIG, scene)), (outlines[0], outlines[1])


@pytest.mark.parametrize("hidden", [0.2, 0.3])
@pytest.mark.parametrize("yaw_rad", [0.0, 0.3, 0.8])
def test_six_sides_are_found_by_their_edges_where_the_outline_is_broken(hidden: float, yaw_rad: float) -> None:
    part = HexPrism(0.0, 0.0, hex_prism_size(0.05, 0.04), yaw_rad=yaw_rad)
    images, outlines = broken_outlines(part, hidden)
    (best,) = images.best([[outlines]])
    assert best is not None and best.fit.kind == "hexprism" and best.is_exact
    assert np.abs(np.sort(best.fit.size_m)[0] - 0.04) < 1e-3


def test_each_object_gets_its_own_solid_and_one_of_which_nothing_can_be_read_none() -> None:
    images, outlines = broken_outlines(HexPrism(0.0, 0.0, hex_prism_size(0.05, 0.04)), 0.2)
    nothing, one, other, nothing_either = images.best([[], [outlines], [outlines, outlines], []])
    assert nothing is None and nothing_either is None
    assert one is not None and one is other and one.fit.kind == "hexprism"


@pytest.mark.parametrize("part", [PART, Box(0.0, 0.0, (0.05, 0.04, 0.03), yaw_rad=0.4)])
def test_what_another_kind_explains_has_no_six_sides(part: Solid) -> None:
    images, outlines = broken_outlines(part, 0.2)
    (best,) = images.best([[outlines]])
    assert best is not None and best.fit.kind != "hexprism"


@pytest.mark.parametrize(("off_px", "noise_px"), [(0.05, 0.1), (0.15, 0.15), (0.3, 0.2)])
def test_edges_are_as_far_off_as_off_most_solids(off_px: float, noise_px: float) -> None:
    """Of three, one is nothing that it seems; no less than noise is expected, and no more than twice that forgiven."""
    images = Images(RectifiedPair(np.zeros((480, 640), np.uint8), np.zeros((480, 640), np.uint8), RIG))
    fits = [SolidFit("sphere", np.zeros(3), np.eye(3), np.ones(3), each, np.eye(3)) for each in (off_px, off_px, 9.0)]
    assert images.as_rough_as(fits).noise_px == pytest.approx(noise_px)
    assert images.as_rough_as([]) is images


def test_what_lies_off_its_edges_by_what_is_usual_needs_no_more_of_them() -> None:
    assert carries(0.7, 0.1) and not carries(0.7, 0.15)
    assert carries(0.7, 0.15, noise_px=0.15) and not carries(0.7, 0.31, noise_px=0.15)
