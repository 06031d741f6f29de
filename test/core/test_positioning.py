"""Poses with the calibration's own uncertainty, and in the robot's frame: against the truth of simulated rigs."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
import rigs
from rig_files import framed
from simulated_views import BOARD, RIG, SIZE_PX, make_views, rotation

from stereo_pick.core.calibration.fingerprint import calibration_hash
from stereo_pick.core.calibration.record import CalibrationRecord
from stereo_pick.core.calibration.result import CalibrationResult
from stereo_pick.core.calibration.solving import calibrate
from stereo_pick.core.calibration.verdict import Verdict, Word
from stereo_pick.core.correspondence import Correspondences
from stereo_pick.core.errors import CalibrationError
from stereo_pick.core.hand_eye.files import FramedHandEye
from stereo_pick.core.hand_eye.result import HandEye, UncertainTransform
from stereo_pick.core.hand_eye.rotations import rotation_matrix
from stereo_pick.core.pipeline import Steps
from stereo_pick.core.poses import ObjectPoses
from stereo_pick.core.positioning import Positioning
from stereo_pick.core.rig import StereoRig
from stereo_pick.core.transform import Transform

RIGS_SIMULATED = 80
TOLERANCE_M = 0.003
SIGMA_PX = 1.0  # so that neither the image nor the calibration is negligible
WORK_M = np.array([[0, 0, 0.5], [0.08, 0.06, 0.55], [-0.1, -0.07, 0.7], [0.05, -0.05, 0.8]])
BASE_T_CAMERA = Transform(rotation(2.2, 0.2, -0.3), [0.6, -0.2, 0.9])
HAND_EYE_COVARIANCE = np.diag([2e-3, 1e-3, 3e-3, 8e-4, 5e-4, 6e-4]) ** 2


def record(result: CalibrationResult) -> CalibrationRecord:
    return CalibrationRecord(result.uncertainty, Verdict(Word.GOOD), "")


def matched(left_px: np.ndarray, right_px: np.ndarray) -> Correspondences:
    count = len(left_px)
    return Correspondences(
        left_px, right_px, np.full((count, 2), SIGMA_PX), np.full((count, 2), 20.0), np.full(count, 0.4)
    )


def located(rig: StereoRig, xyz: np.ndarray, rng: np.random.Generator, truth: StereoRig = RIG) -> ObjectPoses:
    """Points that the true rig sees, as this calibration of it locates them in noisy images."""
    left_px, right_px = truth.project(xyz)
    rectified = rig.left.rectified(left_px), rig.right.rectified(right_px)
    noisy = (pixels + rng.normal(0, SIGMA_PX, pixels.shape) for pixels in rectified)
    return Steps().locate(matched(*noisy), rig, 0)


def squares(poses: ObjectPoses, truth_m: np.ndarray) -> np.ndarray:
    error = poses.xyz - truth_m
    return np.einsum("ni,ni->n", error, np.linalg.solve(poses.covariance, error[..., None])[..., 0])


@cache
def simulated() -> dict[str, tuple[list[ObjectPoses], np.ndarray]]:
    """Poses by rigs that are each calibrated from views of its own, and the truth (points, 3) [m].

    bare: without the calibration's uncertainty; camera: with it; base: in the robot's frame, by a hand-eye
    calibration whose error is drawn from its stated covariance.
    """
    found: dict[str, list[ObjectPoses]] = {"bare": [], "camera": [], "base": []}
    for seed in range(RIGS_SIMULATED):
        result = calibrate(make_views(6, noise_px=0.1, seed=seed), SIZE_PX, BOARD)
        rng = np.random.default_rng(seed)
        poses = located(result.rig, WORK_M, rng)
        known = Positioning(record(result))
        w, d = np.split(rng.multivariate_normal(np.zeros(6), HAND_EYE_COVARIANCE), 2)
        estimate = Transform(rotation_matrix(w) @ BASE_T_CAMERA.rotation, BASE_T_CAMERA.translation + d)
        hand_eye = HandEye("base", "camera", UncertainTransform(estimate, HAND_EYE_COVARIANCE), (), "drawn")
        robot = replace(known, hand_eye=FramedHandEye(hand_eye, "base_link", "left"))
        found["bare"].append(poses)
        found["camera"].append(known.place(poses, result.rig))
        found["base"].append(robot.place(poses, result.rig))
    truth = {"bare": WORK_M, "camera": WORK_M, "base": BASE_T_CAMERA.apply(WORK_M)}
    return {name: (found[name], truth[name]) for name in found}


def squares_of(frame: str) -> np.ndarray:
    """Squared Mahalanobis distances (rigs, points) from the truth."""
    found, truth_m = simulated()[frame]
    return np.array([squares(poses, truth_m) for poses in found])


def near_enough(frame: str) -> tuple[float, float]:
    """The share of positions within TOLERANCE_M, stated and real."""
    found, truth_m = simulated()[frame]
    stated = [replace(poses, tolerance_m=TOLERANCE_M).confidence for poses in found]
    real = [np.linalg.norm(poses.xyz - truth_m, axis=1) <= TOLERANCE_M for poses in found]
    return float(np.mean(stated)), float(np.mean(real))


@pytest.mark.parametrize("frame", ["camera", "base"])
def test_stated_covariances_cover_the_errors_of_calibrated_rigs(frame: str) -> None:
    """Chi-square of three degrees of freedom: mean 3, variance 6, its 68.3 and its 95 % points."""
    found = squares_of(frame)
    three_sigma = 3 / np.sqrt(RIGS_SIMULATED)  # one draw a rig: the points of one rig err almost alike
    assert found.mean() == pytest.approx(3, abs=three_sigma * np.sqrt(6))
    for point, share in ((3.53, 0.683), (7.81, 0.95)):
        assert np.mean(found < point) == pytest.approx(share, abs=three_sigma * np.sqrt(share * (1 - share)))


def test_the_image_alone_does_not_explain_these_errors() -> None:
    assert squares_of("bare").mean() > 5
    assert np.mean(squares_of("bare") < 7.81) < 0.85


@pytest.mark.parametrize("frame", ["camera", "base"])
def test_as_many_positions_are_near_enough_as_their_confidence_says(frame: str) -> None:
    stated, real = near_enough(frame)
    three_sigma = 3 * np.sqrt(stated * (1 - stated) / RIGS_SIMULATED)
    assert 0.1 < stated < 0.9
    assert real == pytest.approx(stated, abs=three_sigma)


def test_confidence_by_the_image_alone_would_promise_too_much() -> None:
    stated, real = near_enough("bare")
    assert real < stated - 0.05


@pytest.fixture(scope="module")
def result() -> CalibrationResult:
    return calibrate(make_views(6, noise_px=0.1), SIZE_PX, BOARD)


@pytest.fixture
def poses(result: CalibrationResult) -> ObjectPoses:
    return located(result.rig, WORK_M, np.random.default_rng(0))


def test_what_the_covariance_contains_is_told(result: CalibrationResult, poses: ObjectPoses) -> None:
    hand_eye = framed(BASE_T_CAMERA)
    assert Positioning().place(poses, result.rig) is poses
    for positioning, contained in (
        (Positioning(), ("image",)),
        (Positioning(record(result)), ("image", "calibration")),
        (Positioning(None, hand_eye), ("image", "hand_eye")),
        (Positioning(record(result), hand_eye), ("image", "calibration", "hand_eye")),
    ):
        assert positioning.place(poses, result.rig).covariance_of == contained


def test_a_record_of_another_calibration_adds_nothing(result: CalibrationResult, poses: ObjectPoses) -> None:
    assert Positioning(record(result)).is_of(result.rig)
    assert not Positioning(record(result)).is_of(RIG)
    placed = Positioning(record(result)).place(poses, RIG)
    assert placed.covariance_of == ("image",)
    np.testing.assert_array_equal(placed.covariance, poses.covariance)


def test_in_the_robots_frame_everything_turns_together(result: CalibrationResult, poses: ObjectPoses) -> None:
    placed = Positioning(None, framed(BASE_T_CAMERA, sigma_m=0.0)).place(poses, result.rig)
    assert placed.frame_id == "base_link"
    np.testing.assert_allclose(BASE_T_CAMERA.inverse().apply(placed.xyz), poses.xyz, atol=1e-12)
    R = BASE_T_CAMERA.rotation
    np.testing.assert_allclose(R.T @ placed.covariance @ R, poses.covariance, rtol=1e-9, atol=1e-16)
    for before, after, heading in zip(poses.quaternions(), placed.quaternions(), placed.heading_rad):
        turned = R @ matrix(before)
        np.testing.assert_allclose(matrix(after), turned, atol=1e-12)
        assert heading == pytest.approx(np.arctan2(turned[1, 0], turned[0, 0]))


def matrix(quaternion_xyzw: np.ndarray) -> np.ndarray:
    x, y, z, w = quaternion_xyzw
    v = np.array([x, y, z])
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return (w * w - v @ v) * np.eye(3) + 2 * np.outer(v, v) + 2 * w * cross


@pytest.mark.parametrize("hand_eye", [None, framed(BASE_T_CAMERA)], ids=["camera", "base"])
def test_what_is_less_sure_than_asked_for_is_refused_by_its_whole_covariance(
    result: CalibrationResult, poses: ObjectPoses, hand_eye: FramedHandEye | None
) -> None:
    positioning = Positioning(record(result), hand_eye)
    every = positioning.place(poses, result.rig)
    least = float(poses.confidence.min())  # the image alone would let all pass
    some = positioning.place(replace(poses, min_confidence=least), result.rig)
    sure = every.confidence >= least
    assert 0 < len(some) < len(every)
    np.testing.assert_array_equal(some.confidence, every.confidence[sure])
    for name in ("xyz", "rotation", "size_m", "covariance", "ray_gap", "left_px", "right_px"):
        np.testing.assert_array_equal(getattr(some, name), getattr(every, name)[sure])
    assert [each.reason for each in some.refused] == ["low_confidence"] * int((~sure).sum())
    seen_px = result.rig.left.unrectified(np.array([each.left_px for each in some.refused]))
    np.testing.assert_allclose(seen_px, every.left_px[~sure], atol=1e-3)
    for each, confidence in zip(some.refused, every.confidence[~sure]):
        assert f"{confidence:.3f}" in each.detail and "5 mm" in each.detail


def test_without_objects_nothing_goes_wrong(result: CalibrationResult) -> None:
    nothing = Steps().locate(matched(np.zeros((0, 2)), np.zeros((0, 2))), result.rig, 0)
    placed = Positioning(record(result), framed(BASE_T_CAMERA)).place(nothing, result.rig)
    assert len(placed) == 0
    assert placed.frame_id == "base_link"


def test_a_hand_eye_of_another_calibration_is_refused() -> None:
    rig, other = rigs.RIGS["verged"], rigs.RIGS["parallel"]
    of_rig = framed(BASE_T_CAMERA, calibration_hash=calibration_hash(rig))
    Positioning(None, of_rig).check(rig)
    Positioning(None, framed(BASE_T_CAMERA)).check(other)
    complaint = rf"another calibration \({calibration_hash(rig)}\) than the one in use \({calibration_hash(other)}\)"
    with pytest.raises(CalibrationError, match=complaint):
        Positioning(None, of_rig).check(other)


def test_a_hand_eye_of_another_camera_is_refused() -> None:
    positioning = Positioning(None, framed(BASE_T_CAMERA, child_frame="left_eye"))
    positioning.check(RIG, "left_eye")
    with pytest.raises(CalibrationError, match="of the frame 'left_eye', but the left images come from 'cam_b'"):
        positioning.check(RIG, "cam_b")
