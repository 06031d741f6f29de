"""Hand-eye calibration from pairs of robot pose and board view."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from stereo_pick.core.arrays import Floats
from stereo_pick.core.errors import CalibrationError
from stereo_pick.core.hand_eye.pairs import Mount, RobotView, check
from stereo_pick.core.hand_eye.refinement import Poses, Refined, mean_stand_T_board, refine, residual_norms
from stereo_pick.core.hand_eye.result import Attempt, HandEye, Residual, UncertainTransform, small_sample_factor
from stereo_pick.core.hand_eye.scale import scale_of
from stereo_pick.core.hand_eye.solvers import SOLVERS
from stereo_pick.core.transform import Transform

FEW_PAIRS = 6  # measured: of three pairs, two standard deviations cover 80 % and not 95 %, of four 90 %
MAX_RMS_DEG, MAX_RMS_MM = 3.0, 30.0
_MAX_SCALE = 0.005  # of the board: a metre away the camera would be 5 mm off
_SURELY = 5.0  # sigmas
_SUSPECT_TIMES_MEDIAN = 4.0
_SUSPECT_MM, _SUSPECT_DEG = 0.5, 0.05  # below both, a pair is never suspected


def solve_hand_eye(views: Sequence[RobotView], mount: Mount) -> HandEye:
    """Find `base_T_camera` (eye-to-hand) or `flange_T_camera` (eye-in-hand) from three or more pairs.

    Every solver of SOLVERS is tried, and the one with the least residual refined over all pairs. Raises
    CalibrationError, with the measured value, where the pairs cannot determine the camera's place (no rotation, one
    axis, too few), or do not fit together.
    """
    check(views)
    refined, attempts = _solve(views, mount)
    residuals = _named(views, residual_norms(*_sides(views, mount), refined.X, refined.Y))
    result = HandEye(
        parent=mount.parent,
        child="camera",
        found=UncertainTransform(refined.X, refined.covariance[:6, :6] * small_sample_factor(len(views))),
        residuals=residuals,
        method=f"{mount.value}, {attempts[0].solver} refined",
        attempts=attempts,
        warnings=(*_few(len(views)), *_suspects(residuals)),
    )
    if not _fits(result):
        raise CalibrationError(_misfit(result, views, mount))
    _check_scale(views, mount, refined.X)
    return result


def closest_start(views: Sequence[RobotView], mount: Mount) -> tuple[Transform, Transform]:
    """X and Y of `A X B = Y` as the best of the solvers has them, not refined; raises CalibrationError without any."""
    A, B = _sides(views, mount)
    X = _tried(A, B)[0][1]
    return X, mean_stand_T_board(A, B, X)


def _solve(views: Sequence[RobotView], mount: Mount) -> tuple[Refined, tuple[Attempt, ...]]:
    """The refined solution, and what each solver reached on its own, best first."""
    A, B = _sides(views, mount)
    tried = _tried(A, B)
    X = tried[0][1]
    return refine(A, B, X, mean_stand_T_board(A, B, X)), tuple(attempt for attempt, _ in tried)


def _tried(A: Poses, B: Poses) -> list[tuple[Attempt, Transform]]:
    """Every solver's X, the least residual first: rotations count by what they move a board in mid-distance."""
    starts = [(name, X) for name, solver in SOLVERS.items() if (X := solver(A, B)) is not None]
    if not starts:
        raise CalibrationError(
            f"none of {', '.join(SOLVERS)} finds a solution: turn the flange about two axes, further"
        )
    arm_m = float(np.median([np.linalg.norm(pose.translation) for pose in B]))
    tried = [(_attempt(name, A, B, X), X) for name, X in starts]
    return sorted(
        tried, key=lambda each: np.hypot(each[0].translation_mm / 1000, np.radians(each[0].rotation_deg) * arm_m)
    )


def _sides(views: Sequence[RobotView], mount: Mount) -> tuple[Poses, Poses]:
    return [view.stand_T_parent(mount) for view in views], [view.camera_T_board for view in views]


def _attempt(name: str, A: Poses, B: Poses, X: Transform) -> Attempt:
    angle, distance = np.sqrt((residual_norms(A, B, X, mean_stand_T_board(A, B, X)) ** 2).mean(axis=0))
    return Attempt(name, float(distance * 1000), float(np.degrees(angle)))


def _named(views: Sequence[RobotView], norms: Floats) -> tuple[Residual, ...]:
    return tuple(
        Residual(view.name, float(distance * 1000), float(np.degrees(angle)))
        for view, (angle, distance) in zip(views, norms)
    )


def _fits(result: HandEye) -> bool:
    return result.rms_mm <= MAX_RMS_MM and (result.rms_deg or 0.0) <= MAX_RMS_DEG


def _fits_as(mount: Mount, views: Sequence[RobotView]) -> bool:
    refined, _ = _solve(views, mount)
    norms = residual_norms(*_sides(views, mount), refined.X, refined.Y)
    angle, distance = np.sqrt((norms**2).mean(axis=0))
    return bool(np.degrees(angle) <= MAX_RMS_DEG and distance * 1000 <= MAX_RMS_MM)


def _misfit(result: HandEye, views: Sequence[RobotView], mount: Mount) -> str:
    text = f"the {len(views)} pairs do not fit together: rms {result.rms_mm:.1f} mm and {result.rms_deg:.2f} deg; "
    if _fits_as(mount.other, views):
        return f"{text}they fit as {mount.other.value}: is the camera mounted so, or one of the poses the inverse?"
    return text + (
        "were both halves of each pair taken at the same moment, in this order, with the board fixed to its place, "
        f"and is the board's square size right? Worst: {_worst(result.residuals)}"
    )


def _worst(residuals: Sequence[Residual]) -> str:
    worst = max(residuals, key=lambda residual: residual.translation_mm)
    return f"{worst.name} ({worst.translation_mm:.1f} mm)"


def _check_scale(views: Sequence[RobotView], mount: Mount, X: Transform) -> None:
    """Raise CalibrationError where the board is surely larger, or smaller, than its square size has it."""
    if len(views) < FEW_PAIRS:
        return
    scale, sigma = scale_of(*_sides(views, mount), X)
    off = abs(scale - 1)
    if off > max(_MAX_SCALE, _SURELY * sigma):
        raise CalibrationError(
            f"the {len(views)} pairs fit best if the board is {100 * off:.1f} % {'larger' if scale > 1 else 'smaller'} "
            f"(± {100 * sigma:.1f} %): is the square size right, which would be {scale:.4f} times the one given, and "
            "does the robot move as far as it says?"
        )


def _few(count: int) -> tuple[str, ...]:
    if count >= FEW_PAIRS:
        return ()
    return (f"only {count} pairs: their scatter says little of how far to trust them; take 12 or more",)


def _suspects(residuals: Sequence[Residual]) -> tuple[str, ...]:
    """The pairs that miss by much more than the others."""
    median_mm = float(np.median([residual.translation_mm for residual in residuals]))
    median_deg = float(np.median([residual.rotation_deg or 0.0 for residual in residuals]))
    limit_mm = max(_SUSPECT_TIMES_MEDIAN * median_mm, _SUSPECT_MM)
    limit_deg = max(_SUSPECT_TIMES_MEDIAN * median_deg, _SUSPECT_DEG)
    return tuple(
        f"{each.name} misses by {each.translation_mm:.2f} mm and {each.rotation_deg:.3f} deg, the median pair by "
        f"{median_mm:.2f} mm and {median_deg:.3f} deg: take it again or leave it out"
        for each in residuals
        if each.translation_mm > limit_mm or (each.rotation_deg or 0.0) > limit_deg
    )
