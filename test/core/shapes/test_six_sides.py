"""Whether a hexagonal prism is worth looking for where a cylinder already explains an object."""

from __future__ import annotations

import numpy as np
import pytest
from rigs import RIGS
from solid_outlines import any_part, contours_px, disturbed

from stereo_pick.core.arrays import Bools, Floats
from stereo_pick.core.shapes import Outline
from stereo_pick.core.shapes.evidence import misfit_px
from stereo_pick.core.shapes.kinds import CYLINDER
from stereo_pick.core.shapes.refinement import fitted, refine
from stereo_pick.core.shapes.sight import Sight
from stereo_pick.core.shapes.six_sides import may_have_six_sides
from stereo_pick.core.shapes.solids import Solids

RIG = RIGS["verged"]
NOISE_PX = 0.1


def as_cylinders(kind: str, noise_px: float, seed: int, count: int = 120) -> tuple[Bools, Floats]:
    """What is said of parts of a kind beside the best cylinders about their axes, and the misfits of these."""
    rng = np.random.default_rng(seed)
    parts = [any_part(kind, RIG, rng) for _ in range(count)]
    noisy = [[disturbed(contour, noise_px, rng) for contour in contours_px(part, RIG)] for part in parts]
    seen = Sight.of([(Outline.from_contour(left), Outline.from_contour(right)) for left, right in noisy], RIG)
    solids = Solids(
        CYLINDER,
        np.array([part.centre_m for part in parts]),
        np.array([part.rotation for part in parts]),
        np.array([part.half_m for part in parts]),
        np.broadcast_to(np.eye(3)[:, :2], (count, 3, 2)),
    )
    fine = seen.without_corners()
    found = refine(fine, fitted(fine, solids), 8)
    return may_have_six_sides(seen, found, NOISE_PX), misfit_px(found, NOISE_PX)


@pytest.mark.parametrize("noise_px", [0.001, 0.06])
def test_no_prism_that_looks_like_a_cylinder_is_ruled_out(noise_px: float) -> None:
    possible, misfit = as_cylinders("hexprism", noise_px, seed=9)
    mistaken = misfit < 1.5 * NOISE_PX
    assert mistaken.sum() >= 3 and possible[mistaken].all()


def test_most_cylinders_are_known_to_be_round() -> None:
    possible, _ = as_cylinders("cylinder", 0.08, seed=10)
    assert possible.mean() < 0.2
