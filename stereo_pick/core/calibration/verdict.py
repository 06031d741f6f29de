"""One word on a calibration, and the reasons for it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from enum import Enum

import numpy as np

from stereo_pick.core.calibration.boards import check_metres
from stereo_pick.core.calibration.parameters import TRANSLATION
from stereo_pick.core.calibration.result import FEW_VIEWS, CalibrationResult
from stereo_pick.core.errors import CalibrationError
from stereo_pick.core.rig import MAX_BASELINE_M

_GOOD_RMS_PX = 0.5
_GOOD_EPIPOLAR_PX, _MAX_EPIPOLAR = 0.5, 0.003  # the latter of the image width
_GOOD_BASELINE_SIGMA = 0.005  # of the baseline
_GOOD_FOCAL_SIGMA, _MAX_FOCAL_SIGMA = 0.01, 0.05  # of the focal length
_GOOD_AREA = 0.25  # of the image
_GOOD_TILT_DEG = 25.0
_BASELINE_SIGMAS, _RULER = 3.0, 0.02  # a ruler's 2 % between two lenses is well measured


class Word(Enum):
    """What to do with a calibration."""

    GOOD = "good"
    USABLE = "usable"
    REFUSED = "refused"


@dataclass(frozen=True)
class Verdict:
    """The word and its reasons, which are empty for a good calibration."""

    word: Word
    reasons: tuple[str, ...] = ()

    def __str__(self) -> str:
        return self.word.value + (f": {'; '.join(self.reasons)}" if self.reasons else "")


def judge(result: CalibrationResult) -> Verdict:
    """Weigh the evidence: what the calibration predicts, how sure it is, and what its views cover."""
    faults = tuple(_faults(result))
    if faults:
        return Verdict(Word.REFUSED, faults)
    doubts = tuple((*_doubts(result), *_gaps(result)))
    return Verdict(Word.USABLE if doubts else Word.GOOD, doubts)


def check_given_baseline(baseline_m: float) -> None:
    """Raise ParameterError where no two lenses are so far [m] from each other."""
    check_metres("baseline", baseline_m, MAX_BASELINE_M, "measure the distance of the two lenses, or leave it out")


def check_baseline(result: CalibrationResult, baseline_m: float) -> None:
    """Raise CalibrationError where the baseline [m] that was measured on the rig contradicts the calibration."""
    found_m = float(np.linalg.norm(result.solution.parameters[TRANSLATION]))
    if abs(found_m - baseline_m) <= max(_BASELINE_SIGMAS * result.baseline_sigma_m, _RULER * baseline_m):
        return
    square_m = result.board.square_m
    raise CalibrationError(
        f"baseline = {found_m * 1000:.1f} mm, but {baseline_m * 1000:.1f} mm was measured on the rig: is the square "
        f"really {square_m * 1000:g} mm? It would have to be {square_m * baseline_m / found_m * 1000:.2f} mm"
    )


def _faults(result: CalibrationResult) -> Iterator[str]:
    limit_px = _MAX_EPIPOLAR * result.solution.size_px[0]
    held_out, focal = result.held_out, _focal_sigma(result)
    if held_out and held_out.epipolar_rms_px > limit_px:
        yield (
            f"views that were held out miss their epipolar lines by {held_out.epipolar_rms_px:.2f} px, more than "
            f"{limit_px:.2f} px: more views, sharper and taken at the same moment"
        )
    if focal > _MAX_FOCAL_SIGMA:
        yield f"focal length uncertain by {focal:.1%}: the views are too much alike; tilt the board to all sides"


def _doubts(result: CalibrationResult) -> Iterator[str]:
    held_out, focal = result.held_out, _focal_sigma(result)
    baseline = result.baseline_sigma_m / result.rig.baseline_m
    if len(result.views) < FEW_VIEWS:
        yield f"few views ({len(result.views)}, {FEW_VIEWS} or more are good)"
    if result.rms_px > _GOOD_RMS_PX:
        yield f"stereo rms above {_GOOD_RMS_PX:g} px: flatter board, steadier views, sharper images"
    if held_out and held_out.epipolar_rms_px > _GOOD_EPIPOLAR_PX:
        yield f"held-out epipolar error {held_out.epipolar_rms_px:.2f} px, above {_GOOD_EPIPOLAR_PX:g} px: more views"
    if baseline > _GOOD_BASELINE_SIGMA:
        yield f"baseline uncertain by {baseline:.1%}: more views, more tilt"
    if focal > _GOOD_FOCAL_SIGMA:
        yield f"focal length uncertain by {focal:.1%}: more tilt, nearer and farther"


def _gaps(result: CalibrationResult) -> Iterator[str]:
    covered = result.coverage
    for side, area in (("left", covered.left_area), ("right", covered.right_area)):
        if area < _GOOD_AREA:
            yield f"the board reached {area:.0%} of the {side} image only: move it to the image's borders"
    if covered.tilt_deg < _GOOD_TILT_DEG:
        yield f"the board was tilted by {covered.tilt_deg:.0f} deg only: tilt it to all sides by up to 45 deg"


def _focal_sigma(result: CalibrationResult) -> float:
    """The largest standard deviation of a focal length, as a part of it."""
    sigmas, rig = result.uncertainty.sigmas, result.rig
    return max(
        sigmas[f"{side}.{name}"] / float(camera.K[i, i])
        for side, camera in (("left", rig.left), ("right", rig.right))
        for i, name in enumerate(("fx", "fy"))
    )
