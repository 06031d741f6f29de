"""Parts of which an outline shows the bright top only: stretched to their true length by the edges of their sides."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from rendered_solids import centre_m, half_lit_scene, rectified, solid_of
from rendering import Box, Cylinder, HexPrism, Scene, Solid, Sphere, hex_prism_size
from rendering.rigs import table_before
from rigs import RIGS, rotation

from stereo_pick.core.edges.growing import grown, is_longer
from stereo_pick.core.edges.hypotheses import Images

RIG = RIGS["thesis"]
TABLE = table_before(RIG, 0.9, elevation_deg=50)
PARTS: dict[str, Solid] = {
    "cylinder": Cylinder(-0.06, 0.0, (0.04, 0.04, 0.05)),
    "box": Box(0.05, 0.0, (0.05, 0.036, 0.045), yaw_rad=0.4),
}
CORNERS_ALONG_X = rotation((0, 0, np.pi / 2))
BARELY, CLEARLY = 0.02, 0.05  # by how much more light than the table the sides have: 5 and 13 grey levels


@cache
def seen(sides: float) -> tuple[Scene, Images]:
    scene = half_lit_scene(tuple(PARTS.values()), TABLE, sides)
    return scene, Images(rectified(RIG, scene))


@pytest.mark.parametrize("name", PARTS)
@pytest.mark.parametrize("sides", [BARELY, CLEARLY])
@pytest.mark.parametrize("top_m", [0.004, 0.01])
def test_a_top_is_grown_to_the_whole_part(name: str, sides: float, top_m: float) -> None:
    part, (scene, images) = PARTS[name], seen(sides)
    top = solid_of(RIG, scene, part, height_m=top_m)
    whole = grown(top, images.eyes_m, images.maps)
    assert whole is not None
    np.testing.assert_allclose(whole.size_m()[0], part.size_m, atol=6e-3)
    np.testing.assert_allclose(whole.centre_m[0], centre_m(RIG, scene, part), atol=3e-3)
    assert is_longer(whole, top, RIG.focal_px) and not is_longer(top, whole, RIG.focal_px)
    longer = images.longer(top)
    assert longer is not None and (longer.raises_doubt or sides == BARELY)
    if longer.believable:
        assert np.linalg.norm(longer.fit.centre_m - centre_m(RIG, scene, part)) < 4e-3


@pytest.mark.parametrize("name", PARTS)
@pytest.mark.parametrize("sides", [0.0, BARELY, CLEARLY, 0.3])
def test_a_whole_part_is_not_grown(name: str, sides: float) -> None:
    scene, images = seen(sides)
    assert grown(solid_of(RIG, scene, PARTS[name]), images.eyes_m, images.maps) is None


@pytest.mark.parametrize("name", PARTS)
def test_what_shows_no_edges_at_all_is_not_made_up(name: str) -> None:
    scene, images = seen(0.0)
    assert images.longer(solid_of(RIG, scene, PARTS[name], height_m=0.004)) is None


@pytest.mark.parametrize(("seen_m", "grows"), [(0.002, True), (0.02, False)])
def test_the_face_of_a_nut_is_grown_but_not_a_nut_with_sides(seen_m: float, grows: bool) -> None:
    """The edges of a shadow run along its own."""
    nut = HexPrism(0.0, 0.0, hex_prism_size(0.04, 0.045), yaw_rad=0.2)
    scene = half_lit_scene((nut,), TABLE, CLEARLY)
    part, images = solid_of(RIG, scene, nut, height_m=seen_m, turned=CORNERS_ALONG_X), Images(rectified(RIG, scene))
    whole = grown(part, images.eyes_m, images.maps)
    assert (whole is not None) == grows
    if whole is not None:
        np.testing.assert_allclose(whole.half_m[0], (0.02, 0.0225), atol=2e-3)


def test_a_ball_cannot_be_stretched() -> None:
    scene, images = seen(CLEARLY)
    ball = solid_of(RIG, scene, Sphere(-0.06, 0.0, (0.04, 0.04, 0.04)))
    assert grown(ball, images.eyes_m, images.maps) is None
