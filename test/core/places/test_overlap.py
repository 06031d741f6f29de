"""No two objects are at the same place."""

from __future__ import annotations

import numpy as np
from rigs import RIGS

from stereo_pick.core.arrays import Floats
from stereo_pick.core.objects import Blob
from stereo_pick.core.places.overlap import are_one, goes_on_as, none_behind_another, one_in_each_place
from stereo_pick.core.places.position import Located, Row
from stereo_pick.core.shapes import SolidFit

BLOB = Blob(np.array([(0.0, 0.0), (9.0, 0.0), (9.0, 9.0)]), 50.0)
NOWHERE = np.zeros(2)
RIG = RIGS["thesis"]


def box(x_m: float, size_m: Floats, z_m: float = 0.9) -> SolidFit:
    return SolidFit("box", np.array([x_m, 0.0, z_m]), np.eye(3), size_m, 0.1, np.eye(3) * 1e-8)


def row(x_m: float, sigma_px: float, size_m: float = 0.04, z_m: float = 0.9) -> Row:
    return (BLOB, BLOB), Located(NOWHERE, NOWHERE, sigma_px, box(x_m, np.full(3, size_m), z_m))


def test_parts_that_touch_are_apart_and_parts_inside_each_other_are_not() -> None:
    small, large = box(0.0, np.full(3, 0.01)), box(0.018, np.full(3, 0.04))
    assert not box(0.041, np.full(3, 0.04)).overlaps(box(0.0, np.full(3, 0.04)))
    assert small.overlaps(large) and large.overlaps(small)


def test_what_is_read_twice_is_one_and_bars_that_cross_are_two() -> None:
    bar, across = box(0.0, np.array([0.06, 0.016, 0.022])), box(0.0, np.array([0.016, 0.06, 0.022]))
    again, shorter = box(0.004, np.array([0.056, 0.017, 0.022])), box(0.0, np.array([0.03, 0.016, 0.022]))
    assert are_one(bar, bar) and are_one(bar, again)
    assert not are_one(bar, across) and not are_one(bar, shorter) and not are_one(shorter, bar)


def test_what_is_hidden_from_one_camera_only_may_be_seen_by_the_other() -> None:
    """Of what would be seen through another, by both cameras, the surer one stays."""
    near, beside = row(0.0, 0.1), row(0.05, 0.2)
    behind, half_seen = row(0.005, 0.3, 0.01, z_m=0.94), row(0.0, 0.3, 0.01, z_m=1.1)
    stays, goes = none_behind_another([behind, near, beside], RIG)
    assert [where.sigma_px for _, where in stays] == [0.1, 0.2] and [where.reason for _, where in goes] == ["merged"]
    assert none_behind_another([near, half_seen], RIG)[1] == []


def test_the_surest_stays_and_the_others_are_refused() -> None:
    unknown: Row = ((BLOB, BLOB), Located(NOWHERE, NOWHERE, 2.0, None))
    stays, goes = one_in_each_place([row(0.0, 0.3), row(0.001, 0.1), row(0.1, 0.5), unknown])
    assert sorted(where.sigma_px for _, where in stays) == [0.1, 0.5, 2.0]
    assert [(where.sigma_px, where.reason) for _, where in goes] == [(0.3, "merged")]


def test_a_piece_of_a_solid_is_none_of_its_own() -> None:
    """What no solid explains is one where both views show its centre within what another does."""
    whole = row(0.0, 0.1)
    centre = [whole[1].fit.centre_px(camera) for camera in (RIG.left, RIG.right)] if whole[1].fit else []
    piece, half_seen = (
        ((BLOB, BLOB), Located(centre[0], right_px, 2.0, None)) for right_px in (centre[1], centre[1] + (200.0, 0.0))
    )
    stays, goes = none_behind_another([piece, half_seen, whole], RIG)
    assert stays == [whole, half_seen] and [where.reason for _, where in goes] == ["merged"]


def rod(along_m: float, length_m: float, beside_m: float = 0.0, thick_m: float = 0.04) -> SolidFit:
    """A cylinder along z."""
    centre_m = np.array([beside_m, 0.0, 0.9 + along_m])
    return SolidFit("cylinder", centre_m, np.eye(3), np.array([thick_m, thick_m, length_m]), 0.1, np.eye(3) * 1e-8)


def test_the_end_of_a_cylinder_is_no_other_one() -> None:
    """80 mm were found of one of 90 mm."""
    found, end = rod(0.0, 0.08), rod(0.045, 0.01)
    assert goes_on_as(end, found) and goes_on_as(found, end)
    assert not goes_on_as(rod(0.045, 0.01, beside_m=0.005), found)
    assert not goes_on_as(rod(0.045, 0.01, thick_m=0.03), found)
    assert not goes_on_as(rod(0.055, 0.01), found)
    assert not goes_on_as(box(0.0, np.full(3, 0.04)), box(0.04, np.full(3, 0.04)))
