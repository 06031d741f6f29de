"""What stands on another object is found where more is seen than that one; more of the same one is no other."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import pytest
from marks import first_of
from rendered_solids import FROM_ABOVE, RIG
from rendering import Box, Cylinder, HexPrism, Scene, Solid, Sphere, render_with_truth
from rendering.rigs import table_before

from stereo_pick.core.arrays import Floats
from stereo_pick.core.found_late import on_top
from stereo_pick.core.frames import RectifiedPair
from stereo_pick.core.pipeline import Pipeline, Steps
from stereo_pick.core.poses import ObjectPoses
from stereo_pick.core.shapes import SolidFit

HIGH_M = 0.03
LOWER = Box(0.0, 0.0, (0.07, 0.06, HIGH_M), yaw_rad=0.4, albedo=0.6)
BESIDE = (
    Box(-0.1, 0.03, (0.05, 0.04, 0.04), yaw_rad=1.1, albedo=0.7),
    Cylinder(0.1, 0.0, (0.04, 0.04, 0.05), albedo=0.7),
)
ON_TOP: dict[str, Solid] = {
    "cylinder": Cylinder(0.007, -0.004, (0.035, 0.035, 0.04), albedo=0.8, base_m=HIGH_M),
    "box": Box(0.006, 0.005, (0.04, 0.03, 0.03), yaw_rad=1.2, albedo=0.8, base_m=HIGH_M),
}
BODY = Cylinder(0.0, 0.0, (0.045, 0.045, HIGH_M), albedo=0.6)
MORE_OF_IT: dict[str, tuple[Solid, Solid]] = {
    "a neck": (BODY, Cylinder(0.0, 0.0, (0.02, 0.02, 0.03), albedo=0.6, base_m=HIGH_M)),
    "a rib": (LOWER, Box(0.0, 0.0, (0.07, 0.02, 0.03), yaw_rad=0.4, albedo=0.6, base_m=HIGH_M)),
}


class Found(NamedTuple):
    """apart_m: (M, N), from each of two parts, and those beside them, to each pose."""

    apart_m: Floats
    poses: ObjectPoses


def found(*parts: Solid, elevation_deg: float) -> Found:
    scene = Scene((*parts, *BESIDE), table_before(RIG, 0.9, elevation_deg), ambient=0.6, lamps=(FROM_ABOVE,))
    frame, truth = render_with_truth(RIG, scene, seed=0)
    poses = Pipeline(RIG, Steps()).run(frame).poses
    return Found(np.linalg.norm(truth.centres_m[:, None] - poses.xyz, axis=2), poses)


@pytest.mark.parametrize(
    ("kind", "elevation_deg"), [*first_of(("cylinder", 50.0), ("cylinder", 65.0)), *first_of(("box", 65.0))]
)
def test_a_part_on_another_one_is_found_and_so_is_the_lower_one(kind: str, elevation_deg: float) -> None:
    """Both were refused, the lower one for what is seen before its top."""
    apart_m, poses = found(LOWER, ON_TOP[kind], elevation_deg=elevation_deg)
    assert apart_m.min(axis=1).max() < 5e-4 and len(poses) == 2 + len(BESIDE)
    assert poses.confidence.min() > 0.9


@pytest.mark.parametrize(
    ("lower", "upper", "elevation_deg"),
    first_of(
        (
            HexPrism(0.0, 0.0, (0.0555, 0.064, 0.0536), yaw_rad=-0.95, albedo=0.6),
            Cylinder(-0.009, 0.006, (0.027, 0.027, 0.034), albedo=0.75, base_m=0.0536),
            75.0,
        ),
        (
            Box(0.0, 0.0, (0.096, 0.073, 0.0386), yaw_rad=0.3, albedo=0.57),
            Cylinder(0.015, -0.008, (0.026, 0.026, 0.03), albedo=0.7, base_m=0.0386),
            50.0,
        ),
    ),
    ids=["on a prism", "on a box"],
)
def test_what_outlines_do_not_show_there_is_found_by_what_rises_from_the_top(
    lower: Solid, upper: Solid, elevation_deg: float
) -> None:
    apart_m, _ = found(lower, upper, elevation_deg=elevation_deg)
    assert apart_m.min(axis=1).max() < 5e-4


@pytest.mark.parametrize("name", MORE_OF_IT)
@pytest.mark.parametrize("elevation_deg", first_of(50.0, 38.0, 65.0))
def test_what_is_on_its_axis_or_flush_with_it_is_no_other(name: str, elevation_deg: float) -> None:
    apart_m, poses = found(*MORE_OF_IT[name], elevation_deg=elevation_deg)
    assert apart_m[2:].min(axis=1).max() < 5e-4
    of_it = apart_m[:2].min(axis=0) < 0.06
    assert (poses.confidence[of_it] < 0.9).all()


def test_nothing_stands_on_a_ball_nor_on_a_cylinder_that_lies(monkeypatch: pytest.MonkeyPatch) -> None:
    asked = list[SolidFit]()

    def noted(_pair: RectifiedPair, fit: SolidFit, _others: Sequence[SolidFit]) -> bool:
        asked.append(fit)
        return False

    monkeypatch.setattr(on_top, "stands_out", noted)
    ball = Sphere(0.0, 0.06, (0.04,) * 3, albedo=0.7)
    lying = Cylinder(0.0, -0.05, (0.03, 0.03, 0.08), yaw_rad=0.5, albedo=0.7, lying=True)
    assert len(found(ball, lying, elevation_deg=50.0).poses) == 4
    assert sorted(fit.kind for fit in asked) == ["box", "cylinder"]
    assert all(float(fit.size_m.max()) < 0.06 for fit in asked)
