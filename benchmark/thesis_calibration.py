"""The thesis's calibration (3.4, table 3.2) beside what this package's gives on images of the same rig."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from formatting import Row, Section, markdown_table
from thesis_printed import TABLE_3_2, WORK_M

from stereo_pick.core.calibration.parameters import NAMES, UNITS, rig_vector
from stereo_pick.core.calibration.result import CalibrationResult
from stereo_pick.core.rig import StereoRig

# What the thesis prints behind its ± (3.4.1, 3.4.2), in the order of `parameters.NAMES`; k3 was not estimated.
_PRINTED_PM = (
    8.30235, 8.36960, 15.96042, 13.74085, 0.09587, 1.81005, 0.00285, 0.00331, 0.0,
    7.91944, 8.71945, 18.47137, 14.66643, 0.08217, 1.06827, 0.00417, 0.00445, 0.0,
    0.01618, 0.02051, 0.00275, 0.00107962, 0.00071668, 0.00486009,
)  # fmt: skip
_TOOLBOX_SIGMAS = 3  # what the toolbox's ± stands for


def table_3_2(results: Sequence[tuple[str, CalibrationResult]]) -> Section:
    """Residuals across and down, in the image and at the board."""
    (across_mm, columns, x_px, x_mm), (down_mm, rows, y_px, y_mm) = TABLE_3_2
    lines: list[Row] = [
        ["thesis, as printed", "16", f"{x_px:.3f}, {y_px:.3f}", f"{x_mm:.2f}, {y_mm:.2f}",
         f"image taken as {across_mm:g} × {down_mm:g} mm ({columns} × {rows} px)"],
    ]  # fmt: skip
    for name, result in results:
        for side, found in zip(("left", "right"), result.residuals):
            lines.append(
                [
                    f"{name}, {side}",
                    str(len(result.views)),
                    f"{found.x_px:.3f}, {found.y_px:.3f}",
                    f"{found.x_m * 1000:.3f}, {found.y_m * 1000:.3f}",
                    f"the boards' mean distance, {found.distance_m * 100:.0f} cm",
                ]
            )
    text = markdown_table(["table 3.2", "views", "rms x, y in px", "x, y in mm", "mm hold at"], lines)
    return Section("; ".join(f"{name} {px} px" for name, _, px, *_ in lines[1::2]), text)


def printed_error_at_work_mm(rig: StereoRig) -> tuple[float, float]:
    """Table 3.2's errors in pixels, x and y, as lengths [mm] where the thesis's parts stand."""
    x, y = (line[2] * WORK_M / focal * 1000 for line, focal in zip(TABLE_3_2, rig.left.K[[0, 1], [0, 1]]))
    return float(x), float(y)


def parameter_table(truth: StereoRig, result: CalibrationResult) -> str:
    """Each number of 3.4.1 and 3.4.2: its printed uncertainty, and this package's beside its true error."""
    true = rig_vector(truth.left, truth.right, truth.right_T_left)
    off = result.solution.parameters - true
    sigma = np.sqrt(np.diag(result.solution.covariance))
    lines: list[Row] = []
    for name, unit, printed, pm, error, own in zip(NAMES, UNITS, true, _PRINTED_PM, off, sigma):
        if pm == 0:
            continue
        scale, shown = (1000, "mm") if unit == "m" else (1, unit.replace("1", ""))
        cells = f"{printed * scale:.6g}", *(f"{each * scale:.2g}" for each in (pm, error, _TOOLBOX_SIGMAS * own))
        lines.append([f"{name} {shown}".strip(), *(cell.replace("-", "−") for cell in cells)])
    within = np.abs(off[sigma > 0]) <= _TOOLBOX_SIGMAS * sigma[sigma > 0]
    header = ["", "printed = true in the rendering", "printed ±", "error here", "± here (3 σ)"]
    return (
        f"{markdown_table(header, lines)}\n\n{within.sum()} of {len(within)} errors lie within "
        f"the stated {_TOOLBOX_SIGMAS} σ. Baseline: {result.rig.baseline_m * 1000:.2f} mm, in truth "
        f"{truth.baseline_m * 1000:.2f} mm (the thesis says about 20 cm); angle between the cameras "
        f"{result.rotation_deg:.2f}°, in truth "
        f"{math.degrees(float(np.linalg.norm(rig_vector(truth.left, truth.right, truth.right_T_left)[18:21]))):.2f}°."
    )
