"""Outlines at the half-way level."""

from __future__ import annotations

import cv2
import numpy as np
import pytest
from outlines import discs, grey_image

from stereo_pick.core.arrays import Floats
from stereo_pick.core.objects.silhouette import refine_contour

CENTRE, RADIUS = np.array([300.4, 220.3]), 25.0


def whole_pixel_outline(light: Floats, threshold: float) -> Floats:
    mask = (light > threshold).astype(np.uint8)
    contours, _ = cv2.findContours(mask, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
    return contours[0][:, 0].astype(np.float64)


@pytest.mark.parametrize("threshold", [60.0, 100.0, 140.0])
@pytest.mark.parametrize("sense", [1, -1])
def test_the_outline_lands_on_the_edge_whatever_the_threshold(threshold: float, sense: int) -> None:
    light = grey_image(discs([(*CENTRE, RADIUS)])).astype(np.float32)
    refined = refine_contour(light, whole_pixel_outline(light, threshold)[::sense], min_contrast=5.0)
    distance = np.linalg.norm(refined - CENTRE, axis=1)
    assert np.abs(distance - RADIUS).max() < 0.15
    assert distance.mean() == pytest.approx(RADIUS, abs=0.05)


def test_a_dark_part_is_refined_like_a_bright_one() -> None:
    light = grey_image(discs([(*CENTRE, RADIUS)], surface=40.0, background=180.0)).astype(np.float32)
    refined = refine_contour(light, whole_pixel_outline(255 - light, 120.0), min_contrast=5.0)
    assert np.linalg.norm(refined - CENTRE, axis=1).mean() == pytest.approx(RADIUS, abs=0.05)


def test_a_brighter_side_does_not_pull_the_outline() -> None:
    shade = np.linspace(0.6, 1.4, 640)[None, :].repeat(480, axis=0)
    light = grey_image(discs([(*CENTRE, RADIUS)], surface=120.0, background=20.0))
    shaded = np.where(light > 20, 20 + (light - 20.0) * shade, 20).astype(np.float32)
    refined = refine_contour(shaded, whole_pixel_outline(shaded, 35.0), min_contrast=5.0)
    np.testing.assert_allclose(refined.mean(axis=0), CENTRE, atol=0.3)
    assert np.abs(np.linalg.norm(refined - CENTRE, axis=1) - RADIUS).max() < 0.2


def test_points_without_an_edge_stay() -> None:
    contour = whole_pixel_outline(discs([(*CENTRE, RADIUS)]), 100.0)
    even = np.full((480, 640), 90.0, np.float32)
    np.testing.assert_array_equal(refine_contour(even, contour, min_contrast=5.0), contour)
