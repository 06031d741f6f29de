"""Prints the example of docs/table.md: a table measured by a board in three places on it, before the demo's rig, and
how far that is from the truth.

python benchmark/table_example.py
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from board_views import BOARD
from rendering.rigs import rotation, table_before

from stereo_pick.cli.table import report
from stereo_pick.core.calibration.files import load_rig
from stereo_pick.core.calibration.views import BoardView
from stereo_pick.core.measured_table import table_under

_DEMO_RIG = Path(__file__).parents[1] / "config" / "demo_rig"
_DISTANCE_M, _ELEVATION_DEG, _THICKNESS_M, _NOISE_PX = 0.9, 60.0, 0.005, 0.1
_PLACES = (-0.03, -0.02, 0.1), (0.03, 0.0, 0.3), (0.0, 0.02, -0.3)  # x, y [m], turn [rad]
_AREA_M = 0.2  # from the middle, in which heights are compared


def main() -> None:
    """Measure, and print what the command prints, and the truth."""
    rig, random = load_rig(_DEMO_RIG), np.random.default_rng(0)
    left_T_table = table_before(rig, _DISTANCE_M, elevation_deg=_ELEVATION_DEG)
    flat = BOARD.object_points() - BOARD.object_points().mean(axis=0)
    views = []
    for x_m, y_m, turn_rad in _PLACES:
        corners_m = left_T_table.apply(flat @ rotation((0.0, 0.0, turn_rad)).T + [x_m, y_m, _THICKNESS_M])
        pixels = [px + random.normal(0, _NOISE_PX, px.shape) for px in rig.project(corners_m)]
        views.append(BoardView(f"pair {len(views) + 1}", *pixels))
    measured = table_under(views, BOARD, _THICKNESS_M, rig)
    x, y = (each.ravel() for each in np.meshgrid(*[np.linspace(-_AREA_M, _AREA_M, 9)] * 2))
    off_m = measured.table.height_m(left_T_table.apply(np.c_[x, y, 0 * x]) @ rig.left.R.T)
    print(report(measured, BOARD))
    print(f"truth     at most {np.abs(off_m).max() * 1000:.2f} mm off within {_AREA_M * 1000:g} mm of the middle")


if __name__ == "__main__":
    main()
