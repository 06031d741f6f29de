"""What the thesis printed, and the same tables from this project's scenes."""

from __future__ import annotations

import statistics
from collections.abc import Sequence

import numpy as np
from formatting import Row, decimals, markdown_table
from rivals import FEATURE, THESIS_FEATURE
from scoring import Score, of

from stereo_pick.core.arrays import Floats
from stereo_pick.core.correspondence.correspondences import Correspondences
from stereo_pick.core.depth_report import DepthError
from stereo_pick.core.rig import StereoRig
from stereo_pick.core.triangulation import Points, Triangulator

_TABLE_3_14_MM = ((100, 101), (65, 64.3), (190, 188.3), (155, 154.3), (125, 123.7), (35, 32.1), (240, 239.6))
_TABLE_3_16_MM = {(1, 2): (120, 121.8), (1, 3): (50, 47.6), (2, 3): (170, 168.8), (1, 4): (75, 75.7)}
_TABLE_3_15_LEFT_PX = np.array([(62.37, 410.94), (176.12, 438.88), (303.98, 395.26), (422.89, 420.57)])
_TABLE_3_15_RIGHT_PX = np.array([(143.80, 286.43), (195.9, 316.56), (375.615, 276.477), (443.94, 306.36)])
_SOURCES = (FEATURE, THESIS_FEATURE)


def table_3_14(scores: Sequence[Score]) -> str:
    """Depth between two cylinders in seven cases."""
    cases = [f"table_3_14/case_{number}" for number in range(1, 8)]
    measured = [[_depth(scores, name, case, 1, 2) for name in _SOURCES] for case in cases]
    printed = [DepthError("", actual / 1000, calculated / 1000) for actual, calculated in _TABLE_3_14_MM]
    return _depth_table([f"case {number}" for number in range(1, 8)], measured, printed)


def table_3_16(scores: Sequence[Score]) -> str:
    """Depth between four cylinders."""
    measured = [[_depth(scores, name, "table_3_16/case_1", *pair) for name in _SOURCES] for pair in _TABLE_3_16_MM]
    printed = [DepthError("", actual / 1000, calculated / 1000) for actual, calculated in _TABLE_3_16_MM.values()]
    return _depth_table([f"{first} and {second}" for first, second in _TABLE_3_16_MM], measured, printed)


def table_3_15(rig: StereoRig) -> str:
    """What becomes of the thesis's printed centroids under its printed calibration, which is that of the scenes."""
    count = len(_TABLE_3_15_LEFT_PX)
    correspondences = Correspondences(
        left_px=rig.left.rectified(_TABLE_3_15_LEFT_PX),
        right_px=rig.right.rectified(_TABLE_3_15_RIGHT_PX),
        sigma_px=np.ones((count, 2)),
        size_px=np.ones((count, 2)),
        direction_rad=np.zeros(count),
    )
    unguarded = Triangulator(max_ray_gap_m=1.0).triangulate(correspondences, rig)
    guarded = Triangulator().triangulate(correspondences, rig)
    rows_apart_px = correspondences.left_px[:, 1] - correspondences.right_px[:, 1]
    rows = [
        [
            f"object {number + 1}",
            f"{rows_apart_px[number]:+.1f}",
            f"{unguarded.ray_gap[number] * 1000:.1f}",
            _verdict(guarded, correspondences.left_px[number]),
        ]
        for number in range(count)
    ]
    return markdown_table(["Table 3.15", "rows apart px", "ray gap mm", "the package"], rows)


def _verdict(points: Points, left_px: Floats) -> str:
    for refusal in points.refused:
        if refusal.left_px is not None and np.array_equal(refusal.left_px, left_px):
            return f"refused: `{refusal.reason}`"
    return "accepted"


def _depth(scores: Sequence[Score], contender: str, scene: str, first: int, second: int) -> DepthError | None:
    """The depth between two cylinders of a scene; None where one of them was not found."""
    (score,) = (s for s in of(scores, contender) if s.scene.name == scene)
    wanted = f"cylinder{first} – cylinder{second}"
    return next((depth for depth in score.depths if depth.name == wanted), None)


def _depth_table(
    names: Sequence[str], measured: Sequence[Sequence[DepthError | None]], printed: Sequence[DepthError]
) -> str:
    sources = (*_SOURCES, "printed in the thesis")
    header = ["", "actual mm"]
    for source in sources:
        header += [f"{source}: mm", "error mm", "%"]
    columns = [[*row, other] for row, other in zip(measured, printed)]
    rows: list[Row] = [
        [name, decimals(actual.actual_m * 1000, 2), *(cell for depth in row for cell in _cells(depth))]
        for name, actual, row in zip(names, printed, columns)
    ]
    for label, extreme in (("maximum", max), ("minimum", min), ("average", statistics.fmean)):
        cells = [label, ""]
        for column in zip(*columns):
            errors_mm = [depth.error_m * 1000 for depth in column if depth is not None]
            cells += ["", decimals(extreme(errors_mm), 2) if errors_mm else "–", ""]
        rows.append(cells)
    return markdown_table(header, rows)


def _cells(depth: DepthError | None) -> tuple[str, str, str]:
    if depth is None:
        return "not found", "–", "–"
    return (
        decimals(abs(depth.calculated_m) * 1000, 2),
        decimals(depth.error_m * 1000, 2),
        decimals(depth.error_percent, 2),
    )
