"""The poses as they come: a table that renews itself on a terminal, a line a PoseArray elsewhere."""

from __future__ import annotations

import sys

Positions = list[tuple[float, float, float]]


class LiveTable:
    """Prints PoseArrays: stamp [ns], frame and positions [m], shown in millimetres."""

    def __init__(self) -> None:
        self._renews = sys.stdout.isatty()
        self._lines = 0
        self._count = 0

    def show(self, stamp_ns: int, frame_id: str, positions: Positions) -> None:
        """Print one PoseArray, on a terminal in the place of the last one."""
        self._count += 1
        if not self._renews:
            print(f"{stamp_ns / 1e9:.3f} {frame_id}  {_line(positions)}", flush=True)
            return
        rows = [f"{number:>3} {_row(position)}" for number, position in enumerate(positions, start=1)]
        table = [
            f"pose array {self._count}, stamp {stamp_ns / 1e9:.3f} s, frame {frame_id}",
            f"{'#':>3} {'x mm':>9} {'y mm':>9} {'z mm':>9}",
            *(rows or ["  no object"]),
        ]
        back = f"\x1b[{self._lines}A\x1b[J" if self._lines else ""
        print(back + "\n".join(table), flush=True)
        self._lines = len(table)


def _line(positions: Positions) -> str:
    return "  ".join(f"{n}: {_row(position)}" for n, position in enumerate(positions, start=1)) or "no object"


def _row(position: tuple[float, float, float]) -> str:
    return " ".join(f"{value * 1e3:9.1f}" for value in position)
