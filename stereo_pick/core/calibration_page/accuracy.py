"""How well the model fits the corners, and how well it predicts views that it was not made from."""

from __future__ import annotations

from stereo_pick.core.calibration.result import CalibrationResult
from stereo_pick.core.calibration_page.markup import Markup, element, section, table


def accuracy_section(result: CalibrationResult) -> Markup:
    """Residuals by camera and axis (thesis table 3.2), and the errors of held-out views."""
    return section("Accuracy", _residuals(result), _held_out(result))


def _residuals(result: CalibrationResult) -> Markup:
    alone_px = result.rms_left_px, result.rms_right_px
    rows = [
        (
            side,
            *(f"{value:.3f}" for value in (row.x_px, row.y_px, row.x_m * 1000, row.y_m * 1000)),
            f"{row.distance_m * 1000:.0f}",
            f"{rms_px:.3f}",
        )
        for side, row, rms_px in zip(("left", "right"), result.residuals, alone_px)
    ]
    head = ("camera", "x px", "y px", "x mm", "y mm", "at mm", "camera alone px")
    note = (
        f"Rms distance of all corners in one rig: {result.rms_px:.3f} px. Much more than the cameras alone have: the "
        "pairs were not taken at the same moment. A low rms proves nothing by itself."
    )
    return element("div", table("Rms residuals, in the image and on the board", head, rows), element("p", note))


def _held_out(result: CalibrationResult) -> Markup:
    if result.held_out is None:
        return element("p", "Too few views to hold any out: nothing says how well this predicts other views.")
    rows = [
        ("epipolar error", f"{result.held_out.epipolar_rms_px:.3f} px"),
        ("the board's known lengths", f"{result.held_out.length_rms_m * 1000:.3f} mm"),
    ]
    note = "Each view was predicted by a calibration made from others. Much more than the residuals: too few views."
    return element("div", table("Rms errors of views that were held out", ("", "error"), rows), element("p", note))
