"""What the table that the other objects stand on says of the ones that the outlines leave open."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from families import staged
from grain_on_planes import NO_OBJECTS
from marks import first_of
from outlines import PARALLEL, blank_pair, disc
from rendering import Box, Cylinder, Scene, Sphere, render
from rendering.rigs import table_before
from rigs import RIGS, rotation

from stereo_pick.core.arrays import Floats
from stereo_pick.core.correspondence import feature
from stereo_pick.core.correspondence.feature import Feature
from stereo_pick.core.correspondence.found_table import TableSearch
from stereo_pick.core.correspondence.reading import Reader, Reading
from stereo_pick.core.correspondence.together import Together, adjusted_together
from stereo_pick.core.edges.hypotheses import Images
from stereo_pick.core.errors import ParameterError
from stereo_pick.core.pipeline import Pipeline, Steps
from stereo_pick.core.places.position import by_solid
from stereo_pick.core.poses import ObjectPoses
from stereo_pick.core.rectification import Rectifier
from stereo_pick.core.refusal import count_reasons
from stereo_pick.core.shapes import SolidFit
from stereo_pick.core.shapes.table import Table
from stereo_pick.core.tables.on_table import OnTable

RIG = RIGS["thesis"]
PLACED = table_before(RIG, 0.9, elevation_deg=45)
NORMAL = RIG.left.R @ PLACED.rotation[:, 2]
GIVEN = " ".join(f"{each:.9f}" for each in (*NORMAL, -NORMAL @ RIG.left.R @ PLACED.translation))


def poses_of(scene: Scene, table: str = "found", seed: int = 0) -> ObjectPoses:
    return Pipeline(RIG, Steps(method=Feature(table=table))).run(render(RIG, scene, seed=seed)).poses


def off_m(xyz: Floats, positions_m: Floats) -> Floats:
    return np.asarray(np.linalg.norm(xyz[:, None] - positions_m, axis=2).min(axis=1))


def test_the_table_completes_what_the_light_shows_in_part() -> None:
    """Mixed parts under a lamp at one side: some of their faces are as bright as the table."""
    missed = {"found": 0, "none": 0}
    for seed in (1, 2):
        scene = staged("mixed_shapes", seed)
        frame, truth = scene.taken()
        centres = np.array([each.centre_m for each in truth.objects])
        for table in missed:
            poses = Pipeline(scene.rig, Steps(method=Feature(table=table))).run(frame).poses
            missed[table] += len(centres) - len(poses)
            assert table == "none" or off_m(poses.xyz, centres).max(initial=0) < 3e-3
    assert missed["found"] == 0 < missed["none"]


@pytest.mark.parametrize("seed", first_of(13, 12))
def test_a_table_is_found_where_all_parts_are_half_lit(seed: int) -> None:
    """Two cylinders: one view shows a top alone where the other shows a side as well."""
    scene = staged("two_cylinders", seed)
    frame, truth = scene.taken()
    poses = Pipeline(scene.rig, Steps()).run(frame).poses
    centres = np.array([each.centre_m for each in truth.objects])
    assert len(poses) == len(centres) and off_m(poses.xyz, centres).max() < 1e-3


def test_a_part_held_above_the_table_stays_where_it_is() -> None:
    parts = (
        Cylinder(-0.08, -0.03, (0.04, 0.04, 0.05)),
        Box(0.08, -0.02, (0.05, 0.036, 0.04), yaw_rad=0.4),
        Cylinder(0.0, 0.06, (0.04, 0.04, 0.038), base_m=0.013),
    )
    scene = Scene(parts, PLACED, ambient=0.7)
    poses = poses_of(scene)
    assert len(poses) == 3 and (off_m(poses.xyz, scene.positions_m()) < 1e-3).all()


@pytest.mark.parametrize(("sharpness", "reason"), [(0.95, "off_table"), (0.6, "")])
def test_a_ball_in_the_air_may_be_the_lit_end_of_a_cylinder_unless_light_fades_at_its_limb(
    sharpness: float, reason: str
) -> None:
    """Two centimetres above the table; the images show nothing else of it."""
    ball = SolidFit("sphere", np.array([0.0, 0.0, 0.9]), np.eye(3), np.full(3, 0.03), 0.05, 1e-9 * np.eye(3))
    places = [ball.centre_px(camera) for camera in (PARALLEL.left, PARALLEL.right)]
    left, right = (disc(*place, 0.015 * PARALLEL.focal_px / 0.9) for place in places)
    blobs = tuple(replace(each, sharpness=np.full(len(each.contour_px), sharpness)) for each in (left, right))
    row = (blobs[0], blobs[1]), by_solid(PARALLEL, ball, 1.0)
    table = Table(np.array([0.0, 0.0, -1.0]), 0.935, 5e-4)
    kept, refused = OnTable(Images(blank_pair()), table, flat_parts=False).seen([row], [])
    assert [where.reason for _, where in kept + refused] == [reason]


@pytest.mark.parametrize("seed", first_of(3, 49, 56))
def test_what_seems_to_hang_stands_if_its_foot_shows(seed: int) -> None:
    """A cylinder whose side shows in one view only could be a shorter one above the table, or a ball, by its
    outlines."""
    scene = staged("elevation_30_to_90", seed)
    frame, truth = scene.taken()
    poses = Pipeline(scene.rig, Steps()).run(frame).poses
    assert off_m(poses.xyz, np.array([each.centre_m for each in truth.objects])).max() < 2e-3


def test_who_cannot_tell_two_solids_says_how_far_they_are_apart() -> None:
    """A box seen from above, its sides in its shadow: a lying cylinder has about as many edges."""
    scene = staged("elevation_30_to_90", 18)
    frame, truth = scene.taken()
    poses = Pipeline(scene.rig, Steps(method=Feature(max_sigma_of_width=10))).run(frame).poses
    off = poses.xyz[:, None] - np.array([each.centre_m for each in truth.objects])
    nearest = off[np.arange(len(off)), (off**2).sum(axis=2).argmin(axis=1)]
    squares = np.einsum("ni,nij,nj->n", nearest, np.linalg.inv(poses.covariance), nearest)
    variance = poses.covariance.trace(axis1=1, axis2=2)
    assert len(poses) == len(truth.objects)
    assert np.sqrt(variance.max()) > 0.01 > 10 * np.sqrt(np.median(variance))
    assert squares[variance.argmax()] < 16.3  # 99.9 % of three degrees of freedom


@pytest.mark.parametrize(
    ("family", "seed"), first_of(("dark_on_light", 13), ("many_small", 14), ("textured_parts", 28))
)
def test_what_cannot_be_where_its_outlines_put_it_is_what_stands_there(family: str, seed: int) -> None:
    """A solid that neither stands on the table nor hangs as things hang: one on the table has all the edges, too."""
    scene = staged(family, seed)
    frame, truth = scene.taken()
    poses = Pipeline(scene.rig, Steps()).run(frame).poses
    assert "off_table" not in count_reasons(poses.refused)
    assert off_m(poses.xyz, np.array([each.centre_m for each in truth.objects])).max() < 3e-3


@pytest.mark.parametrize(("below_m", "is_taken"), [(0.0, True), (0.3, False)])
def test_grain_on_which_nothing_stands_is_no_table(
    monkeypatch: pytest.MonkeyPatch, below_m: float, is_taken: bool
) -> None:
    """A plain table in front of a floor with a pattern."""
    *normal, offset = (float(word) for word in GIVEN.split())
    surface = Table(np.array(normal), offset + below_m, 5e-4)
    asked: list[bool] = []

    def adjusted_there(reader: Reader, reading: Reading, known: bool, edge_radius_m: float) -> Together:
        asked.append(known)
        return adjusted_together(reader, reading, known, edge_radius_m)

    monkeypatch.setattr(feature, "grained_table", lambda *_: surface)
    monkeypatch.setattr("stereo_pick.core.correspondence.scene.adjusted_together", adjusted_there)
    parts = (Cylinder(-0.05, 0.0, (0.04, 0.04, 0.05)), Box(0.05, 0.02, (0.05, 0.036, 0.04), yaw_rad=0.4))
    scene = Scene(parts, PLACED, ambient=0.7)
    poses = poses_of(scene)
    assert asked == [is_taken]
    assert len(poses) == 2 and (off_m(poses.xyz, scene.positions_m()) < 1e-3).all()


@pytest.mark.parametrize("turned_deg", [0, 30, 50])
def test_a_ball_and_its_own_cap_are_not_two_that_stand_on_a_table(turned_deg: float) -> None:
    """A ball stands on any plane: its lit cap says how that is inclined, and must not count beside it."""
    scene = Scene((Sphere(0.0, 0.0, (0.04, 0.04, 0.04)),), PLACED, ambient=0.7)
    pair = Rectifier(RIG).rectify(render(RIG, scene))
    blobs, _ = Steps().correspond(pair)
    seen = blobs.left[0], blobs.right[0]
    across = rotation((np.deg2rad(turned_deg), 0, 0)) @ NORMAL
    centre_m = RIG.left.R @ scene.positions_m()[0]
    axes = np.linalg.svd(across[None])[2][[1, 2, 0]].T
    cap = SolidFit("cylinder", centre_m + 0.018 * across, axes, np.array([0.03, 0.03, 0.002]), 0.1, np.eye(3) * 1e-8)
    ball = SolidFit("sphere", centre_m, np.eye(3), np.full(3, 0.04), 0.1, np.eye(3) * 1e-8)
    row = seen, by_solid(RIG, ball, shown=1.0)
    assert (
        TableSearch(
            Images(pair), [seen], [(seen, cap)], flat_parts=False, shaded=lambda _: [], bright=NO_OBJECTS
        ).table([row])
        is None
    )


def test_with_a_wrong_table_nothing_is_made_to_stand_on_it() -> None:
    """Given 60 mm too high: every part reaches below it."""
    *normal, offset = (float(word) for word in GIVEN.split())
    scene = Scene((Cylinder(0.0, 0.0, (0.04, 0.04, 0.05)),), PLACED, ambient=0.7)
    poses = poses_of(scene, " ".join(map(str, (*normal, offset - 0.06))))
    assert len(poses) == 0 and count_reasons(poses.refused) == {"off_table": 1}


@pytest.mark.parametrize("text", ["somewhere", "0 0 1", "0 0 1 0.9"])
def test_a_table_that_cannot_be_is_refused_with_its_value(text: str) -> None:
    with pytest.raises(ParameterError, match=text):
        Feature(table=text)
