"""A solid off its edges by what a pattern moves them is known by the pattern, if it has one, and is whole."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from family_scenes import found
from marks import first_of
from rendered_solids import PLACED, RIG, rectified, solid_of
from rendering import Cylinder, Scene

from stereo_pick.core.arrays import Floats
from stereo_pick.core.edges.hypotheses import Images
from stereo_pick.core.edges.supported import Supported
from stereo_pick.core.found_late.patterned import near_outlines, patterned
from stereo_pick.core.shapes import Outline, SolidFit

LYING = Cylinder(0.0, 0.0, (0.05, 0.05, 0.09), yaw_rad=0.5, lying=True, texture=1.0)
PLAIN = replace(LYING, texture=0.0)


def images_and_fit(part: Cylinder) -> tuple[Images, SolidFit]:
    scene = Scene((part,), PLACED, ambient=0.5)
    solid = solid_of(RIG, scene, part)
    fit = SolidFit("cylinder", solid.centre_m[0], solid.rotation[0], solid.size_m()[0], 0.3, 1e-8 * np.eye(3))
    return Images(rectified(RIG, scene)), fit


def supported(fit: SolidFit, support: float = 0.6) -> Supported:
    return Supported(fit, support, fit.residual_px, believable=False)


def shortened(fit: SolidFit) -> SolidFit:
    """The half of a cylinder from its nearer end."""
    axis: Floats = fit.rotation[:, 2] * -np.sign(fit.rotation[2, 2])
    return replace(fit, size_m=fit.size_m * (1, 1, 0.5), centre_m=fit.centre_m + axis * fit.size_m[2] / 4)


def test_it_is_known_by_its_pattern_and_a_plain_one_is_not() -> None:
    for part, is_known in ((LYING, True), (PLAIN, False)):
        images, fit = images_and_fit(part)
        assert (list(patterned(images, [supported(fit)], [])) != []) is is_known


def test_the_best_comes_first_and_pieces_and_what_hardly_has_edges_do_not_come() -> None:
    images, fit = images_and_fit(LYING)
    best, good = supported(fit, 0.7), supported(fit, 0.6)
    others = [supported(fit, 0.4), supported(replace(fit, residual_px=0.7)), supported(shortened(fit))]
    assert list(patterned(images, [good, *others, best], [])) == [best, good]


def test_what_comes_near_its_outlines_is_one_of_each_kind_and_longer_ones() -> None:
    images, fit = images_and_fit(LYING)
    left, right = (Outline.from_contour(fit.silhouette_px(camera)) for camera in (RIG.left, RIG.right))
    near = near_outlines(images, (left, right))
    assert {each.fit.kind for each in near} == {"sphere", "cylinder", "box", "hexprism"}
    assert min(np.linalg.norm(each.fit.centre_m - fit.centre_m) for each in near) < 1e-3


@pytest.mark.parametrize(("seed", "which"), first_of((107, 0), (16, 3), (108, 2)))
def test_a_part_that_lies_off_its_edges_is_found_by_its_pattern(seed: int, which: int) -> None:
    """In scene 16 no part is whole: the first one that is found shows the table."""
    result = found("textured_parts", seed)
    assert result.wrong == 0 and {each.which: each.distance_m for each in result.found}[which] < 1e-3
