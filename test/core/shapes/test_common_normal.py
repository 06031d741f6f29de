"""The table's normal from the solids that stand on it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest
from rigs import RIGS, rotation
from solid_outlines import Part, outlines_of

from stereo_pick.core.arrays import Floats
from stereo_pick.core.shapes import SolidFit, common_normal, fit_solids

RIG = RIGS["verged"]
Standing = tuple[str, float, float, float, bool, Sequence[float]]  # kind, x, y, yaw, lying, half sizes

MIXED: list[Standing] = [
    ("cylinder", -0.05, 0.03, 0.0, False, (0.02, 0.03)),
    ("cylinder", 0.06, 0.05, 0.7, True, (0.015, 0.035)),
    ("box", 0.0, -0.05, 0.4, False, (0.02, 0.03, 0.015)),
    ("sphere", 0.08, -0.03, 0.0, False, (0.02,)),
]
LYING: list[Standing] = [
    ("cylinder", -0.05, 0.03, 0.2, True, (0.02, 0.03)),
    ("cylinder", 0.06, 0.05, 1.1, True, (0.015, 0.035)),
    ("cylinder", 0.0, -0.05, 2.2, True, (0.015, 0.025)),
]
NUTS: list[Standing] = [
    ("hexprism", -0.05, 0.03, 0.3, False, (0.02, 0.012)),
    ("hexprism", 0.06, 0.05, 0.8, True, (0.015, 0.035)),
    ("hexprism", 0.0, -0.05, 0.1, False, (0.018, 0.03)),
]
UPRIGHT: list[Standing] = [
    ("cylinder", -0.05, 0.03, 0.0, False, (0.02, 0.03)),
    ("cylinder", 0.06, -0.02, 0.0, False, (0.015, 0.02)),
]


def on_table(tilt_deg: float, parts: Sequence[Standing]) -> tuple[list[SolidFit | None], Floats]:
    """The solids fitted to parts on a table tilted from facing the cameras, and the table's normal."""
    table = rotation((np.pi - np.deg2rad(tilt_deg), 0.05, 0.02))
    pairs = []
    for kind, x, y, yaw, lying, half in parts:
        stand = rotation((0, np.pi / 2, 0)) @ rotation((0, 0, np.pi / 6)) if lying else np.eye(3)
        height = half[0] if lying else half[-1]
        centre = np.array([0.12, 0, 0.9]) + table @ (x, y, height)
        part = Part(kind, centre, table @ rotation((0, 0, yaw)) @ stand, np.array(half))
        pairs.append(outlines_of(part, RIG))
    return fit_solids(pairs, RIG), table[:, 2]


@pytest.mark.parametrize("tilt_deg", [15, 40, 60])
@pytest.mark.parametrize("parts", [MIXED, LYING, UPRIGHT, NUTS], ids=["mixed", "lying", "upright", "nuts"])
def test_the_normal_is_what_all_solids_agree_on(tilt_deg: float, parts: list[Standing]) -> None:
    fits, normal = on_table(tilt_deg, parts)
    found = common_normal(fits)
    assert found is not None
    assert np.rad2deg(np.arccos(found @ normal)) < 0.5


def test_one_object_or_none_tells_nothing() -> None:
    fits, _ = on_table(40, MIXED)
    assert common_normal([]) is None and common_normal([None, None]) is None
    assert common_normal(fits[:1]) is None and common_normal([fits[0], None, fits[3]]) is None


def test_solids_that_disagree_have_no_common_normal() -> None:
    one, _ = on_table(15, UPRIGHT[:1])
    other, _ = on_table(50, UPRIGHT[1:])
    assert common_normal([*one, *other]) is None
