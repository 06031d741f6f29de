"""The verdict: what is good, what is doubted and why, and what is refused."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from simulated_views import BOARD, RIG, SIZE_PX, make_views, triangulated

from stereo_pick.core.calibration.boards import Chessboard
from stereo_pick.core.calibration.files import load_rig
from stereo_pick.core.calibration.held_out import epipolar_px, length_errors_m
from stereo_pick.core.calibration.solving import calibrate
from stereo_pick.core.calibration.verdict import Word, check_baseline, judge
from stereo_pick.core.calibration.views import BoardView
from stereo_pick.core.errors import CalibrationError

CAMERAS = RIG.left, RIG.right, RIG.right_T_left


def test_true_rig_has_no_errors() -> None:
    view = make_views(1)[0]
    np.testing.assert_allclose(epipolar_px(CAMERAS, view), 0, atol=1e-6)
    errors_m = length_errors_m(CAMERAS, view, BOARD)
    assert len(errors_m) == BOARD.columns + BOARD.rows
    np.testing.assert_allclose(errors_m, 0, atol=1e-8)


def test_epipolar_error_is_the_distance_across_the_line() -> None:
    view = make_views(1)[0]
    moved = BoardView("moved", view.left_px, view.right_px + [0, 0.5])
    np.testing.assert_allclose(epipolar_px(CAMERAS, moved), 0.5, rtol=0.05)


def test_held_out_views_fare_a_little_worse_than_those_used() -> None:
    result = calibrate(make_views(12, noise_px=0.2), SIZE_PX, BOARD)
    held_out = result.held_out
    assert held_out is not None
    in_sample = np.sqrt(np.mean([epipolar_px(result.solution.cameras, view) ** 2 for view in result.views]))
    assert in_sample < held_out.epipolar_rms_px < 1.3 * in_sample
    assert held_out.epipolar_rms_px == pytest.approx(0.2 * np.sqrt(2), rel=0.15)
    assert held_out.length_rms_m < 0.001


def test_diverse_sharp_views_are_good() -> None:
    verdict = judge(calibrate(make_views(15, noise_px=0.05), SIZE_PX, BOARD))
    assert (verdict.word, verdict.reasons) == (Word.GOOD, ())
    assert str(verdict) == "good"


@pytest.mark.parametrize(
    ("views", "reason"), [(make_views(5, 0.05), "few views"), (make_views(12, 0.5), "stereo rms above 0.5 px")]
)
def test_doubts_are_said(views: list[BoardView], reason: str) -> None:
    verdict = judge(calibrate(views, SIZE_PX, BOARD))
    assert verdict.word is Word.USABLE
    assert reason in str(verdict)


def test_three_views_have_none_to_hold_out() -> None:
    assert calibrate(make_views(3), SIZE_PX, BOARD).held_out is None


@pytest.mark.parametrize("side", ["left", "right"])
@pytest.mark.parametrize("axis", [0, 1])
def test_mirrored_image_is_refused_as_such(side: str, axis: int) -> None:
    def mirrored(corners_px: np.ndarray) -> np.ndarray:
        grid = np.flip(corners_px.reshape(BOARD.rows, BOARD.columns, 2), axis=1 - axis).reshape(-1, 2).copy()
        grid[:, axis] = SIZE_PX[axis] - 1 - grid[:, axis]
        return grid

    views = make_views(noise_px=0.1)
    pixels = [{"left": v.left_px, "right": v.right_px} for v in views]
    pairs = [{**each, side: mirrored(each[side])} for each in pixels]
    with pytest.raises(CalibrationError, match="mirrored"):
        calibrate([BoardView(str(i), p["left"], p["right"]) for i, p in enumerate(pairs)], SIZE_PX, BOARD)


def test_wrong_square_is_contradicted_by_the_baseline_measured_on_the_rig() -> None:
    result = calibrate(make_views(noise_px=0.1), SIZE_PX, Chessboard(8, 6, 0.03))
    with pytest.raises(CalibrationError, match=r"really 30 mm\? It would have to be 25\.\d+ mm"):
        check_baseline(result, RIG.baseline_m)
    check_baseline(calibrate(make_views(noise_px=0.1), SIZE_PX, BOARD), RIG.baseline_m * 1.01)


def test_bench_rig_errs_within_what_it_states(calibrated, shared_data: Path) -> None:
    folder = "bench_rig/calibration"
    result = calibrated(f"{folder}/pair_*/left.png", f"{folder}/pair_*/right.png", Chessboard(9, 6, 0.029))
    truth = load_rig(shared_data / folder / "truth/opencv.yaml")
    assert {view.name: "moment" in view.reason for view in result.rejected} == {
        "pair_16/left.png": True,
        "pair_17/left.png": False,
    }
    assert judge(result).word is Word.GOOD
    assert result.rig.baseline_m == pytest.approx(truth.baseline_m, abs=5e-5)
    off = result.rig.right_T_left @ truth.right_T_left.inverse()
    assert np.degrees(np.arccos((np.trace(off.rotation) - 1) / 2)) < 0.02
    points = np.array([[x, y, z] for x in (-0.05, 0.05) for y in (-0.05, 0.05) for z in (0.8, 0.95, 1.1)])
    error = triangulated(result.rig, *truth.project(points)) - points
    covariance = result.uncertainty.point_covariance(points)
    chi_square = np.einsum("ni,ni->n", error, np.linalg.solve(covariance, error[..., None])[..., 0])
    # Three degrees of freedom: 11.3 is exceeded once in a hundred.
    assert (chi_square < 11.3).all()
