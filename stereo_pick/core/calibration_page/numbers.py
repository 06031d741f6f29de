"""Every parameter of the calibration with its one sigma."""

from __future__ import annotations

import math

import numpy as np

from stereo_pick.core.calibration.parameters import NAMES, ROTATION, TRANSLATION
from stereo_pick.core.calibration.result import CalibrationResult
from stereo_pick.core.calibration_page.markup import Markup, element, section, table

_OF_CAMERA = ("fx", "fy", "cx", "cy", "k1", "k2", "p1", "p2", "k3")


def numbers_section(result: CalibrationResult) -> Markup:
    """Intrinsics of both cameras, and where the right one stands."""
    values = dict(zip(NAMES, result.uncertainty.parameters.tolist()))
    sigmas = result.uncertainty.sigmas
    rows = [
        (name, *(with_sigma(values[f"{side}.{name}"], sigmas[f"{side}.{name}"]) for side in ("left", "right")))
        for name in _OF_CAMERA
    ]
    note = (
        "fx, fy, cx, cy in px; the distortion coefficients have no unit. Sigmas count only the corners' scatter "
        f"({result.solution.sigma_px:.3f} px a coordinate): a bent board, a wrong square or a camera that moved is "
        "not in them."
    )
    return section(
        "Parameters",
        table("Cameras, ± one sigma", ("", "left", "right"), rows),
        element("p", note),
        table("From the left to the right camera's frame: X' = R X + T, ± one sigma", ("", "value"), _pose(result)),
    )


def with_sigma(value: float, sigma: float) -> str:
    """Both with as many decimals as two digits of the sigma need."""
    if sigma == 0:
        return f"{value:g} (not estimated)"
    decimals = max(0, 1 - math.floor(math.log10(sigma)))
    return f"{value:.{decimals}f} ± {sigma:.{decimals}f}"


def _pose(result: CalibrationResult) -> list[tuple[str, str]]:
    parameters, sigma = result.uncertainty.parameters, result.uncertainty.sigma
    rows = list[tuple[str, str]]()
    for title, unit, part, factor in (
        ("rotation vector", "deg", ROTATION, np.degrees(1)),
        ("translation", "mm", TRANSLATION, 1000.0),
    ):
        for axis, value, one in zip("xyz", parameters[part] * factor, sigma[part] * factor):
            rows.append((f"{title} {axis}", f"{with_sigma(float(value), float(one))} {unit}"))
    return rows
