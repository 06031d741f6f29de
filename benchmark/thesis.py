"""Tables 3.14 to 3.16 of the thesis beside the same from this project's scenes."""

from __future__ import annotations

import statistics
from collections.abc import Sequence

import numpy as np
from formatting import Row, Section, decimals, markdown_table
from rivals import FEATURE, THESIS_FEATURE
from scoring import Score, of
from thesis_printed import TABLE_3_14, TABLE_3_15_LEFT_PX, TABLE_3_15_RIGHT_PX, TABLE_3_16_CM

from stereo_pick.core.arrays import Floats
from stereo_pick.core.correspondence.correspondences import Correspondences
from stereo_pick.core.depth_report import DepthError
from stereo_pick.core.rig import StereoRig
from stereo_pick.core.triangulation import Points, Triangulator

_SOURCES = (FEATURE, THESIS_FEATURE)


def table_3_14(scores: Sequence[Score]) -> Section:
    """Depth between two cylinders in seven cases."""
    cases = [f"table_3_14/case_{number}" for number in range(1, 8)]
    measured = [[_depth(scores, name, case, 1, 2) for name in _SOURCES] for case in cases]
    printed = [DepthError("", actual / 100, calculated / 100) for _, actual, calculated, *_ in TABLE_3_14]
    return _depth_table([f"case {number}" for number in range(1, 8)], measured, printed)


def table_3_16(scores: Sequence[Score]) -> Section:
    """Depth between four cylinders."""
    measured = [[_depth(scores, name, "table_3_16/case_1", *pair) for name in _SOURCES] for pair in TABLE_3_16_CM]
    printed = [DepthError("", actual / 100, calculated / 100) for calculated, actual in TABLE_3_16_CM.values()]
    return _depth_table([f"{first} and {second}" for first, second in TABLE_3_16_CM], measured, printed)


def table_3_15(rig: StereoRig) -> str:
    """What becomes of the thesis's printed centroids under its printed calibration, which is that of the scenes."""
    count = len(TABLE_3_15_LEFT_PX)
    correspondences = Correspondences(
        left_px=rig.left.rectified(TABLE_3_15_LEFT_PX),
        right_px=rig.right.rectified(TABLE_3_15_RIGHT_PX),
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
) -> Section:
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
    headline = (
        f"`feature` mean {rows[-1][3]}, max {rows[-3][3]} mm; the thesis's method {rows[-1][6]}, {rows[-3][6]} mm"
    )
    return Section(headline, markdown_table(header, rows))


def _cells(depth: DepthError | None) -> tuple[str, str, str]:
    if depth is None:
        return "not found", "–", "–"
    return (
        decimals(abs(depth.calculated_m) * 1000, 2),
        decimals(depth.error_m * 1000, 2),
        decimals(depth.error_percent, 2),
    )
