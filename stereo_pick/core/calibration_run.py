"""From pairs of images of a board to calibration files: the same for a folder, a bag and live cameras."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

from stereo_pick.core.calibration.any_board import Board
from stereo_pick.core.calibration.detection import BoardImages, detect
from stereo_pick.core.calibration.files import save_rig
from stereo_pick.core.calibration.record import save_record
from stereo_pick.core.calibration.result import CalibrationResult
from stereo_pick.core.calibration.solving import calibrate_best
from stereo_pick.core.calibration.verdict import Verdict, Word, check_baseline, judge
from stereo_pick.core.calibration_page.evidence import typical_view
from stereo_pick.core.calibration_page.page import calibration_page, refusal_page, save_page
from stereo_pick.core.drafts import renewed
from stereo_pick.core.errors import CalibrationError


@dataclass(frozen=True, eq=False)
class CalibrationRun:
    """What came of some images: the verdict, the page that shows why, and the result where there is one."""

    verdict: Verdict
    page: str
    result: CalibrationResult | None
    notes: tuple[str, ...] = ()

    @property
    def summary(self) -> str:
        """The verdict and the numbers that count, in one line."""
        if self.result is None:
            return str(self.verdict)
        result, held_out = self.result, self.result.held_out
        epipolar = f"held-out epipolar error {held_out.epipolar_rms_px:.3f} px, " if held_out else ""
        return (
            f"{self.verdict} ({len(result.used)} of {len(result.used) + len(result.rejected)} views used, rms "
            f"{result.rms_px:.3f} px, {epipolar}baseline {result.rig.baseline_m * 1000:.3f} ± "
            f"{result.baseline_sigma_m * 1000:.3f} mm)"
        )

    def save(self, folder: Path) -> list[Path]:
        """Write left.yaml, right.yaml, stereo.yaml, calibration.yaml and the page; returns their paths.

        Raises CalibrationError where the calibration is refused, having written the page alone, or where the folder
        cannot be written.
        """
        if self.result is None or self.verdict.word is Word.REFUSED:
            raise self._refusal(folder)
        try:
            with renewed(folder) as draft:
                files = [
                    *save_rig(self.result.rig, draft),
                    save_record(self.result, draft),
                    save_page(self.page, draft),
                ]
        except OSError as error:
            raise CalibrationError(f"output {folder} cannot be written: {error.strerror}") from None
        return [folder / file.name for file in files]

    def _refusal(self, folder: Path) -> CalibrationError:
        reason = "; ".join(self.verdict.reasons)
        try:
            return CalibrationError(f"calibration refused: {reason}; see {save_page(self.page, folder)}")
        except OSError:
            return CalibrationError(f"calibration refused: {reason}")


def calibrate_from(
    images: Iterable[BoardImages], board: Board, baseline_m: float | None = None, notes: Sequence[str] = ()
) -> CalibrationRun:
    """Look for the board in the images, which can be iterated twice, calibrate from it and judge the result.

    baseline_m: the distance of the lenses [m] where it was measured on the rig; notes: what to warn of besides.
    Raises CalibrationError where no pair shows the board, or the images differ in size.
    """
    found = detect(images, board)
    try:
        result = calibrate_best(found, board)
    except CalibrationError as error:
        return CalibrationRun(Verdict(Word.REFUSED, (str(error),)), refusal_page(str(error), board, found), None)
    verdict, warnings = _verdict(result, baseline_m), (*notes, *result.warnings)
    page = calibration_page(result, verdict, warnings, _example(result, images))
    return CalibrationRun(verdict, page, result, warnings)


def _verdict(result: CalibrationResult, baseline_m: float | None) -> Verdict:
    """The verdict on the evidence, and on the baseline that was measured on the rig."""
    if baseline_m is not None:
        try:
            check_baseline(result, baseline_m)
        except CalibrationError as error:
            return Verdict(Word.REFUSED, (str(error),))
    return judge(result)


def _example(result: CalibrationResult, images: Iterable[BoardImages]) -> BoardImages | None:
    """The images of the pair that the page shows; None where several pairs have its name."""
    named = [pair for pair in images if pair.name == typical_view(result).name]
    return named[0] if len(named) == 1 else None
