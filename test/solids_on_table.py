"""Solids on a table, as they are and as they are fitted to their exact outlines, in the rectified left frame."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from rigs import RIGS, rotation
from solid_outlines import Part, outlines_of

from stereo_pick.core.arrays import Floats
from stereo_pick.core.shapes import SolidFit, fit_solids
from stereo_pick.core.shapes.table import Table

RIG = RIGS["verged"]
MIDDLE_M = np.array([0.12, 0.0, 0.9])
Standing = tuple[str, float, float, float, bool, Sequence[float]]  # kind, x, y, yaw, lying, half sizes

MIXED: list[Standing] = [
    ("cylinder", -0.05, 0.03, 0.0, False, (0.02, 0.03)),
    ("cylinder", 0.06, 0.05, 0.7, True, (0.015, 0.035)),
    ("box", 0.0, -0.05, 0.4, False, (0.02, 0.03, 0.015)),
    ("sphere", 0.08, -0.03, 0.0, False, (0.02,)),
]
LYING: list[Standing] = [
    ("cylinder", -0.05, 0.03, 0.2, True, (0.02, 0.03)),
    ("cylinder", 0.06, 0.05, 1.1, True, (0.015, 0.035)),
    ("cylinder", 0.0, -0.05, 2.2, True, (0.015, 0.025)),
]
NUTS: list[Standing] = [
    ("hexprism", -0.05, 0.03, 0.3, False, (0.02, 0.012)),
    ("hexprism", 0.06, 0.05, 0.8, True, (0.015, 0.035)),
    ("hexprism", 0.0, -0.05, 0.1, False, (0.018, 0.03)),
]
UPRIGHT: list[Standing] = [
    ("cylinder", -0.05, 0.03, 0.0, False, (0.02, 0.03)),
    ("cylinder", 0.06, -0.02, 0.0, False, (0.015, 0.02)),
]


def table_of(tilt_deg: float, lifted_m: float = 0.0) -> Table:
    """The table tilted so far from facing the cameras, or a plane so far above it."""
    normal = _axes(tilt_deg)[:, 2]
    return Table(normal, -float(normal @ MIDDLE_M) - lifted_m, 5e-4)


def part_on_table(tilt_deg: float, standing: Standing, lifted_m: float = 0.0) -> Part:
    """A part on the table, or so far above it."""
    kind, x, y, yaw, lying, half = standing
    axes = _axes(tilt_deg)
    stand = rotation((0, np.pi / 2, 0)) @ rotation((0, 0, np.pi / 6)) if lying else np.eye(3)
    height = half[0] if lying else half[-1]
    centre = MIDDLE_M + axes @ (x, y, height + lifted_m)
    return Part(kind, centre, axes @ rotation((0, 0, yaw)) @ stand, np.array(half))


def fits_on_table(tilt_deg: float, parts: Sequence[Standing], lifted_m: float = 0.0) -> list[SolidFit | None]:
    """The solids fitted to parts on the table, or so far above it."""
    return fit_solids([outlines_of(part_on_table(tilt_deg, each, lifted_m), RIG) for each in parts], RIG)


def _axes(tilt_deg: float) -> Floats:
    return rotation((np.pi - np.deg2rad(tilt_deg), 0.05, 0.02))
