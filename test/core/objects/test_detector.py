"""Segmentation on drawn views: what is there is found at its place, and nothing else."""

from __future__ import annotations

import numpy as np
import pytest
from families import staged
from outlines import PARALLEL, Disc, blank_pair, discs, grey_image, pattern
from rendering import Scene, Sensor, balls, render
from rigs import RIGS, SIZE_PX

from stereo_pick.core.arrays import Floats, Image
from stereo_pick.core.errors import ParameterError
from stereo_pick.core.frames import RectifiedPair
from stereo_pick.core.objects import Blob, Blobs, Detector
from stereo_pick.core.rectification import Rectifier

PLACES: tuple[Disc, ...] = ((120.3, 100.7, 25.0), (300.0, 240.0, 18.0), (500.6, 380.2, 30.0))
THRESHOLDS = ("background", "otsu", "fixed")


def found(light: Floats, detector: Detector | None = None, noise_dn: float = 1.0) -> Blobs:
    """What the detector finds in two views of this light that differ in their noise."""
    views = [grey_image(light, noise_dn=noise_dn, seed=seed) for seed in (1, 2)]
    return (detector or Detector()).detect(RectifiedPair(*views, PARALLEL))


def faults(blobs: tuple[Blob, ...]) -> list[str]:
    return [blob.fault for blob in blobs]


def centroids(blobs: tuple[Blob, ...]) -> Floats:
    return np.array([blob.centroid_px for blob in blobs]).reshape(-1, 2)


def places(*of: Disc) -> Floats:
    return np.array(of)[:, :2]


@pytest.mark.parametrize("threshold", THRESHOLDS)
@pytest.mark.parametrize(("surface", "background"), [(200.0, 50.0), (40.0, 190.0)], ids=["bright", "dark"])
def test_parts_are_found_in_both_views_whatever_their_polarity(
    threshold: str, surface: float, background: float
) -> None:
    blobs = found(discs(PLACES, surface, background), Detector(threshold=threshold))
    assert blobs.polarity == ("bright" if surface > background else "dark")
    for view in (blobs.left, blobs.right):
        assert faults(view) == ["", "", ""]
        np.testing.assert_allclose(centroids(view), places(*PLACES), atol=0.05)


@pytest.mark.parametrize("polarity", ["bright", "dark"])
def test_a_polarity_that_is_given_is_kept(polarity: str) -> None:
    light = discs(PLACES[:1], 200.0, 110.0)
    dark = discs(PLACES[1:2], 20.0, 110.0)
    light[dark < 110] = dark[dark < 110]
    blobs = found(light, Detector(polarity=polarity))
    expected = PLACES[0] if polarity == "bright" else PLACES[1]
    np.testing.assert_allclose(centroids(blobs.left), places(expected), atol=0.05)


def test_sub_pixel_outlines_have_the_true_area_and_centroid() -> None:
    rng = np.random.default_rng(0)
    for _ in range(5):
        disc = (float(rng.uniform(250, 260)), float(rng.uniform(200, 210)), float(rng.uniform(10, 40)))
        (blob,) = found(discs([disc])).left
        np.testing.assert_allclose(blob.centroid_px, disc[:2], atol=0.05)
        assert blob.area_px2 == pytest.approx(np.pi * disc[2] ** 2, rel=0.01)


@pytest.mark.parametrize("name", RIGS)
def test_the_centroid_of_a_rendered_ball_is_that_of_its_ellipse(name: str) -> None:
    rig, scene = RIGS[name], Scene(balls((0.01, 0.02, 0.05)), ambient=1.0)
    blobs = Detector().detect(Rectifier(rig).rectify(render(rig, scene, Sensor(), Sensor())))
    in_cameras = scene.positions_m(), rig.right_T_left.apply(scene.positions_m())
    for lens, centre, (blob,) in zip((rig.left, rig.right), in_cameras, (blobs.left, blobs.right)):
        x, y, z = lens.R @ centre[0]
        ellipse = lens.P[0, 0] * np.array([x, y]) * z / (z**2 - 0.025**2) + lens.P[:2, 2]
        np.testing.assert_allclose(blob.centroid_px, ellipse, atol=0.05)


@pytest.mark.parametrize("noise_dn", [0.0, 1.0, 4.0])
@pytest.mark.parametrize("level", [10.0, 128.0, 240.0])
def test_an_empty_table_gives_nothing(noise_dn: float, level: float) -> None:
    blobs = found(np.full(SIZE_PX[::-1], level), noise_dn=noise_dn)
    assert not blobs.left and not blobs.right


@pytest.mark.parametrize("threshold", ["background", "fixed"])
def test_an_unevenly_lit_empty_table_gives_nothing(threshold: str) -> None:
    blobs = found(gradient(), Detector(threshold=threshold, fixed_threshold=200))
    assert not blobs.left and not blobs.right


def gradient() -> Floats:
    """Light that falls off from 90 to 30 across the view."""
    u, v = np.meshgrid(np.linspace(0, 1, SIZE_PX[0]), np.linspace(0, 1, SIZE_PX[1]))
    return np.asarray(90 - 45 * u - 15 * v**2)


def test_a_gradient_across_the_table_hides_and_shifts_nothing() -> None:
    places_there = ((60.4, 60.2, 20.0), (580.3, 60.8, 20.0), (320.1, 240.0, 20.0), (580.0, 420.7, 20.0))
    blobs = found(discs(places_there, surface=150.0, background=gradient()))
    assert faults(blobs.left) == [""] * 4
    order = np.argsort([x for x, _, _ in places_there])
    by_column = sorted(blobs.left, key=lambda blob: (round(float(blob.centroid_px[0])), blob.centroid_px[1]))
    expected = sorted((places_there[i] for i in order), key=lambda place: (round(place[0]), place[1]))
    np.testing.assert_allclose(centroids(tuple(by_column)), places(*expected), atol=0.1)


@pytest.mark.parametrize("threshold", ["background", "fixed"])
def test_salt_and_pepper_gives_nothing_and_moves_nothing(threshold: str) -> None:
    """One pixel in two hundred."""
    rng, light = np.random.default_rng(3), discs(PLACES)
    views: list[Image] = []
    for _ in range(2):
        view = grey_image(light, noise_dn=1.0)
        struck = rng.random(view.shape)
        view[struck < 0.0025], view[struck > 0.9975] = 255, 0
        views.append(view)
    blobs = Detector(threshold=threshold).detect(RectifiedPair(*views, PARALLEL))
    for view in (blobs.left, blobs.right):
        assert faults(view) == ["", "", ""]
        np.testing.assert_allclose(centroids(view), places(*PLACES), atol=0.3)


@pytest.mark.parametrize(("radius_px", "count"), [(4.1, 0), (4.7, 1)])
def test_fewer_pixels_than_the_thesiss_60_are_noise(radius_px: float, count: int) -> None:
    """53 and 69 pixels, counted at the half-way level."""
    half_way = Detector(threshold="fixed", fixed_threshold=125)
    assert len(found(discs([(200.0, 200.0, radius_px)]), half_way).left) == count


def test_a_speck_is_noise_whatever_the_threshold() -> None:
    for threshold in THRESHOLDS:
        assert len(found(discs([PLACES[0], (400.0, 100.0, 2.0)]), Detector(threshold=threshold)).left) == 1


def test_the_least_area_is_a_parameter() -> None:
    light = discs(PLACES)
    assert len(found(light, Detector(min_area_px=1500)).left) == 2
    assert len(found(light, Detector(min_area_px=100000)).left) == 0


def test_holes_are_filled() -> None:
    light = discs([(300.0, 240.0, 30.0)])
    ring = discs([(300.0, 240.0, 12.0)], surface=50.0, background=light)
    (blob,) = found(ring).left
    np.testing.assert_allclose(blob.centroid_px, (300, 240), atol=0.05)
    assert blob.area_px2 == pytest.approx(np.pi * 30**2, rel=0.01)


def test_a_hair_line_gap_is_closed_and_one_part_stays_one() -> None:
    light = discs([(300.0, 240.0, 30.0)])
    light[240, 270:331] = 50.0
    assert len(found(light, noise_dn=0.0).left) == 1


@pytest.mark.parametrize("place", [(10.0, 240.0), (632.0, 240.0), (300.0, 6.0), (300.0, 474.0)], ids=str)
def test_a_part_that_reaches_the_border_is_refused(place: tuple[float, float]) -> None:
    down, right = round(place[1]) - 240, round(place[0]) - 320
    light = np.roll(discs([(320.0, 240.0, 20.0)]), (down, right), axis=(0, 1))
    light[: max(0, down - 100)] = light[SIZE_PX[1] + min(0, down + 100) :] = 50.0
    light[:, : max(0, right - 100)] = light[:, SIZE_PX[0] + min(0, right + 100) :] = 50.0
    blobs = found(light)
    assert faults(blobs.left) == faults(blobs.right) == ["cut_by_border"]


@pytest.mark.parametrize("gap_px", [-4.0, -1.0])
def test_touching_parts_are_refused_not_taken_for_one(gap_px: float) -> None:
    blobs = found(discs([(280.0, 240.0, 20.0), (320.0 + gap_px, 240.0, 20.0)]))
    assert faults(blobs.left) == ["merged"]


def test_parts_that_stand_apart_are_two() -> None:
    assert faults(found(discs([(280.0, 240.0, 20.0), (326.0, 240.0, 20.0)])).left) == ["", ""]


def test_a_touching_pair_is_accepted_where_the_user_says_so() -> None:
    light = discs([(280.0, 240.0, 20.0), (316.0, 240.0, 20.0)])
    assert faults(found(light, Detector(max_concavity=10.0)).left) == [""]


def test_a_stain_is_refused_as_faint() -> None:
    light = discs(PLACES[1:], background=discs(PLACES[:1], surface=58.0))
    assert faults(found(light, noise_dn=0.5).left) == ["faint", "", ""]


def test_low_contrast_is_enough_on_a_quiet_table() -> None:
    """Where Otsu and a raw threshold lose half of the parts."""
    blobs = found(discs(PLACES, surface=68.0, background=50.0), noise_dn=1.0)
    assert faults(blobs.left) == faults(blobs.right) == ["", "", ""]
    np.testing.assert_allclose(centroids(blobs.left), places(*PLACES), atol=0.15)


def test_gain_and_offset_of_one_camera_change_nothing() -> None:
    light = discs(PLACES)
    views = grey_image(light, noise_dn=1.0), grey_image(0.5 * light + 30, noise_dn=1.0, seed=1)
    blobs = Detector().detect(RectifiedPair(*views, PARALLEL))
    np.testing.assert_allclose(centroids(blobs.left), centroids(blobs.right), atol=0.05)


def test_the_region_of_interest_counts_in_columns_of_the_left_view_only() -> None:
    light = discs(PLACES)
    region = Detector(roi_x_px=250, roi_width_px=100, roi_y_px=200, roi_height_px=250)
    blobs = found(light, region)
    np.testing.assert_allclose(centroids(blobs.left), places(PLACES[1]), atol=0.05)
    np.testing.assert_allclose(centroids(blobs.right), places(*PLACES[1:]), atol=0.05)


def test_whole_pixel_outlines_run_through_pixel_centres() -> None:
    (blob,) = found(discs([(300.3, 240.0, 20.0)]), Detector(subpixel=False)).left
    np.testing.assert_array_equal(blob.contour_px, np.round(blob.contour_px))


def test_parts_come_from_left_to_right() -> None:
    columns = centroids(found(discs(PLACES[::-1])).left)[:, 0]
    assert (np.diff(columns) > 0).all()


def notched(pattern_seed: int | None) -> Blob:
    """A disc with two notches as deep as a sixth of it, even or with a pattern of cells as large as they."""
    part = discs([(300.0, 240.0, 40.0)], surface=1.0, background=0.0)
    for row in (225, 255):
        part[row : row + 7, 255:278] = 0.0
    light = np.full(part.shape, 120.0)
    if pattern_seed is not None:
        v, u = np.mgrid[: part.shape[0], : part.shape[1]].astype(float)
        light += pattern(pattern_seed)(u, v) - 120
    image = grey_image(50 + part * np.clip(light, 60, 200), noise_dn=1.0)
    (blob,) = Detector(polarity="bright").detect(RectifiedPair(image, image, PARALLEL)).left
    return blob


@pytest.mark.parametrize("seed", range(4))
def test_dark_places_of_a_pattern_leave_no_notches_at_its_rim(seed: int) -> None:
    blob = notched(seed)
    assert not blob.fault
    assert blob.area_px2 == pytest.approx(np.pi * 40**2, rel=0.02)


def test_an_even_part_keeps_its_notches() -> None:
    assert notched(None).concavity > 0.12


def test_bright_parts_with_dark_sides_are_more_than_their_shadows() -> None:
    scene = staged("two_cylinders", 23)
    frame, truth = scene.taken()
    blobs = Detector().detect(Rectifier(scene.rig).rectify(frame))
    assert blobs.polarity == "bright"
    assert len(blobs.left) == len(blobs.right) == len(truth.objects)


@pytest.mark.parametrize(
    ("values", "says"),
    [
        (
            {"roi_x_px": 640, "roi_width_px": 10},
            "segmentation.roi_x_px = 640 is outside of the image, which is 640 x 480",
        ),
        ({"roi_y_px": 480, "roi_height_px": 10}, "segmentation.roi_y_px = 480 is outside of the image"),
        ({"roi_x_px": 5}, "roi_x_px = 5 needs roi_width_px"),
        ({"roi_y_px": 5, "roi_width_px": 9}, "roi_y_px = 5 needs roi_height_px"),
    ],
)
def test_a_region_that_holds_nothing_is_refused(values: dict[str, int], says: str) -> None:
    with pytest.raises(ParameterError, match=says):
        Detector(**values).detect(blank_pair())


FRAME: Disc = (320.0, 240.0, 200.0)


def framed(inner: Disc, hole_px: float, within: float = 200.0) -> Floats:
    """A bright ring about the middle of a dark view, and a disc, bright as well, in its hole."""
    x, y, _ = FRAME
    light, hole = discs((FRAME,), 200.0, 50.0), discs(((x, y, hole_px),), 1.0, 0.0)
    light = light * (1 - hole) + 50.0 * hole
    there = discs((inner,), 1.0, 0.0)
    return np.asarray(light * (1 - there) + within * there)


@pytest.mark.parametrize("within", [120.0, 200.0])
def test_what_lies_within_a_frame_is_found(within: float) -> None:
    """As parts in a container, whose walls are as bright: they were a part of it."""
    inner = (280.4, 200.8, 25.0)
    blobs = found(framed(inner, hole_px=190.0, within=within))
    small = [blob for blob in blobs.left if blob.rectangle[0] < 100]
    np.testing.assert_allclose(centroids(tuple(small)), places(inner), atol=0.1)
    assert faults(tuple(small)) == [""] and len(blobs.left) == 2


@pytest.mark.parametrize(("inner", "hole_px"), [((320.0, 240.0, 25.0), 60.0), ((320.0, 240.0, 160.0), 170.0)])
def test_a_part_with_a_hole_is_one(inner: Disc, hole_px: float) -> None:
    """A spot in a pattern is no part of its own, nor is the table that is seen through a tube."""
    assert len(found(framed(inner, hole_px)).left) == 1


@pytest.mark.parametrize("wall_px", [4.0, 10.0])
@pytest.mark.parametrize("beside_px", [0.0, 20.0])
def test_what_is_one_with_the_walls_of_a_frame_is_merged_and_is_looked_at_by_itself(
    wall_px: float, beside_px: float
) -> None:
    """As parts in the cells of a tray: of the outline around all of it nothing more was to be learned."""
    x, y, radius = FRAME
    inner = (x - radius + wall_px + beside_px, y, 40.0)
    blobs = found(framed(inner, hole_px=radius - wall_px))
    for view in (blobs.left, blobs.right):
        (within,) = [blob for blob in view if blob.area_px2 < 10 * 40**2]
        assert within.fault == "merged" and sorted(faults(view)) == ["", "merged"]
        np.testing.assert_allclose(within.centroid_px, inner[:2], atol=12)
        assert 0.7 < within.area_px2 / (np.pi * 40**2) < 1.3


@pytest.mark.parametrize("hole_px", [60.0, 140.0, 196.0])
def test_a_frame_alone_has_nothing_that_is_thicker_than_its_walls(hole_px: float) -> None:
    x, y, radius = FRAME
    light = discs((FRAME,), 200.0, 50.0)
    hole = discs(((x + 0.3 * (radius - hole_px), y, hole_px),), 1.0, 0.0)
    assert len(found(light * (1 - hole) + 50.0 * hole).left) == 1
