"""A part with a pattern is known by it where its surface is, and nowhere beside that; a plain one is not."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from family_scenes import found
from rendered_solids import PATTERNED, PLACED, RIG, rectified, true_fit
from rendering import Cylinder, Scene

from stereo_pick.core.doubts.seen_surface import is_seen_beyond, is_surface_seen

every_part = pytest.mark.parametrize("name", PATTERNED)


@every_part
def test_it_is_seen_where_it_is_and_not_a_few_millimetres_nearer_or_farther(name: str) -> None:
    scene = Scene((PATTERNED[name],), PLACED, ambient=0.5)
    pair, fit = rectified(RIG, scene), true_fit(RIG, scene, PATTERNED[name])
    assert is_surface_seen(pair, fit, [])
    px_m = RIG.focal_px * RIG.baseline_m / fit.centre_m[2] ** 2  # of disparity, by metres of depth
    for off_px in (-0.8, 0.8):
        assert not is_surface_seen(
            pair, replace(fit, centre_m=fit.centre_m * (1 - off_px / px_m / fit.centre_m[2])), []
        )


@every_part
def test_without_a_pattern_it_is_not_seen(name: str) -> None:
    part = PATTERNED[name]
    plain = type(part)(part.x_m, part.y_m, part.size_m, part.yaw_rad, lying=part.lying)
    scene = Scene((plain,), PLACED, ambient=0.5)
    assert not is_surface_seen(rectified(RIG, scene), true_fit(RIG, scene, plain), [])


@pytest.mark.parametrize(
    ("name", "kind"), [("sphere", "box"), ("box", "sphere"), ("box", "cylinder"), ("lying", "box")]
)
def test_a_solid_of_another_kind_bends_away_from_it(name: str, kind: str) -> None:
    scene = Scene((PATTERNED[name],), PLACED, ambient=0.5)
    fit = true_fit(RIG, scene, PATTERNED[name])
    size_m = fit.size_m if kind != "sphere" else np.full(3, np.median(fit.size_m))
    assert not is_surface_seen(rectified(RIG, scene), replace(fit, kind=kind, size_m=size_m), [])


@pytest.mark.parametrize(("name", "axis"), [("standing", 2), ("lying", 2), ("hexprism", 2), ("box", 0), ("box", 1)])
def test_of_a_piece_the_surface_is_seen_and_beyond_it_and_of_the_whole_not_beyond(name: str, axis: int) -> None:
    part = type(PATTERNED[name])(
        0.0, 0.0, tuple(np.multiply(1.6, PATTERNED[name].size_m)), 0.4, lying=name == "lying", texture=1.0
    )
    scene = Scene((part,), PLACED, ambient=0.5)
    pair, whole = rectified(RIG, scene), true_fit(RIG, scene, part)
    assert is_surface_seen(pair, whole, []) and not is_seen_beyond(pair, whole, [])
    upper = np.sign(-whole.rotation[2, axis]) * whole.size_m[axis] / 5 * whole.rotation[:, axis]
    piece = replace(
        whole, size_m=whole.size_m * np.where(np.arange(3) == axis, 0.6, 1.0), centre_m=whole.centre_m + upper
    )
    assert is_surface_seen(pair, piece, []) and is_seen_beyond(pair, piece, [])


def test_what_a_part_behind_another_shows_is_enough() -> None:
    box, other = PATTERNED["box"], Cylinder(0.0, -0.06, (0.03, 0.03, 0.05), albedo=0.9)
    scene = Scene((box, other), PLACED, ambient=0.5)
    pair = rectified(RIG, scene)
    assert is_surface_seen(pair, true_fit(RIG, scene, box), [true_fit(RIG, scene, other)])


def test_a_cylinder_as_dark_as_the_table_here_and_there_is_found_by_its_pattern() -> None:
    """A sixth of its creases shows, and two thirds of its silhouette."""
    result = found("textured_parts", 22)
    assert result.right and {each.which: each.distance_m for each in result.found}[2] < 5e-4
