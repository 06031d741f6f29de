"""How often published positions are as near as their confidence says."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from family_scoring import SceneScore
from formatting import Row, decimals, markdown_table

from stereo_pick.core.arrays import Floats
from stereo_pick.core.confidence import within

TOLERANCES_M = (0.0005, 0.001, 0.002, 0.005)
_BOUNDS = (0.5, 0.9, 0.99, 0.999)
_BINS = ("below 0.5", "0.5 to 0.9", "0.9 to 0.99", "0.99 to 0.999", "above 0.999")


def reliability_table(scores: Sequence[SceneScore]) -> str:
    """Of all poses that were published, by their confidence: how many are farther off than that says, and really."""
    covariance = np.concatenate([each.covariances for each in scores])
    off_m = np.concatenate([each.off_m for each in scores])
    rows = [row for radius_m in TOLERANCES_M for row in _rows(radius_m, within(covariance, radius_m), off_m)]
    header = ("tolerance", "confidence", "poses", "mean confidence", "within", "expected beyond", "beyond")
    return markdown_table(header, rows)


def _rows(radius_m: float, stated: Floats, off_m: Floats) -> list[Row]:
    where = np.digitize(stated, _BOUNDS)
    return [
        (f"{1000 * radius_m:g} mm", name, *_cells(stated[where == place], off_m[where == place] > radius_m))
        for place, name in enumerate(_BINS)
    ]


def _cells(stated: Floats, beyond: np.ndarray) -> Row:
    if len(stated) == 0:
        return ("0", "–", "–", "–", "–")
    return (
        str(len(stated)),
        decimals(float(stated.mean()), 4),
        decimals(float(1 - beyond.mean()), 4),
        decimals(float((1 - stated).sum()), 2),
        str(int(beyond.sum())),
    )
