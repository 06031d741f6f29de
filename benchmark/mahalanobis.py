"""How squared Mahalanobis distances of published positions are distributed, beside chi-square."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from formatting import Row, percent

CHI2_3 = {50: 2.366, 68: 3.506, 90: 6.251, 95: 7.815, 99: 11.345}
"""The percentage points of chi-square with three degrees of freedom: what covariances that are right would give."""

HEADER: Row = ("poses", "median", *(f"{point} %" for point in CHI2_3 if point > 50), "< 7.81", "no object's")
CHI2_ROW: Row = ("", *(f"{value:.2f}" for value in CHI2_3.values()), "95.0 %", "")


def distribution_row(squares: Sequence[float]) -> Row:
    """Cells under HEADER; infinite ones are those of poses that are no object's."""
    if not squares:
        return ("0", *["–"] * (len(HEADER) - 2), "0")
    values = [float(np.percentile(squares, point, method="inverted_cdf")) for point in CHI2_3]
    return (
        str(len(squares)),
        *("∞" if np.isinf(value) else f"{value:.2f}" for value in values),
        covered(squares),
        str(int(np.isinf(squares).sum())),
    )


def covered(squares: Sequence[float]) -> str:
    """The share of positions within the region that holds 95 % if the covariances are right."""
    return percent(float(np.mean(np.array(squares) < CHI2_3[95])))
