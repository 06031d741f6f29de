"""Object-to-object depths (thesis tables 3.13 to 3.16): what the thesis measures its accuracy by."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

from stereo_pick.core.arrays import Floats


@dataclass(frozen=True)
class DepthBetween:
    """Depth between two objects, `Z(second) - Z(first)` in the left optical frame [m]; objects count from 1."""

    first: int
    second: int
    depth_m: float


@dataclass(frozen=True)
class DepthError:
    """One row of the thesis's tables: a depth between objects, true and calculated [m]."""

    name: str
    actual_m: float
    calculated_m: float

    @property
    def error_m(self) -> float:
        """Size of the error [m]; both depths must be counted in the same direction."""
        return abs(self.calculated_m - self.actual_m)

    @property
    def error_percent(self) -> float:
        """Error as a part of the true depth [%]."""
        return 100 * self.error_m / abs(self.actual_m)


def depths_between(xyz: Floats) -> list[DepthBetween]:
    """The depth between every two of N objects at `xyz` (N, 3) [m]."""
    return [DepthBetween(a + 1, b + 1, float(xyz[b, 2] - xyz[a, 2])) for a, b in combinations(range(len(xyz)), 2)]


def depth_table(rows: Sequence[DepthError]) -> str:
    """A table as the thesis prints it: actual and calculated depth, error, percentage, and the error's extremes."""
    lines = [f"{'Case':<24} {'Actual mm':>10} {'Calculated mm':>14} {'Error mm':>9} {'Error %':>8}"]
    lines += [
        f"{row.name:<24} {row.actual_m * 1e3:>10.2f} {row.calculated_m * 1e3:>14.2f} "
        f"{row.error_m * 1e3:>9.2f} {row.error_percent:>8.2f}"
        for row in rows
    ]
    errors_mm = [row.error_m * 1e3 for row in rows]
    if errors_mm:
        lines.append(f"{'Maximum depth error':<50} {max(errors_mm):>9.2f}")
        lines.append(f"{'Minimum depth error':<50} {min(errors_mm):>9.2f}")
        lines.append(f"{'Average depth error':<50} {sum(errors_mm) / len(errors_mm):>9.2f}")
    return "\n".join(lines)
