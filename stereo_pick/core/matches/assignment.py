"""One-to-one assignment of least total cost."""

from __future__ import annotations

import numpy as np

from stereo_pick.core.arrays import Floats


def assign(cost: Floats, unmatched_cost: float) -> list[tuple[int, int]]:
    """Return (row, column) pairs that minimise the sum of their costs plus `unmatched_cost` for each row without one.

    cost: (N, M), inf where a pair is impossible. The Hungarian method by shortest augmenting paths
    (Jonker and Volgenant 1987), on the cost matrix widened by one private dummy column a row.
    """
    rows, columns = cost.shape
    if rows == 0:
        return []
    forbidden = 1e6 * max(1.0, unmatched_cost)
    dummies = np.full((rows, rows), forbidden)
    np.fill_diagonal(dummies, unmatched_cost)
    wide = np.hstack([np.where(np.isfinite(cost), cost, forbidden), dummies])
    row_of = _solve(wide)
    return [
        (int(row), column) for column, row in enumerate(row_of[:columns]) if row >= 0 and np.isfinite(cost[row, column])
    ]


def _solve(cost: Floats) -> list[int]:
    """The row that each column is assigned to, or -1; every row of a wide matrix (N, M >= N) gets one column."""
    rows, columns = cost.shape
    row_price, column_price = np.zeros(rows), np.zeros(columns)
    row_of = [-1] * columns
    for free_row in range(rows):
        least = np.full(columns, np.inf)
        came_from = [-1] * columns
        done = np.zeros(columns, bool)
        row, column = free_row, -1
        while True:
            reduced = cost[row] - row_price[row] - column_price
            if column >= 0:
                reduced = reduced + least[column]
            for better in np.flatnonzero(~done & (reduced < least)):
                least[better], came_from[better] = reduced[better], column
            next_column = int(np.where(done, np.inf, least).argmin())
            if row_of[next_column] < 0:
                break
            done[next_column] = True
            column, row = next_column, row_of[next_column]
        shortest = least[next_column]
        visited = np.flatnonzero(done)
        row_price[free_row] += shortest
        for other in visited:
            row_price[row_of[other]] += shortest - least[other]
            column_price[other] -= shortest - least[other]
        while next_column >= 0:
            previous = came_from[next_column]
            row_of[next_column] = free_row if previous < 0 else row_of[previous]
            next_column = previous
    return row_of
