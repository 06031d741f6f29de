"""Table 3.13 and its counterpart: the same depths between two cylinders, seen over 66 cm and over 20 cm of baseline."""

from __future__ import annotations

import statistics
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from formatting import Row, Section, decimals, markdown_table
from rendering import Cylinder, Scene, render, table
from rendering.rigs import looking_at, thesis_cameras
from rivals import FEATURE, THESIS_FEATURE, contenders
from thesis_printed import TABLE_3_13

from stereo_pick.core.arrays import Floats
from stereo_pick.core.rig import StereoRig

_SIZE_M = (0.042, 0.042, 0.052)  # as in the scenes of table 3.14
_ASIDE_M = 0.06
_TILT_DEG = 40.0
_GATE_M = 0.06


def table_3_13() -> Section:
    """Errors of the depth over both baselines, by the package and by the thesis's method, on the same scenes."""
    ways = [
        (baseline_m, name, list(_errors_mm(baseline_m, near_m, name)))
        for baseline_m, near_m in ((0.66, 1.10), (0.20, 0.90))
        for name in (FEATURE, THESIS_FEATURE)
    ]
    rows: list[Row] = []
    for k, (case, actual_cm, calculated_cm, error_cm, _) in enumerate(TABLE_3_13):
        printed = decimals(actual_cm * 10, 0), decimals(calculated_cm * 10, 0), decimals(error_cm * 10, 1)
        rows.append([f"case {case}", *printed, *(_cell(errors[k]) for *_, errors in ways)])
    columns = [[line[3] * 10 for line in TABLE_3_13], *([e for e in errors if e is not None] for *_, errors in ways)]
    for label, extreme in (("maximum", max), ("average", statistics.fmean)):
        rows.append([label, "", "", *(decimals(extreme(column), 2) if column else "–" for column in columns)])
    header = ["table 3.13", "actual mm", "printed: mm", "printed, 66 cm: error mm"]
    text = markdown_table([*header, *(f"{name}, {b * 100:.0f} cm: error mm" for b, name, _ in ways)], rows)
    return Section(
        f"mean {rows[-1][4]}, max {rows[-2][4]} mm with 66 cm; {rows[-1][6]}, {rows[-2][6]} with 20 cm", text
    )


def _cell(error_mm: float | None) -> str:
    return "not found" if error_mm is None else decimals(error_mm, 2)


def _errors_mm(baseline_m: float, near_m: float, contender: str) -> Iterator[float | None]:
    """The error of each case's depth; None where a cylinder was not found. The first one stands at near_m."""
    rig = _rig(baseline_m, near_m)
    (locate,) = (each.locate for each in contenders(rig) if each.name == contender)
    for seed, (_, actual_cm, *_) in enumerate(TABLE_3_13):
        scene = _two_cylinders(near_m, actual_cm / 100)
        found_m = locate(render(rig, scene, seed=seed)).xyz
        nearest = [_nearest(found_m, true_m) for true_m in scene.positions_m()]
        if any(each is None for each in nearest):
            yield None
            continue
        first, second = nearest
        yield abs(float(second[2] - first[2]) - actual_cm / 100) * 1000  # type: ignore[index]


def _rig(baseline_m: float, near_m: float) -> StereoRig:
    """The thesis's two cameras, turned alike towards a point near_m before both."""
    left, right, _ = thesis_cameras()
    turn = np.arcsin(baseline_m / 2 / near_m)
    centre_m = baseline_m * np.array([np.cos(turn), 0.0, np.sin(turn)])
    return StereoRig.from_extrinsics(left, right, looking_at(centre_m, (0.0, 0.0, near_m)))


def _two_cylinders(near_m: float, depth_m: float) -> Scene:
    """Cylinders side by side on the table, the second `depth_m` behind the first, which stands at near_m."""
    reach_m = depth_m / np.sin(np.deg2rad(_TILT_DEG))
    scene = Scene(
        (Cylinder(-_ASIDE_M, -reach_m / 2, _SIZE_M), Cylinder(_ASIDE_M, reach_m / 2, _SIZE_M)),
        table(near_m, _TILT_DEG),
    )
    return replace(scene, left_T_table=table(2 * near_m - float(scene.positions_m()[0, 2]), _TILT_DEG))


def _nearest(found_m: Floats, true_m: Floats) -> Floats | None:
    off_m = np.linalg.norm(found_m - true_m, axis=1)
    return found_m[off_m.argmin()] if len(off_m) and off_m.min() <= _GATE_M else None
