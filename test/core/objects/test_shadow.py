"""Dark parts and their shadows: what fades at its rim is no part of an object."""

from __future__ import annotations

import cv2
import numpy as np
import pytest
from outlines import PARALLEL, discs, grey_image

from stereo_pick.core.arrays import Floats
from stereo_pick.core.frames import RectifiedPair
from stereo_pick.core.objects import Blob, Detector
from stereo_pick.core.objects.shadow import clearer, may_hold_shadow

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


def test_without_a_shadow_nothing_is_looked_for() -> None:
    blob = found(on_table())
    assert not may_hold_shadow(blob)
    np.testing.assert_allclose(blob.centroid_px, PLACE, atol=0.05)


@pytest.mark.parametrize("lighter", [70.0, 100.0])
def test_a_dark_part_keeps_both_its_tones(lighter: float) -> None:
    """The top and the side of a box: the lighter one is no shadow, since it ends at once."""
    light = np.full((480, 640), TABLE)
    light[200:240, 280:340] = PART
    light[240:260, 280:340] = lighter
    blob = found(light)
    assert blob.area_px2 == pytest.approx(60 * 60, rel=0.02)
    np.testing.assert_allclose(blob.centroid_px, (309.5, 229.5), atol=0.3)


def outlined(radius_px: float, fades: float, notched: bool = False) -> Blob:
    """A disc of whose outline this share fades."""
    angle = np.linspace(0, 2 * np.pi, 100, endpoint=False)
    reach = np.where(notched & (np.arange(100) < 10), 0.6, 1.0) * radius_px
    contour = np.stack([200 + reach * np.cos(angle), 200 + reach * np.sin(angle)], axis=1)
    return Blob(contour, 100.0, sharpness=np.where(np.arange(100) < 100 * fades, 0.05, 0.9))


def test_fading_is_a_share_of_the_outline() -> None:
    assert outlined(20, 0.3).fading == pytest.approx(0.3)
    assert Blob(outlined(20, 0).contour_px, 100.0).fading == 0.0
    assert may_hold_shadow(outlined(20, 0.1)) and not may_hold_shadow(outlined(20, 0.04))


def test_only_what_is_clearly_sharper_and_has_no_notch_takes_the_place_of_the_whole() -> None:
    whole = outlined(30, 0.4)
    assert clearer([outlined(20, 0.1)], whole)
    assert clearer([outlined(20, 0.0), outlined(15, 0.2)], whole)
    assert not clearer([outlined(20, 0.25)], whole)
    assert not clearer([outlined(20, 0.0, notched=True)], whole)
    assert not clearer([], whole)
