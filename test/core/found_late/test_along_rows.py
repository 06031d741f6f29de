"""What lies along the rows of the views, as a rod or as a printed line: only its ends tell how high it is."""

from __future__ import annotations

import cv2
import numpy as np
import pytest
from outlines import PARALLEL, grey_image
from rigs import SIZE_PX, rotation

from stereo_pick.core.arrays import Floats
from stereo_pick.core.edges.hypotheses import Images
from stereo_pick.core.found_late.along_rows import shows_height
from stereo_pick.core.frames import RectifiedPair
from stereo_pick.core.shapes import SolidFit

LYING = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])  # along the rows
FINER = 8


def rod(turn_deg: float) -> SolidFit:
    turned = rotation(np.array([0.0, 0.0, np.deg2rad(turn_deg)])) @ LYING
    return SolidFit(
        "cylinder", np.array([0.05, 0.01, 0.5]), turned, np.array([0.016, 0.016, 0.08]), 0.05, np.eye(3) * 1e-8
    )


def seen(fit: SolidFit, apart_px: float) -> Images:
    """It alone, or what is seen of a mark as long on the table, the disparity of which is less by so much."""
    shifts = (-apart_px / 2, apart_px / 2)
    left, right = (
        drawn(fit.silhouette_px(each) + (by, 0.0)) for each, by in zip((PARALLEL.left, PARALLEL.right), shifts)
    )
    return Images(RectifiedPair(grey_image(left), grey_image(right), PARALLEL))


def drawn(outline_px: Floats) -> Floats:
    light = np.full((SIZE_PX[1] * FINER, SIZE_PX[0] * FINER), 60.0, np.float32)
    cv2.fillPoly(light, [((outline_px + 0.5) * FINER - 0.5).round().astype(np.int32)], 180.0)
    return cv2.resize(light, None, fx=1 / FINER, fy=1 / FINER, interpolation=cv2.INTER_AREA).astype(np.float64)


@pytest.mark.parametrize("turn_deg", [0, 10, 45, 90])
def test_a_rod_shows_it(turn_deg: float) -> None:
    fit = rod(turn_deg)
    assert shows_height(fit, seen(fit, 0.0))


@pytest.mark.parametrize("turn_deg", [0, 10])
def test_a_printed_line_along_the_rows_does_not_look_like_a_rod_at_its_ends(turn_deg: float) -> None:
    """A version that never landed published the white border of a marker as a rod, nine tenths of which showed."""
    fit = rod(turn_deg)
    assert not shows_height(fit, seen(fit, 2.0))
