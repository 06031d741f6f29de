"""Single wrong corners: found and named among noise and smooth misfit, and nothing else is taken for one."""

from __future__ import annotations

import numpy as np
import pytest
from simulated_views import BOARD, RIG, SIZE_PX, make_views

from stereo_pick.core.calibration.lone_corners import Corners, stand_out
from stereo_pick.core.calibration.solving import calibrate, calibrate_best
from stereo_pick.core.calibration.views import BoardView, Detections

PLACES = BOARD.object_points()[:, :2]


def pictures(seed: int, count: int = 24, noise_px: float = 0.1) -> list[Corners]:
    """Noise upon a smooth misfit ten times as large."""
    rng = np.random.default_rng(seed)
    x, y = (PLACES / PLACES.max()).T
    terms = np.stack([np.ones_like(x), x, y, x * x, x * y, y * y], axis=1)
    return [
        Corners(PLACES, terms @ rng.normal(0, 1, (6, 2)) + rng.normal(0, noise_px, (len(PLACES), 2)))
        for _ in range(count)
    ]


def spoilt(picture: Corners, corners: list[int], shift_px: tuple[float, float]) -> Corners:
    residuals_px = picture.residuals_px.copy()
    residuals_px[corners] += shift_px
    return Corners(picture.places, residuals_px)


def test_good_corners_are_kept_nineteen_times_of_twenty() -> None:
    lost = [sum(wrong.any() for wrong in stand_out(pictures(seed))) for seed in range(100)]
    # Four standard deviations above five in a hundred, twice over: a picture's noise is itself measured.
    assert np.count_nonzero(lost) <= 2 * (5 + 4 * np.sqrt(5 * 0.95))


@pytest.mark.parametrize("noise_px", [0.001, 0.1, 1.0])
@pytest.mark.parametrize("corner", [0, 20, 47])
def test_wrong_corner_is_found_whatever_the_noise(corner: int, noise_px: float) -> None:
    seen = pictures(3, noise_px=noise_px)
    seen[5] = spoilt(seen[5], [corner], (9 * noise_px, -9 * noise_px))
    wrong = stand_out(seen)
    assert [(i, k) for i, each in enumerate(wrong) for k in np.flatnonzero(each)] == [(5, corner)]
    assert wrong[5][corner] == pytest.approx(9 * np.sqrt(2) * noise_px, abs=4 * noise_px)


def test_blurred_picture_has_no_single_wrong_corners() -> None:
    seen = pictures(1)
    seen[2] = pictures(2, 1, noise_px=1.5)[0]
    assert not any(wrong.any() for wrong in stand_out(seen))


def test_picture_with_a_quarter_of_its_corners_wrong_is_left_to_be_judged_whole() -> None:
    seen = pictures(1)
    seen[2] = spoilt(seen[2], list(range(0, 48, 4)), (3, 3))
    assert not stand_out(seen)[2].any()


def test_few_corners_say_nothing_of_each_other() -> None:
    seen = [Corners(PLACES[:9], picture.residuals_px[:9]) for picture in pictures(1)]
    seen[0] = spoilt(seen[0], [4], (5, 5))
    assert not any(wrong.any() for wrong in stand_out(seen))


@pytest.mark.parametrize("side", ["left", "right"])
@pytest.mark.parametrize("listed_backwards", [False, True])
def test_wrong_corner_is_named_and_its_view_stays(side: str, listed_backwards: bool) -> None:
    views = make_views(noise_px=0.1)
    px = {"left": views[3].left_px.copy(), "right": views[3].right_px.copy()}
    px[side][13] += (1.5, 2.0)
    backwards = -1 if listed_backwards else 1
    views[3] = BoardView("pair3", px["left"], px["right"][::backwards])
    result = calibrate(views, SIZE_PX, BOARD)
    assert [view.name for view in result.views] == [f"pair{i}" for i in range(12)]
    (corner,) = result.rejected_corners
    assert (corner.view, corner.side, corner.corner) == ("pair3", side, 13)
    assert corner.residual_px == pytest.approx(2.5, abs=0.5)
    assert f"pair3: {side} corner in row 2, column 6 is 2." in corner.describe(BOARD)
    assert result.solution.sigma_px == pytest.approx(0.1, rel=0.1)
    found = result.found[3]
    np.testing.assert_array_equal(found.left_px, px["left"])
    np.testing.assert_array_equal(found.right_px, px["right"])
    assert result.rig.baseline_m == pytest.approx(RIG.baseline_m, abs=4 * result.baseline_sigma_m)


def test_views_of_different_sharpness_are_all_kept() -> None:
    views = [make_views(12, noise_px=0.02 * 1.35**i, seed=7)[i] for i in range(12)]
    assert calibrate(views, SIZE_PX, BOARD).rejected == ()


def detections(name: str, noise_px: float) -> Detections:
    return Detections(name, SIZE_PX, tuple(make_views(12, noise_px=noise_px)), ())


def test_detector_that_predicts_clearly_better_is_chosen_and_the_first_of_equals() -> None:
    sharp, blunt = detections("sharp", 0.05), detections("blunt", 0.15)
    assert calibrate_best([blunt, sharp], BOARD).detector == "sharp"
    assert calibrate_best([sharp, blunt], BOARD).detector == "sharp"
    assert calibrate_best([detections("first", 0.1), detections("second", 0.095)], BOARD).detector == "first"


def test_detector_is_not_better_for_corners_that_had_to_be_left_out() -> None:
    good, spotty = detections("good", 0.1), detections("spotty", 0.09)
    views = []
    for view in spotty.views:
        px = view.right_px.copy()
        px[[5, 17, 30]] += (4, 4)
        views.append(BoardView(view.name, view.left_px, px))
    spotty = Detections("spotty", SIZE_PX, tuple(views), ())
    assert calibrate_best([spotty, good], BOARD).detector == "good"
