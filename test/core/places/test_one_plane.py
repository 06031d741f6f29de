"""Which outlines could be those of flat faces, and on which plane: exact ones of plates and solids."""

from __future__ import annotations

import numpy as np
import pytest
from rendering import Box, Cylinder, HexPrism, Solid, Sphere, hex_prism_size
from rendering.rigs import table_before
from rigs import RIGS
from solid_outlines import contour_px

from stereo_pick.core.arrays import Floats
from stereo_pick.core.objects import Blob
from stereo_pick.core.places.one_plane import Sides, common_plane, height_m, plane_with, shows_one_face
from stereo_pick.core.rig import StereoRig
from stereo_pick.core.shapes.table import Table

ANGLE = np.linspace(0, 2 * np.pi, 90, endpoint=False)
FACES = {
    "round": 0.022 * np.c_[np.cos(ANGLE), np.sin(ANGLE), 0 * ANGLE],
    "long": np.array([(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)]) * (0.04, 0.012, 0),
    "three-cornered": np.array([(0.03, 0, 0), (-0.02, 0.024, 0), (-0.01, -0.026, 0)]),
}
SOLIDS: dict[str, Solid] = {
    "standing box": Box(0, 0, (0.05, 0.04, 0.045), yaw_rad=0.4),
    "standing cylinder": Cylinder(0, 0, (0.04, 0.04, 0.05)),
    "lying cylinder": Cylinder(0, 0, (0.03, 0.03, 0.06), yaw_rad=0.7, lying=True),
    "ball": Sphere(0, 0, (0.045, 0.045, 0.045)),
    "hexagonal prism": HexPrism(0, 0, hex_prism_size(0.045, 0.04), yaw_rad=0.3),
}


def shown(rig: StereoRig, points_m: Floats) -> tuple[Blob, Blob]:
    """The hull's outlines; points (N, 3) in the left optical frame."""
    rectified = points_m @ rig.left.R.T
    eyes = np.array([[0.0, 0.0, 0.0], [rig.baseline_m, 0.0, 0.0]])
    left, right = (Blob(contour_px(rectified - eye, camera), 100.0) for eye, camera in zip(eyes, (rig.left, rig.right)))
    return left, right


@pytest.mark.parametrize("name", FACES)
@pytest.mark.parametrize("elevation_deg", [35, 50, 65])
@pytest.mark.parametrize("rig", ["thesis", "verged", "parallel"])
def test_a_tilted_face_is_one(name: str, elevation_deg: float, rig: str) -> None:
    table = table_before(RIGS[rig], 0.9, elevation_deg)
    assert shows_one_face(*shown(RIGS[rig], table.apply(FACES[name])), RIGS[rig])


@pytest.mark.parametrize("name", FACES)
def test_a_face_towards_the_camera_is_not_told_from_a_body(name: str) -> None:
    """Seen straight from above, a cylinder is as round as its top."""
    facing = FACES[name] + (0.0, 0.0, 0.9)
    assert not shows_one_face(*shown(RIGS["parallel"], facing), RIGS["parallel"])


@pytest.mark.parametrize("name", SOLIDS)
@pytest.mark.parametrize("elevation_deg", [35, 50, 65])
@pytest.mark.parametrize("rig", ["thesis", "verged", "parallel"])
def test_a_body_is_none(name: str, elevation_deg: float, rig: str) -> None:
    table = table_before(RIGS[rig], 0.7, elevation_deg)
    assert not shows_one_face(*shown(RIGS[rig], table.apply(SOLIDS[name].hull_m())), RIGS[rig])


def test_what_is_a_few_rows_high_tells_nothing() -> None:
    flat = FACES["round"] * (1, 0.08, 1)
    assert not shows_one_face(*shown(RIGS["parallel"], flat + (0.0, 0.0, 0.9)), RIGS["parallel"])


@pytest.mark.parametrize("lifted_m", [-0.01, 0.0, 0.003, 0.04])
@pytest.mark.parametrize("rig", ["thesis", "verged", "parallel"])
def test_how_high_a_face_lies_above_a_table(rig: str, lifted_m: float) -> None:
    placed = table_before(RIGS[rig], 0.9, 55)
    normal = RIGS[rig].left.R @ placed.rotation[:, 2]
    table = Table(normal, -float(normal @ RIGS[rig].left.R @ placed.translation), 1e-4)
    sides = Sides.of(*shown(RIGS[rig], placed.apply(FACES["long"] + (0.0, 0.0, lifted_m))), RIGS[rig])
    plane = plane_with(normal, sides)
    assert height_m(plane, table, RIGS[rig]) == pytest.approx(lifted_m, abs=2e-4) and sides.off_px(plane) < 0.02


def test_faces_on_one_plane_have_it_in_common_and_others_have_none() -> None:
    placed = table_before(RIGS["thesis"], 0.9, 70)
    faces = [FACES["round"] + (x, 0.02, 0.0) for x in (-0.06, 0.0, 0.06)]
    sides = [Sides.of(*shown(RIGS["thesis"], placed.apply(each)), RIGS["thesis"]) for each in faces]
    assert max(each.off_px(common_plane(sides)) for each in sides) < 0.02
    raised = Sides.of(*shown(RIGS["thesis"], placed.apply(faces[1] + (0.0, 0.0, 0.01))), RIGS["thesis"])
    assert raised.off_px(common_plane([sides[0], raised, sides[2]])) > 0.2
