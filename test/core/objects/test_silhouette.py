"""Outlines at the edge of the object."""

from __future__ import annotations

import cv2
import numpy as np
import pytest
from outlines import discs, grey_image

from stereo_pick.core.arrays import Floats, Image
from stereo_pick.core.objects.silhouette import Silhouette, trace_silhouettes

CENTRE, RADIUS = np.array([300.4, 220.3]), 25.0


def whole_pixel_outline(light: Floats | Image, threshold: float) -> Floats:
    mask = (light > threshold).astype(np.uint8)
    contours, _ = cv2.findContours(mask, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
    return np.asarray(contours[0][:, 0], np.float64)


def traced(light: Image, contour: Floats) -> Silhouette:
    (silhouette,) = trace_silhouettes(light, [contour], min_contrast=5.0)
    return silhouette


def radii(silhouette: Silhouette) -> Floats:
    return np.linalg.norm(silhouette.points_px - CENTRE, axis=1)


@pytest.mark.parametrize("threshold", [60.0, 100.0, 140.0])
@pytest.mark.parametrize("sense", [1, -1])
def test_the_outline_lands_on_the_edge_whatever_the_threshold(threshold: float, sense: int) -> None:
    light = grey_image(discs([(*CENTRE, RADIUS)]))
    distance = radii(traced(light, whole_pixel_outline(light, threshold)[::sense]))
    assert np.abs(distance - RADIUS).max() < 0.15
    assert distance.mean() == pytest.approx(RADIUS, abs=0.05)


def test_a_dark_part_is_traced_like_a_bright_one() -> None:
    light = grey_image(discs([(*CENTRE, RADIUS)], surface=40.0, background=180.0))
    distance = radii(traced(light, whole_pixel_outline(255 - light, 120.0)))
    assert distance.mean() == pytest.approx(RADIUS, abs=0.05)


def test_a_brighter_side_does_not_pull_the_outline() -> None:
    shade = np.linspace(0.6, 1.4, 640)[None, :].repeat(480, axis=0)
    light = grey_image(discs([(*CENTRE, RADIUS)], surface=120.0, background=20.0))
    shaded = np.where(light > 20, 20 + (light - 20.0) * shade, 20).round().astype(np.uint8)
    silhouette = traced(shaded, whole_pixel_outline(shaded, 35.0))
    np.testing.assert_allclose(silhouette.points_px.mean(axis=0), CENTRE, atol=0.3)
    assert np.abs(radii(silhouette) - RADIUS).max() < 0.2


def rounded(reach: float) -> Image:
    """A disc whose light grows from its rim as on a ball (reach 1 at the centre), through a lens of 0.8 px blur."""
    v, u = np.mgrid[:1920, :2560] / 4 - 0.375
    inside = np.clip(1 - np.hypot(u - CENTRE[0], v - CENTRE[1]) ** 2 / RADIUS**2, 0, None)
    light = 20 + np.where(inside > 0, 60 + reach * 130 * np.sqrt(inside), 0)
    blurred = cv2.GaussianBlur(light, (0, 0), 0.8 * 4)
    return np.asarray(cv2.resize(blurred, (640, 480), interpolation=cv2.INTER_AREA).round().astype(np.uint8))


def test_the_limb_of_a_round_part_is_found_where_it_is() -> None:
    """The half-way level lies a third of a pixel and more inside."""
    light = rounded(reach=1.0)
    silhouette = traced(light, whole_pixel_outline(light, 60.0))
    assert radii(silhouette).mean() == pytest.approx(RADIUS, abs=0.12)


def test_a_step_is_sharp_and_fading_light_is_not() -> None:
    flat, fading = grey_image(discs([(*CENTRE, RADIUS)])), grey_image(discs([(*CENTRE, RADIUS)]))
    assert np.median(traced(flat, whole_pixel_outline(flat, 100.0)).sharpness) > 0.85
    ramp = np.clip(np.arange(640) - (CENTRE[0] - 20), 0, 40)[None, :].repeat(480, axis=0) / 40
    fading = np.where(fading > 100, 50 + 150 * ramp, 50).round().astype(np.uint8)  # lit from the right
    silhouette = traced(fading, whole_pixel_outline(fading, 75.0))
    on_the_fade = silhouette.points_px[:, 0] < CENTRE[0] - 8
    assert np.median(silhouette.sharpness[on_the_fade]) < 0.3
    assert np.median(silhouette.sharpness[~on_the_fade]) > 0.8


def test_points_without_an_edge_stay() -> None:
    contour = whole_pixel_outline(discs([(*CENTRE, RADIUS)]), 100.0)
    silhouette = traced(np.full((480, 640), 90, np.uint8), contour)
    assert np.abs(radii(silhouette) - RADIUS).max() < 1.0
    assert not silhouette.sharpness.any()
