"""A fitted solid's silhouette and what perspective does to its centroid."""

from __future__ import annotations

import numpy as np
import pytest
from rigs import RIGS
from solid_outlines import any_part, contours_px

from stereo_pick.core.errors import ArrayError
from stereo_pick.core.shapes import SolidFit, centroid_px
from stereo_pick.core.shapes.kinds import KINDS

RIG = RIGS["verged"]


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("seed", range(4))
def test_its_silhouette_is_the_outline_of_such_a_part(kind: str, seed: int) -> None:
    part = any_part(kind, RIG, np.random.default_rng(seed))
    size_m = 2 * part.half_m[list(KINDS[kind].axes)] * KINDS[kind].spans
    fit = SolidFit(kind, part.centre_m, part.rotation, size_m, 0.1, np.eye(3))
    for contour, camera in zip(contours_px(part, RIG), (RIG.left, RIG.right)):
        seen = fit.silhouette_px(camera)
        np.testing.assert_allclose(np.ptp(seen, axis=0), np.ptp(contour, axis=0), atol=0.1)
        want = fit.centre_px(camera) - centroid_px(contour, camera)
        np.testing.assert_allclose(fit.perspective_shift_px(camera), want, atol=2e-3)
    for direction in np.random.default_rng(seed).normal(size=(5, 3)):
        up = direction / np.linalg.norm(direction)
        if kind != "sphere":
            furthest = ((part.seen_from(np.zeros(3)) - part.centre_m) @ up).max()
            assert fit.reach_m(up) == pytest.approx(furthest, rel=1e-4)


def test_other_kinds_cannot_be_made() -> None:
    with pytest.raises(ArrayError, match="kind is 'cone'"):
        SolidFit("cone", np.zeros(3), np.eye(3), np.ones(3), 0.1, np.eye(3))
