"""The meshes that are path-traced are the parts that the truth speaks of; tracing itself needs more than the tests."""

from __future__ import annotations

import numpy as np
import pytest
from path_tracing.meshes import Mesh, mesh
from rendering import Box, Cylinder, HexPrism, Solid, Sphere, Tube, hex_prism_size
from traced_families import TRACED, traced

PARTS: dict[str, tuple[Solid, float]] = {  # and their volumes [m³]
    "box": (Box(0.02, -0.01, (0.06, 0.04, 0.03), yaw_rad=0.4), 0.06 * 0.04 * 0.03),
    "cylinder": (Cylinder(0.0, 0.03, (0.04, 0.04, 0.06)), np.pi * 0.02**2 * 0.06),
    "lying": (Cylinder(0.0, 0.0, (0.03, 0.03, 0.07), 1.1, lying=True), np.pi * 0.015**2 * 0.07),
    "hexprism": (HexPrism(0.0, 0.0, hex_prism_size(0.04, 0.03), 0.2), 0.04**2 * np.sqrt(3) / 2 * 0.03),
    "sphere": (Sphere(0.01, 0.01, (0.04,) * 3), np.pi * 0.04**3 / 6),
    "tube": (Tube(0.0, 0.0, (0.03, 0.03, 0.07), bore=0.8), np.pi * 0.015**2 * 0.07 * (1 - 0.8**2)),
}


def volume_m3(of: Mesh) -> float:
    """By the divergence theorem: of the inside of a closed surface whose triangles all face outwards."""
    a, b, c = (of.points[of.triangles[:, corner]] for corner in range(3))
    return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6)


@pytest.mark.parametrize("name", PARTS)
def test_a_mesh_has_the_volume_of_its_part_and_faces_outwards(name: str) -> None:
    part, expected = PARTS[name]
    assert volume_m3(mesh(part, 1e-6)) == pytest.approx(expected, rel=5e-3)


@pytest.mark.parametrize("name", PARTS)
def test_rounding_takes_a_little_away_and_adds_nothing(name: str) -> None:
    part, expected = PARTS[name]
    rounded = mesh(part, 0.001)
    own = (rounded.points - part.centre_m) @ part.axes
    assert (np.abs(own) <= np.array(part.size_m) / 2 + 1e-9).all()
    assert 0.97 * expected < volume_m3(rounded) <= expected * 1.001


@pytest.mark.parametrize("name", PARTS)
def test_normals_are_those_of_the_faces(name: str) -> None:
    found = mesh(PARTS[name][0], 0.001)
    a, b, c = (found.points[found.triangles[:, corner]] for corner in range(3))
    across = np.cross(b - a, c - a)
    flat = np.linalg.norm(across, axis=1) > 1e-12
    for corner in range(3):
        assert (np.einsum("ij,ij->i", across, found.normals[found.triangles[:, corner]])[flat] > 0).all()


@pytest.mark.parametrize("family", TRACED)
def test_a_seed_makes_one_scene_whose_parts_both_cameras_see(family: str) -> None:
    scene = traced(family, 3)
    again = traced(family, 3)
    assert scene.parts == again.parts and scene.looks == again.looks and len(scene.looks) == len(scene.parts) > 1
    for part in scene.parts:
        for pixels, camera in zip(
            scene.rig.project(scene.left_T_table.apply(part.hull_m())), (scene.rig.left, scene.rig.right)
        ):
            assert (pixels > 0).all() and (pixels < camera.frame_size).all()
