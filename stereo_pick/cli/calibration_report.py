"""A calibration for people, one fact a line."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path

from stereo_pick.core.calibration.result import CalibrationResult
from stereo_pick.core.calibration.verdict import Verdict

Line = tuple[str, str]

_NAMED_CORNERS = 6


def report(result: CalibrationResult, verdict: Verdict, warnings: Sequence[str], written: Sequence[Path]) -> str:
    """The result, the evidence and the verdict."""
    lines = [
        *_views(result),
        *_residuals(result),
        *_rig(result),
        *_points(result),
        ("verdict", str(verdict)),
        *(("warning", warning) for warning in warnings),
        *(("written", str(path)) for path in written),
    ]
    return "\n".join(f"{label:<10}{text}" for label, text in lines)


def _views(result: CalibrationResult) -> Iterator[Line]:
    board, covered = result.board, result.coverage
    yield "board", f"{board.title}, squares of {board.square_m * 1000:g} mm"
    yield "detector", result.detector
    yield "views", f"{len(result.used)} of {len(result.used) + len(result.rejected)} used"
    yield from (("rejected", f"{view.name}: {view.reason}") for view in result.rejected)
    yield from (("corner", corner.describe(board)) for corner in result.rejected_corners[:_NAMED_CORNERS])
    if len(result.rejected_corners) > _NAMED_CORNERS:
        more = len(result.rejected_corners) - _NAMED_CORNERS
        yield "corners", f"{more} more single corners left out, all of them in calibration.yaml"
    yield (
        "coverage",
        f"{covered.left_area:.0%} of the left image, {covered.right_area:.0%} of the right, tilts that differ by up to "
        f"{covered.tilt_deg:.0f} deg",
    )


def _residuals(result: CalibrationResult) -> Iterator[Line]:
    alone = f"left {result.rms_left_px:.3f} px, right {result.rms_right_px:.3f} px, stereo {result.rms_px:.3f} px"
    yield "rms", alone
    for side, row in zip(("left", "right"), result.residuals):
        yield (
            f"  {side}",
            f"x {row.x_px:.3f} px, y {row.y_px:.3f} px; on the board, {row.distance_m * 1000:.0f} mm away, "
            f"x {row.x_m * 1000:.3f} mm, y {row.y_m * 1000:.3f} mm",
        )
    if result.held_out:
        length_mm = result.held_out.length_rms_m * 1000
        yield (
            "held out",
            f"epipolar error {result.held_out.epipolar_rms_px:.3f} px, the board's lengths {length_mm:.3f} mm",
        )


def _rig(result: CalibrationResult) -> Iterator[Line]:
    sigmas = result.uncertainty.sigmas
    yield "lens", f"distortion {result.solution.model.value}"
    for side, camera in (("left", result.rig.left), ("right", result.rig.right)):
        values = zip(("fx", "fy", "cx", "cy"), camera.K[[0, 1, 0, 1], [0, 1, 2, 2]])
        yield f"  {side}", ", ".join(f"{name} {value:.2f} ± {sigmas[f'{side}.{name}']:.2f}" for name, value in values)
    sigma_mm = result.baseline_sigma_m * 1000
    yield "baseline", f"{result.rig.baseline_m * 1000:.3f} mm, standard deviation {sigma_mm:.3f} mm"
    yield "rotation", f"{result.rotation_deg:.3f} deg between the cameras"


def _points(result: CalibrationResult) -> Iterator[Line]:
    for row in result.point_sigmas:
        x_mm, y_mm, z_mm = (1000 * sigma for sigma in (row.x_m, row.y_m, row.z_m))
        yield (
            "points",
            f"{row.depth_m * 1000:.0f} mm away sure to x {x_mm:.2f}, y {y_mm:.2f}, z {z_mm:.2f} mm (1 sigma)",
        )
