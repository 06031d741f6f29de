"""A learned background: what it stores, what it makes of other light, and what is found on it."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from families import staged
from marks import first_of
from outlines import PARALLEL, Disc, discs, grey_image, tiles
from rendering import Carton, Cylinder, Edge, Planks, Scene, Sensor, balls, render
from rigs import RIGS, SIZE_PX

from stereo_pick.core.arrays import Floats
from stereo_pick.core.errors import CalibrationError, ImageError, ParameterError
from stereo_pick.core.frames import RectifiedPair
from stereo_pick.core.objects import Blob, Detector
from stereo_pick.core.objects.background_files import load_background, save_background
from stereo_pick.core.objects.learned import MIN_PAIRS, NOISE_STEPS, BackgroundLearner, LearnedBackground
from stereo_pick.core.objects.learned import adjusted as adjusted_to
from stereo_pick.core.objects.view import View
from stereo_pick.core.rectification import Rectifier
from stereo_pick.core.rig import StereoRig
from stereo_pick.core.transform import Transform

PLACES: tuple[Disc, ...] = ((120.3, 100.7, 25.0), (300.0, 240.0, 18.0), (500.6, 380.2, 30.0))


def printed() -> Floats:
    """Light of a table with stripes, a bright print and an edge."""
    u = np.arange(SIZE_PX[0]) + np.zeros((SIZE_PX[1], 1))
    light = 60 + 3 * np.sign(np.sin(u / 9))
    light[150:300, 350:560] = 150.0
    light[:, 600:] = 25.0
    return np.asarray(light)


def pair_of(light: Floats, seed: int, noise_dn: float = 1.0) -> RectifiedPair:
    views = [grey_image(light, noise_dn=noise_dn, seed=2 * seed + side) for side in (0, 1)]
    return RectifiedPair(*views, PARALLEL)


def learned_from(light: Floats, pairs: int = 20, noise_dn: float = 1.0) -> LearnedBackground:
    learner = BackgroundLearner()
    for seed in range(pairs):
        learner.add(pair_of(light, seed, noise_dn))
    return learner.finished()


@cache
def learned_from_printed() -> LearnedBackground:
    return learned_from(printed())


@pytest.fixture(scope="module")
def file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("learned") / "background.npz"
    save_background(path, learned_from_printed())
    return path


def test_mean_and_noise_are_those_of_the_pairs() -> None:
    learned = learned_from(np.full(SIZE_PX[::-1], 80.4), noise_dn=2.0)
    for view in (learned.left, learned.right):
        assert view.mean.mean() == pytest.approx(80.4, abs=0.1)
        assert view.noise.mean() / NOISE_STEPS == pytest.approx(2.0, rel=0.05)


def test_a_file_holds_all_of_it(file: Path) -> None:
    learned, again = learned_from_printed(), load_background(file)
    assert (again.calibration_hash, again.pairs) == (learned.calibration_hash, 20)
    for side in ("left", "right"):
        one, other = getattr(learned, side), getattr(again, side)
        np.testing.assert_array_equal(one.mean, other.mean)
        np.testing.assert_array_equal(one.noise, other.noise)


@pytest.mark.parametrize("covered", [False, True])
@pytest.mark.parametrize(("gain", "offset"), [(1.0, 0.0), (0.6, 20.0), (1.5, -10.0)])
def test_it_follows_the_light_whatever_lies_on_it(gain: float, offset: float, covered: bool) -> None:
    shown = gain * printed() + offset
    follows_the_light(shown, np.s_[100:400, 60:440] if covered else None)


@pytest.mark.parametrize("covered", [False, True])
@pytest.mark.parametrize(("gain", "offset"), [(1.0, 0.0), (0.6, 20.0), (0.9, -10.0)])
def test_it_follows_a_lamp_that_was_moved(gain: float, offset: float, covered: bool) -> None:
    """It is nearer to the right border then, where all is more than twice as bright as at the left one."""
    slope = 1 + 0.4 * np.linspace(-1, 1, SIZE_PX[0])
    follows_the_light(gain * slope * printed() + offset, np.s_[100:250, 60:340] if covered else None)


def follows_the_light(light: Floats, covered: tuple[slice, slice] | None) -> None:
    """Assert that the learned surface is found in this light, though something bright covers a part of it."""
    shown = light.copy()
    if covered:
        shown[covered] = 230.0
    image = grey_image(shown, noise_dn=1.0, seed=99)
    camera = PARALLEL.left
    found = adjusted_to(learned_from_printed().left, View.of(image, camera), camera)
    assert np.abs(found.level - View.of(grey_image(light), camera).smooth).max() < 2.0
    assert found.sigma < 1.5


def test_where_the_surface_flickers_more_is_asked_of_an_object(tmp_path: Path) -> None:
    learner, rng = BackgroundLearner(), np.random.default_rng(5)
    lamp = discs([(300.0, 240.0, 40.0)], surface=1.0, background=0.0)
    for seed in range(20):
        learner.add(pair_of(60 + rng.normal(0, 15) * lamp, seed))
    save_background(tmp_path / "b.npz", learner.finished())
    detector = Detector(background_file=str(tmp_path / "b.npz"))
    still = detector.detect(pair_of(60 + 30 * discs([(120.0, 100.0, 40.0)], 1.0, 0.0), 50))
    assert len(still.left) == 1
    assert not detector.detect(pair_of(60 + 30 * lamp, 51)).left


def test_parts_that_bold_tiles_would_hide_are_found_once_these_are_learned(tmp_path: Path) -> None:
    table = tiles(100, 180)
    save_background(tmp_path / "tiles.npz", learned_from(table))
    pair = pair_of(discs(PLACES, surface=215.0, background=table), seed=77)
    assert Detector().detect(pair).view_faults == ("uneven", "uneven")
    blobs = Detector(background_file=str(tmp_path / "tiles.npz")).detect(pair)
    assert blobs.view_faults == ("", "")
    np.testing.assert_allclose(sound_px(blobs.left), np.array(PLACES)[:, :2], atol=0.3)


def sound_px(blobs: tuple[Blob, ...]) -> Floats:
    return np.array([blob.centroid_px for blob in blobs if not blob.fault]).reshape(-1, 2)


@pytest.mark.parametrize("gain", [1.0, 0.7])
def test_parts_on_a_printed_table_are_found_and_prints_are_not(file: Path, gain: float) -> None:
    pair = pair_of(gain * discs(PLACES, surface=200.0, background=printed()), seed=77)
    blobs = Detector(background_file=str(file)).detect(pair)
    assert len(blobs.left) == len(blobs.right) == len(PLACES)
    np.testing.assert_allclose(sound_px(blobs.left), np.array(PLACES)[:, :2], atol=0.3)
    without = Detector().detect(pair)
    assert len(without.left) > len(PLACES), "the prints are taken for objects where nothing was learned"


@pytest.mark.parametrize("pushed_px", [1, 4])
def test_where_the_table_was_pushed_its_prints_are_no_objects(file: Path, pushed_px: int) -> None:
    """Of each print an edge would be left over at either side."""
    table = np.roll(printed(), pushed_px, axis=1)
    blobs = Detector(background_file=str(file)).detect(pair_of(discs(PLACES, surface=200.0, background=table), seed=77))
    assert blobs.moved_px == pytest.approx(pushed_px, abs=0.2)
    np.testing.assert_allclose(sound_px(blobs.left), np.array(PLACES)[:, :2], atol=0.3)


def test_an_empty_printed_table_is_empty(file: Path) -> None:
    blobs = Detector(background_file=str(file)).detect(pair_of(printed(), seed=78))
    assert not blobs.left and not blobs.right


LIT = {"ambient": 0.9, "table_albedo": 0.2}
PARTS = (Cylinder(-0.08, -0.03, (0.05, 0.05, 0.05), albedo=0.8), *balls((0.0, 0.06, 0.05), (0.08, 0.0, 0.04)))
PAINTS = {
    "planks": (Planks(contrast=0.3),),
    "cartons": (Carton(0.08, 0.0, 0.12, 0.1, 0.4, albedo=0.5), Carton(-0.1, 0.05, 0.1, 0.08, 1.2, albedo=0.35)),
    "edge": (Edge(0.06, 0.7, beyond=0.45),),
}


@cache
def empty_and_full(paint: str) -> tuple[StereoRig, list[RectifiedPair], RectifiedPair]:
    rig = RIGS["thesis"]
    scene, rectify = Scene(PARTS, paints=PAINTS[paint], **LIT), Rectifier(rig).rectify
    empty = replace(scene, solids=())
    sensor = Sensor(gain=0.9, noise_dn=1.0)
    learned = [rectify(render(rig, empty, sensor, sensor, seed)) for seed in range(MIN_PAIRS)]
    dimmer = Sensor(gain=0.75, offset_dn=6.0)
    return rig, learned, rectify(render(rig, scene, dimmer, dimmer, seed=50))


@pytest.mark.parametrize("paint", [*first_of("cartons", "planks"), "edge"])
def test_rendered_parts_are_found_on_planks_cartons_and_at_the_edge(paint: str, tmp_path: Path) -> None:
    rig, empty, full = empty_and_full(paint)
    learner = BackgroundLearner()
    for pair in empty:
        learner.add(pair)
    save_background(tmp_path / "b.npz", learner.finished())
    blobs = Detector(background_file=str(tmp_path / "b.npz")).detect(full)
    centres = Scene(PARTS).positions_m()
    for found, camera, xyz in (
        (blobs.left, rig.left, centres),
        (blobs.right, rig.right, rig.right_T_left.apply(centres)),
    ):
        expected = camera.rectified(camera.project(xyz))
        assert len(found) == len(PARTS)
        distance = np.linalg.norm(sound_px(found)[:, None] - expected[None], axis=2)
        assert (distance.min(axis=0) < 6).all(), "a part is missing, or a piece of one was taken for it"


@pytest.mark.parametrize(("family", "seed"), [("table_edge", 3), ("table_edge", 4)])
def test_the_families_tables_are_no_objects_once_learned(family: str, seed: int, tmp_path: Path) -> None:
    scene = staged(family, seed)
    rectify, noise = Rectifier(scene.rig).rectify, range(100, 100 + MIN_PAIRS)
    learner = BackgroundLearner()
    for each in noise:
        empty = replace(scene, scene=replace(scene.scene, solids=()), noise_seed=each)
        learner.add(rectify(empty.taken()[0]))
    save_background(tmp_path / "b.npz", learner.finished())
    frame, truth = scene.taken()
    blobs = Detector(background_file=str(tmp_path / "b.npz")).detect(rectify(frame))
    assert len(blobs.sound()[0]) >= sum(each.required for each in truth.objects)
    assert not any(blob.fault == "cut_by_border" for blob in blobs.left + blobs.right)


def test_another_calibration_is_refused(file: Path) -> None:
    pair, other = pair_of(printed(), 3), RIGS["parallel"]
    with pytest.raises(CalibrationError, match=r"another calibration \(\w{12}\).*learn it again"):
        Detector(background_file=str(file)).detect(RectifiedPair(pair.left, pair.right, other))


def test_another_size_is_refused(tmp_path: Path) -> None:
    small = learned_from(printed(), pairs=3)
    cut = replace(small, left=type(small.left)(small.left.mean[:100].copy(), small.left.noise[:100].copy()))
    with pytest.raises(CalibrationError, match="left images of 640 x 100, but the calibration is for 640 x 480"):
        cut.check(PARALLEL)


def test_a_calibration_that_changes_while_learning_is_noticed() -> None:
    learner, pair = BackgroundLearner(), pair_of(printed(), 3)
    learner.add(pair)
    with pytest.raises(CalibrationError, match="changed while"):
        learner.add(RectifiedPair(pair.left, pair.right, RIGS["parallel"]))


def test_too_few_pairs_are_refused() -> None:
    with pytest.raises(ImageError, match="2 pairs are too few"):
        learned_from(printed(), pairs=2)


@pytest.mark.parametrize(
    ("level", "complaint"),
    [(0.0, "black all over.*lens cap"), (14.0, "black all over"), (255.0, "white all over.*expos")],
)
@pytest.mark.parametrize("side", ["left", "right"])
def test_a_view_that_shows_nothing_is_no_background(side: str, level: float, complaint: str) -> None:
    learner = BackgroundLearner()
    for seed in range(MIN_PAIRS):
        blank = grey_image(np.full(SIZE_PX[::-1], level), noise_dn=0.5, seed=seed)
        learner.add(replace(pair_of(printed(), seed), **{side: blank}))
    with pytest.raises(ImageError, match=f"the {side} view is {complaint}"):
        learner.finished()


@pytest.mark.parametrize(("level", "light"), [(3.0, 40.0), (255.0, 120.0)])
def test_a_view_that_is_black_or_white_but_for_some_of_it_is_learned(level: float, light: float) -> None:
    surface = np.full(SIZE_PX[::-1], level)
    surface[100:150, 200:300] = light
    assert learned_from(surface, MIN_PAIRS).left.mean[120, 250] == pytest.approx(light, abs=2.0)


def test_a_file_that_is_not_there_yet_is_asked_for_when_it_is_needed(tmp_path: Path) -> None:
    detector = Detector(background_file=str(tmp_path / "later.npz"))
    with pytest.raises(ImageError, match=r"later.npz: no such file; learn it with"):
        detector.detect(pair_of(printed(), 3))
    with pytest.raises(ParameterError, match=r"it is a folder; learn it with"):
        Detector(background_file=str(tmp_path))
    assert Detector(threshold="otsu", background_file="nowhere.npz").detect(pair_of(discs(PLACES), 3)).left


@pytest.mark.parametrize("content", [b"", b"nonsense", b"PK\x03\x04 cut"], ids=["empty", "text", "cut"])
def test_a_file_that_is_no_background_is_refused_when_it_is_set(content: bytes, tmp_path: Path) -> None:
    path = tmp_path / "b.npz"
    path.write_bytes(content)
    with pytest.raises(ParameterError, match=r"^background_file: .*b.npz is no background, damaged"):
        Detector(background_file=str(path))


def test_a_foreign_archive_is_refused(tmp_path: Path) -> None:
    np.savez(tmp_path / "b.npz", left=np.zeros(3))
    with pytest.raises(ImageError, match="is no background"):
        load_background(tmp_path / "b.npz")


def test_an_unwritable_place_is_named(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("x")
    with pytest.raises(ImageError, match="cannot be written"):
        save_background(tmp_path / "file" / "b.npz", learned_from(printed(), pairs=3))


def test_planks_that_were_moved_too_far_are_read_as_if_nothing_was_learned(tmp_path: Path) -> None:
    there = staged("planks_and_prints", 2)
    rectify = Rectifier(there.rig).rectify
    learner = BackgroundLearner()
    for seed in range(MIN_PAIRS):
        learner.add(rectify(render(there.rig, replace(there.scene, solids=()), there.left, there.right, seed)))
    save_background(tmp_path / "planks.npz", learner.finished())
    table = there.scene.left_T_table
    moved = replace(there.scene, left_T_table=Transform(table.rotation, table.translation + (0.03, 0.0, 0.0)))
    pair = rectify(render(there.rig, moved, there.left, there.right, seed=7))
    blobs, without = Detector(background_file=str(tmp_path / "planks.npz")).detect(pair), Detector().detect(pair)
    assert blobs.moved_px == np.inf and without.moved_px == 0.0
    np.testing.assert_array_equal(sound_px(blobs.left), sound_px(without.left))
