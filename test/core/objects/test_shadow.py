"""Dark parts and their shadows: what is lighter than the part and softer than the lens at its rim is no part of it."""

from __future__ import annotations

import cv2
import numpy as np
import pytest
from outlines import PARALLEL, discs, grey_image

from stereo_pick.core.arrays import Floats
from stereo_pick.core.frames import RectifiedPair
from stereo_pick.core.objects import Blob, Detector
from stereo_pick.core.objects.focus import lens_blur_px

TABLE, PART = 180.0, 40.0
PLACE, RADIUS = (300.4, 220.3), 30.0


def found(light: Floats) -> Blob:
    image = grey_image(light, noise_dn=1.0)
    blobs = Detector(polarity="dark").detect(RectifiedPair(image, image, PARALLEL))
    (blob,) = blobs.left
    return blob


def shadow(light: Floats, shift_px: float, depth: float, softness_px: float) -> Floats:
    """The same light under the soft shadow of a disc like the part, beside it."""
    shade = discs([(PLACE[0] + shift_px, PLACE[1] + shift_px / 2, RADIUS)], surface=1.0, background=0.0)
    return np.asarray(light * (1 - depth * cv2.GaussianBlur(shade, (0, 0), softness_px)))


def on_table(depth: float = 0.0, shift_px: float = 18.0, softness_px: float = 7.0) -> Floats:
    """A dark disc, and its shadow on the table."""
    part = discs([(*PLACE, RADIUS)], surface=1.0, background=0.0)
    table = shadow(np.full(part.shape, TABLE), shift_px, depth, softness_px)
    return table + part * (PART - table)


@pytest.mark.parametrize("depth", [0.35, 0.45, 0.6])
@pytest.mark.parametrize("shift_px", [20.0, 28.0])
def test_a_dark_disc_loses_its_soft_shadow(depth: float, shift_px: float) -> None:
    blob = found(on_table(depth, shift_px))
    assert not blob.fault
    assert blob.area_px2 == pytest.approx(np.pi * RADIUS**2, rel=0.02)
    np.testing.assert_allclose(blob.centroid_px, PLACE, atol=0.3)


@pytest.mark.parametrize("softness_px", [1.2, 2.0, 4.0])
def test_a_shadow_hardly_softer_than_the_lens_is_cut_off_too(softness_px: float) -> None:
    blob = found(on_table(0.55, 28.0, softness_px))
    assert blob.area_px2 == pytest.approx(np.pi * RADIUS**2, rel=0.02)
    np.testing.assert_allclose(blob.centroid_px, PLACE, atol=0.3)


def test_without_a_shadow_an_outline_stays_as_it_is() -> None:
    blob = found(on_table())
    np.testing.assert_allclose(blob.centroid_px, PLACE, atol=0.05)
    assert np.median(blob.sharpness) > 0.9


@pytest.mark.parametrize("depth", [0.0, 0.5])
def test_high_lights_at_the_rim_of_a_part_are_not_taken_for_its_shadow(depth: float) -> None:
    light, inside = on_table(depth, 28.0), discs([(*PLACE, RADIUS)], surface=1.0, background=0.0)
    for glint in (np.s_[188:200, 288:294], np.s_[218:222, 265:300], np.s_[200:204, 310:340]):
        light[glint] += inside[glint] * 80
    blob = found(light)
    assert not blob.fault
    assert blob.area_px2 == pytest.approx(np.pi * RADIUS**2, rel=0.03)
    np.testing.assert_allclose(blob.centroid_px, PLACE, atol=0.5)


def test_a_lens_that_is_softer_to_one_side_casts_no_shadow() -> None:
    light = on_table()
    soft = cv2.GaussianBlur(light, (0, 0), 1.6)
    left = np.linspace(-1, 1, 640)[None] * 640 < 2 * PLACE[0] - 640
    blob = found(np.where(left, soft, light))
    assert blob.area_px2 == pytest.approx(np.pi * RADIUS**2, rel=0.02)
    assert blob.fading == 0.0


def test_parts_that_only_their_shadows_join_come_apart() -> None:
    part = discs([(250.0, 220.0, 25.0), (330.0, 235.0, 25.0)], surface=1.0, background=0.0)
    shade = discs([(270.0, 230.0, 25.0), (300.0, 232.0, 25.0), (350.0, 245.0, 25.0)], surface=1.0, background=0.0)
    table = TABLE * (1 - 0.55 * cv2.GaussianBlur(shade, (0, 0), 4.0))
    image = grey_image(table + part * (PART - table), noise_dn=1.0)
    blobs = Detector(polarity="dark").detect(RectifiedPair(image, image, PARALLEL)).left
    assert [blob.fault for blob in blobs] == ["", ""]
    for blob, place in zip(blobs, [(250.0, 220.0), (330.0, 235.0)]):
        np.testing.assert_allclose(blob.centroid_px, place, atol=0.5)


@pytest.mark.parametrize("tones", [(40.0, 80.0), (80.0, 40.0), (35.0, 90.0)])
def test_a_lighter_part_that_a_shadow_joins_to_a_darker_one_is_not_lost_with_it(tones: tuple[float, float]) -> None:
    shade = discs([(270.0, 230.0, 25.0), (300.0, 232.0, 25.0), (350.0, 245.0, 25.0)], surface=1.0, background=0.0)
    light = TABLE * (1 - 0.45 * cv2.GaussianBlur(shade, (0, 0), 4.0))
    places = [(250.0, 220.0), (335.0, 235.0)]
    for place, tone in zip(places, tones):
        light += discs([(*place, 25.0)], surface=1.0, background=0.0) * (tone - light)
    image = grey_image(light, noise_dn=1.0)
    blobs = Detector(polarity="dark").detect(RectifiedPair(image, image, PARALLEL)).left
    assert len(blobs) == 2
    for blob, place in zip(blobs, places):
        np.testing.assert_allclose(blob.centroid_px, place, atol=1.0)


def test_a_part_whose_shadow_leaves_the_view_is_not_cut() -> None:
    part = discs([(300.0, 430.0, 25.0)], surface=1.0, background=0.0)
    shade = np.zeros_like(part)
    shade[440:, 290:330] = 1.0
    table = TABLE * (1 - 0.5 * cv2.GaussianBlur(shade, (0, 0), 4.0))
    blob = found(table + part * (PART - table))
    assert not blob.fault and not blob.cut
    np.testing.assert_allclose(blob.centroid_px, (300.0, 430.0), atol=0.5)


@pytest.mark.parametrize("blur_px", [0.7, 1.0, 1.5])
def test_the_blur_of_the_lens_is_that_of_the_sharper_edges(blur_px: float) -> None:
    image = grey_image(on_table(0.5, 28.0), blur_px, noise_dn=1.0)
    angle = np.linspace(0, 2 * np.pi, 180, endpoint=False)
    circle = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    lens = lens_blur_px([PLACE + RADIUS * circle, np.add(PLACE, (28, 14)) + RADIUS * circle], image)
    assert lens == pytest.approx(np.hypot(blur_px, 0.4), rel=0.2)


@pytest.mark.parametrize("lighter", [70.0, 100.0])
def test_a_dark_part_keeps_both_its_tones(lighter: float) -> None:
    """The top and the side of a box: the lighter one is no shadow, since it ends at once."""
    light = np.full((480, 640), TABLE)
    light[200:240, 280:340] = PART
    light[240:260, 280:340] = lighter
    blob = found(light)
    assert blob.area_px2 == pytest.approx(60 * 60, rel=0.02)
    np.testing.assert_allclose(blob.centroid_px, (309.5, 229.5), atol=0.3)


def outlined(fades: float) -> Blob:
    """A disc of whose outline this share fades."""
    angle = np.linspace(0, 2 * np.pi, 100, endpoint=False)
    contour = np.stack([200 + 20 * np.cos(angle), 200 + 20 * np.sin(angle)], axis=1)
    return Blob(contour, 100.0, sharpness=np.where(np.arange(100) < 100 * fades, 0.05, 0.9))


def test_fading_is_a_share_of_the_outline() -> None:
    assert outlined(0.3).fading == pytest.approx(0.3)
    assert Blob(outlined(0).contour_px, 100.0).fading == 0.0
