"""Solids brought onto the edges near them, and what of them the edges support."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import cv2
import numpy as np
import pytest
from rendered_solids import PARTS, PLACED, RIG, centre_m, rectified, solid_of
from rendering import Lamp, Scene, Solid, Sphere
from rigs import rotation

from stereo_pick.core.edges.edge_map import USUAL_BLUR_PX, EdgeMap
from stereo_pick.core.edges.hypotheses import Images
from stereo_pick.core.edges.locking import Locked, lock
from stereo_pick.core.shapes.fitting import NOISE_PX
from stereo_pick.core.shapes.solids import Solids

SCENE = Scene(tuple(PARTS.values()), PLACED, ambient=0.7)
TRIALS = 12


@cache
def images(empty: bool = False) -> Images:
    return Images(rectified(RIG, Scene((), PLACED) if empty else SCENE))


def locked(solid: Solids, seen: Images) -> Locked:
    return lock(solid, seen.maps, RIG)


def moved(part: Solid, random: np.random.Generator, off_m: float, off_deg: float) -> Solids:
    axis, shift = random.normal(size=(2, 3))
    turned = rotation(axis * np.deg2rad(off_deg) / np.linalg.norm(axis))
    solid = solid_of(RIG, SCENE, part, turned=turned)
    return replace(solid, centre_m=solid.centre_m + shift * off_m / np.linalg.norm(shift))


@pytest.mark.parametrize("name", PARTS)
def test_from_2_mm_and_2_degrees_off_the_truth_is_found(name: str) -> None:
    """A start from which it is not found has less support than any from which it is."""
    random, truth = np.random.default_rng(1), centre_m(RIG, SCENE, PARTS[name])
    found = [locked(moved(PARTS[name], random, 2e-3, 2.0), images()) for _ in range(TRIALS)]
    off_m = np.array([np.linalg.norm(each.fit.solids.centre_m[0] - truth) for each in found])
    shown = np.array([each.shown.min() for each in found])
    assert (off_m < 3e-4).sum() >= 0.75 * TRIALS
    assert (shown[off_m < 3e-4] > 0.95).all() and (shown[off_m >= 3e-4] < 0.9).all()


@pytest.mark.parametrize("ambient", [0.0, 0.3, 0.5])
def test_the_limb_of_a_dark_ball_that_darkens_towards_it_is_no_shadow(ambient: float) -> None:
    ball = Sphere(0.0, 0.0, (0.05, 0.05, 0.05), albedo=0.18)
    scene = Scene((ball,), PLACED, table_albedo=0.2, lamps=(Lamp((0.0, -0.6, 0.8)),), ambient=ambient)
    truth = solid_of(RIG, scene, ball)
    found = lock(truth, Images(rectified(RIG, scene)).maps, RIG)
    np.testing.assert_allclose(found.fit.solids.half_m, truth.half_m, atol=1e-4)
    assert found.shown.min() > 0.95


@pytest.mark.parametrize("name", PARTS)
def test_several_at_once_end_in_their_rows_as_each_does_alone(name: str) -> None:
    """Also beside some that find no edges."""
    random, solid = np.random.default_rng(2), solid_of(RIG, SCENE, PARTS[name])
    away_m = RIG.left.R @ PLACED.rotation @ np.array([0.06, -0.05, 0.0])
    away = replace(solid, centre_m=solid.centre_m + away_m)
    several = [away, moved(PARTS[name], random, 5e-4, 0.5), away, solid, moved(PARTS[name], random, 5e-4, 0.5)]
    together = lock(Solids.joined(several), images().maps, RIG)
    assert (together.shown.min(axis=1) > 0.9).tolist() == [False, True, False, True, True]
    for row, each in enumerate(several):
        alone = locked(each, images())
        off_m = np.linalg.norm(together.fit.solids.centre_m[row] - alone.fit.solids.centre_m[0])
        assert off_m < (1e-4 if together.shown[row].min() > 0.9 else 0.02)


@pytest.mark.parametrize("name", PARTS)
def test_where_there_is_no_object_there_is_no_support(name: str) -> None:
    solid = solid_of(RIG, SCENE, PARTS[name])
    assert locked(solid, images(empty=True)).shown.min() < 0.4
    away = RIG.left.R @ PLACED.rotation @ np.array([0.03, 0.03, 0.0])
    beside = images().locked(replace(solid, centre_m=solid.centre_m + away))
    assert beside.support < 0.4 and not beside.believable and not beside.raises_doubt


@pytest.mark.parametrize("name", PARTS)
def test_only_a_solid_on_edges_all_around_is_believable(name: str) -> None:
    solid, seen = solid_of(RIG, SCENE, PARTS[name]), images()
    true = seen.locked(solid)
    assert true.believable and true.raises_doubt and true.support > 0.95
    larger = seen.locked(replace(solid, half_m=1.5 * solid.half_m))
    assert not larger.believable and larger.support < true.support


@pytest.mark.parametrize("contrast", [8.0, -8.0])
def test_edges_of_either_sign_count_across_their_normal_only(contrast: float) -> None:
    image = np.full((480, 640), 90, np.uint8)
    image[:, 300:] = 90 + contrast
    edges = EdgeMap.of(image, RIG.left)
    rows = np.arange(100.0, 140.0)
    across, along = np.tile([1.0, 0.0], (40, 1)), np.tile([0.0, 1.0], (40, 1))
    on, beside = np.c_[np.full(40, 299.5), rows], np.c_[np.full(40, 320.0), rows]
    assert edges.shows(on, across, 1.5).all()
    assert not edges.shows(on, along, 1.5).any() and not edges.shows(beside, across, 1.5).any()


def test_noise_is_no_edge() -> None:
    image = np.clip(np.random.default_rng(3).normal(90, 2, (480, 640)).round(), 0, 255).astype(np.uint8)
    points = np.random.default_rng(4).uniform(20, 400, (4000, 2))
    assert EdgeMap.of(image, RIG.left).shows(points, np.tile([0.6, 0.8], (4000, 1)), 1.5).mean() < 0.01


def changed(blur_px: float, noise: float, known_blur_px: float) -> Images:
    """The scene further blurred, and with noise added."""
    random, pair = np.random.default_rng(5), rectified(RIG, SCENE)
    seen = [cv2.GaussianBlur(grey.astype(np.float32), (0, 0), max(blur_px, 0.01)) for grey in (pair.left, pair.right)]
    left, right = ((grey + random.normal(0, noise, grey.shape)).round().clip(0, 255).astype(np.uint8) for grey in seen)
    return Images(replace(pair, left=left, right=right), (known_blur_px, known_blur_px))


@pytest.mark.parametrize("noise", [6.0, 12.0])
def test_noise_moves_edges_as_far_as_is_stated(noise: float) -> None:
    seen, off = changed(0.0, noise, USUAL_BLUR_PX), []
    for part in PARTS.values():
        found = locked(solid_of(RIG, SCENE, part), seen)
        held = found.fit.weight > 0
        off += list(found.fit.residual_px[held] / found.sigma_px[held])
    assert 0.7 < 1.4826 * np.median(np.abs(off)) < 1.4


def test_what_noise_alone_moves_does_not_speak_against_a_solid() -> None:
    truth = solid_of(RIG, SCENE, PARTS["sphere"])
    much, more = (changed(0.0, noise, USUAL_BLUR_PX).locked(truth) for noise in (25.0, 60.0))
    assert much.off_px < NOISE_PX and more.off_px < NOISE_PX
    assert more.fit.residual_px > 2 * NOISE_PX > much.fit.residual_px > NOISE_PX


@pytest.mark.parametrize("name", PARTS)
def test_a_view_out_of_focus_is_read_with_its_own_blur(name: str) -> None:
    truth = solid_of(RIG, SCENE, PARTS[name])
    own, usual = (locked(truth, changed(1.5, 1.0, blur_px)) for blur_px in (1.7, USUAL_BLUR_PX))
    assert np.linalg.norm(own.fit.solids.centre_m[0] - truth.centre_m[0]) < 4e-4
    assert own.shown.min() > 0.9 and own.shown.min() > usual.shown.min()
