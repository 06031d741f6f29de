"""The verdict with its reasons, and what was calibrated."""

from __future__ import annotations

from collections.abc import Sequence

from stereo_pick.core.calibration.any_board import Board
from stereo_pick.core.calibration.fingerprint import calibration_hash
from stereo_pick.core.calibration.result import CalibrationResult
from stereo_pick.core.calibration.verdict import Verdict, Word
from stereo_pick.core.calibration_page.markup import Markup, element, section, table

_MEANING = {
    Word.GOOD: "nothing speaks against picking with this calibration.",
    Word.USABLE: "the calibration holds; what is listed here would make it better.",
    Word.REFUSED: "do not pick with this. No calibration file was written; any in the same folder are of another run.",
}


def verdict_box(verdict: Verdict, warnings: Sequence[str]) -> Markup:
    """The word, what it means, its reasons and the warnings."""
    lines = [*verdict.reasons, *(f"Warning: {warning}" for warning in warnings)]
    return element(
        "div",
        element("p", "Verdict: ", element("strong", verdict.word.value), f" – {_MEANING[verdict.word]}"),
        *([element("ul", *(element("li", line) for line in lines))] if lines else []),
        class_=f"verdict {verdict.word.value}",
    )


def summary_section(result: CalibrationResult) -> Markup:
    """What was calibrated, from what."""
    width, height = result.solution.size_px
    used, all_of_them = len(result.used), len(result.used) + len(result.rejected)
    rows = [
        ("board", board_text(result.board)),
        ("images", f"{width} x {height} px"),
        ("pairs", f"{used} of {all_of_them} used"),
        ("corners found by", result.detector),
        ("lens model", f"distortion {result.solution.model.value}"),
        ("baseline", f"{result.rig.baseline_m * 1000:.3f} ± {result.baseline_sigma_m * 1000:.3f} mm"),
        ("angle between the cameras", f"{result.rotation_deg:.3f} deg"),
        ("calibration hash", calibration_hash(result.rig)),
    ]
    return section("What was calibrated", table("The rig in short, ± one sigma", ("", "value"), rows))


def board_text(board: Board) -> str:
    """The board in words."""
    return f"{board.title}, squares of {board.square_m * 1000:g} mm"
