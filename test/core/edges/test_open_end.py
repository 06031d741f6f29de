"""A piece of a solid: its sides go on beyond an end of which little is seen."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from rendered_solids import PARTS, PLACED, RIG, rectified, solid_of, table_of
from rendering import Box, Cylinder, HexPrism, Lamp, Scene, Solid

from stereo_pick.core.edges.hypotheses import Images
from stereo_pick.core.edges.open_end import has_open_end
from stereo_pick.core.shapes.solids import Solids

LONG: dict[str, Solid] = {
    "rod": Cylinder(-0.06, 0.03, (0.03, 0.03, 0.09), yaw_rad=0.5, lying=True),
    "bar": Box(0.05, 0.02, (0.09, 0.036, 0.03), yaw_rad=-0.4),
    "six sides": HexPrism(0.0, -0.07, (0.03, 0.03 * 2 / 3**0.5, 0.09), yaw_rad=0.9, lying=True),
}
ALONG = {"rod": 2, "bar": 0, "six sides": 2}  # which axis is the long one
ONE_SIDED = (Lamp((0.6, -0.3, 0.75)),)


@cache
def seen(one_sided: bool) -> tuple[Scene, Images]:
    parts = tuple(LONG.values())
    scene = Scene(parts, PLACED, lamps=ONE_SIDED, ambient=0.3) if one_sided else Scene(parts, PLACED, ambient=0.6)
    return scene, Images(rectified(RIG, scene))


def end_of(solid: Solids, axis: int, share: float, sign: float) -> Solids:
    """The piece at one end."""
    half_m = solid.half_m.copy()
    which = solid.kind.axes[axis]
    half_m[0, which] *= share
    away_m = sign * (solid.half_m[0, which] - half_m[0, which])
    return replace(solid, centre_m=solid.centre_m + away_m * solid.rotation[:, :, axis], half_m=half_m)


@pytest.mark.parametrize("one_sided", [False, True])
@pytest.mark.parametrize("on_table", [False, True])
@pytest.mark.parametrize("sign", [-1.0, 1.0])
@pytest.mark.parametrize("share", [0.15, 0.4, 0.7])
@pytest.mark.parametrize("name", sorted(LONG))
def test_a_piece_of_a_long_part_goes_on(name: str, share: float, sign: float, on_table: bool, one_sided: bool) -> None:
    """A disc at the end of a lying cylinder was published, its other 60 mm not seen: 30 mm off, stated to 1 mm."""
    scene, images = seen(one_sided)
    piece = end_of(solid_of(RIG, scene, LONG[name]), ALONG[name], share, sign)
    assert has_open_end(piece, images.eyes_m, images.maps, table_of(RIG, PLACED) if on_table else None)


@pytest.mark.parametrize("one_sided", [False, True])
@pytest.mark.parametrize("on_table", [False, True])
@pytest.mark.parametrize("name", sorted(LONG))
def test_all_of_a_long_part_does_not(name: str, on_table: bool, one_sided: bool) -> None:
    scene, images = seen(one_sided)
    whole = solid_of(RIG, scene, LONG[name])
    assert not has_open_end(whole, images.eyes_m, images.maps, table_of(RIG, PLACED) if on_table else None)


@pytest.mark.parametrize("noise_dn", [1.0, 8.0])
@pytest.mark.parametrize("contrast", [0.02, 0.6])
@pytest.mark.parametrize("name", sorted(PARTS))
def test_nor_does_any_other_part_that_is_whole(name: str, contrast: float, noise_dn: float) -> None:
    scene = Scene(tuple(PARTS.values()), PLACED, lamps=ONE_SIDED, ambient=contrast)
    images = Images(rectified(RIG, scene, noise_dn))
    assert not has_open_end(solid_of(RIG, scene, PARTS[name]), images.eyes_m, images.maps, table_of(RIG, PLACED))


def test_what_shows_no_edges_does_not_go_on() -> None:
    """Where nothing is seen at all, nothing is seen to go on."""
    scene, images = seen(False)
    moved = solid_of(RIG, scene, LONG["rod"])
    nowhere = replace(moved, centre_m=moved.centre_m + np.array([[0.0, -0.08, 0.0]]))
    assert not has_open_end(nowhere, images.eyes_m, images.maps, None)
