"""Dark parts in their own shadow, found by what is above it, in rendered scenes with exact truth."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from rendered_solids import PLACED, RIG, centre_m, rectified, solid_of, table_of
from rendering import Cylinder, Scene, Solid, lamp_at

from stereo_pick.core.correspondence.feature import Feature
from stereo_pick.core.edges.hypotheses import Images
from stereo_pick.core.found_late import shaded_foot
from stereo_pick.core.found_late.last_look import LastLook, Seen
from stereo_pick.core.found_late.shaded_foot import in_its_shadow, refused_in_its_shadow
from stereo_pick.core.matches.left_over import Unread
from stereo_pick.core.pipeline import Steps
from stereo_pick.core.places.position import BlobPair
from stereo_pick.core.shapes import SolidFit
from stereo_pick.core.shapes.solids import Solids
from stereo_pick.core.tables.lying_flat import WarpedViews

TABLE = table_of(RIG, PLACED)
RODS = (
    Cylinder(-0.05, 0.0, (0.03, 0.03, 0.07), yaw_rad=0.4, lying=True, albedo=0.04),
    Cylinder(0.05, 0.02, (0.03, 0.03, 0.06), yaw_rad=1.4, lying=True, albedo=0.04),
    Cylinder(0.0, 0.09, (0.035, 0.035, 0.06), yaw_rad=2.3, lying=True, albedo=0.04),
)


def lit(parts: tuple[Solid, ...], azimuth_deg: float, radius_m: float, ambient: float) -> Scene:
    """Dark parts on white paper below a lamp as large as that."""
    lamp = lamp_at(75.0, azimuth_deg, 1.0, 1.5, radius_m)
    return Scene(parts, PLACED, table_albedo=0.8, lamps=(lamp,), ambient=ambient, shadows=True)


def looked_at(scene: Scene, others: list[SolidFit]) -> tuple[Seen | None, BlobPair, LastLook, WarpedViews]:
    """What is found where the first part is, with its outlines."""
    pair = rectified(RIG, scene)
    true = solid_of(RIG, scene, scene.solids[0])
    fit = SolidFit(true.kind.name, true.centre_m[0], true.rotation[0], true.size_m()[0], 0.1, 1e-8 * np.eye(3))
    detected = Steps().correspond(pair)[0]
    several = zip((detected.left, detected.right), (RIG.left, RIG.right))
    left, right = (
        min(blobs, key=lambda blob: float(np.linalg.norm(blob.centroid_px - fit.silhouette_px(camera).mean(axis=0))))
        for blobs, camera in several
    )
    look, warped = LastLook(Images(pair), TABLE, [], []), WarpedViews(pair, TABLE)
    return in_its_shadow(look, warped, (left, right), others), (left, right), look, warped


@pytest.mark.parametrize(
    "light", [(110.0, 0.1, 0.2), (200.0, 0.5, 0.2), (290.0, 0.25, 0.4)], ids=["front", "side", "behind"]
)
def test_dark_parts_are_found_whatever_of_them_their_shadows_hide(light: tuple[float, float, float]) -> None:
    scene = lit(RODS, *light)
    steps = Steps(method=Feature())
    _, matches = steps.correspond(rectified(RIG, scene))
    poses = steps.locate(matches, RIG, 0)
    off_m = [np.linalg.norm(poses.xyz @ RIG.left.R.T - centre_m(RIG, scene, rod), axis=1).min() for rod in RODS]
    assert len(poses) == len(RODS) and max(off_m) < 1e-3


@pytest.mark.parametrize("rod", RODS, ids=["one", "two", "three"])
def test_a_dark_part_is_found_once_and_only_where_no_other_is(rod: Cylinder) -> None:
    scene = lit((rod,), 290.0, 0.25, 0.4)
    found, blobs, look, warped = looked_at(scene, [])
    assert found is not None
    there = found[1]
    np.testing.assert_allclose(there.fit.centre_m, centre_m(RIG, scene, rod), atol=1e-3)
    assert in_its_shadow(look, warped, blobs, [there.fit]) is None
    alone = Unread("left_only", blobs[0], None)
    carried = refused_in_its_shadow(look, warped, alone, [])
    assert carried is not None
    np.testing.assert_allclose(carried[1].fit.centre_m, there.fit.centre_m, atol=5e-4)
    both = refused_in_its_shadow(look, warped, Unread("half_lit", *blobs), [])
    assert both is not None and both[0][0] == blobs


def test_bright_parts_are_not_looked_for() -> None:
    found, *_ = looked_at(lit((replace(RODS[0], albedo=0.9),), 290.0, 0.25, 0.1), [])
    assert found is None


def piece_of(scene: Scene, share: float) -> tuple[Solids, Solids]:
    """A lying cylinder, and so much of it, from one of its ends."""
    true = solid_of(RIG, scene, scene.solids[0]).turning_about(TABLE.normal)
    half_m = true.half_m * [1.0, share]
    middle_m = true.centre_m + true.rotation[:, :, 2] * (true.half_m - half_m)[:, 1:]
    return true, replace(true, centre_m=middle_m, half_m=half_m)


def test_a_piece_beside_which_the_rest_rises_is_none(monkeypatch: pytest.MonkeyPatch) -> None:
    scene = lit((RODS[0],), 290.0, 0.25, 0.4)
    true, piece = piece_of(scene, 0.5)
    monkeypatch.setattr(shaded_foot, "_is_clear", lambda *_: True)
    for solid, is_found in ((piece, False), (true, True)):
        monkeypatch.setattr(LastLook, "around", lambda *_, solid=solid: [solid])
        assert (looked_at(scene, [])[0] is not None) == is_found
