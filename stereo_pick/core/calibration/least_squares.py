"""Overdetermined linear systems `A x = b`, by the thesis's two ways (1.6, 1.6.1)."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from stereo_pick.core.arrays import Floats

LinearSolver = Callable[[Floats, Floats], Floats]


def solve_by_svd(A: Floats, b: Floats) -> Floats:
    """The x (n,) that minimises `|A x - b|`, A (m, n) of rank n: `A = U D V'`, `y = U'b / d`, `x = V y` (eq. 1.32)."""
    U, d, Vt = np.linalg.svd(A, full_matrices=False)
    return np.asarray(Vt.T @ (U.T @ b / d))


def solve_by_normal_equations(A: Floats, b: Floats) -> Floats:
    """The x (n,) that minimises `|A x - b|`, A (m, n) of rank n: `(A'A) x = A'b` (1.6.1).

    The condition of A'A is the square of A's: half of the digits are lost, which scaled unknowns can afford.
    """
    return np.asarray(np.linalg.solve(A.T @ A, A.T @ b))


def condition(A: Floats) -> float:
    """Largest by smallest singular value of A (m, n), m >= n: infinite where the columns depend on each other."""
    d = np.linalg.svd(A, compute_uv=False)
    return float(d[0] / d[-1]) if d[-1] > 0 else float("inf")


SOLVERS: dict[str, LinearSolver] = {"svd": solve_by_svd, "normal_equations": solve_by_normal_equations}
