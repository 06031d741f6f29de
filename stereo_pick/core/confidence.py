"""The probability that a position is near enough, by its covariance."""

from __future__ import annotations

import numpy as np

from stereo_pick.core.arrays import Floats

_COUNT = 32  # the error falls as 2.85 to the power of -_COUNT: rounding is more
_THETA = np.pi * np.arange(1, _COUNT, 2) / _COUNT  # one half of the path, the other one is its mirror image
_PATH = _COUNT * (0.1309 - 0.1194 * _THETA**2 + 0.25j * _THETA)
_WEIGHTS = 2 * np.exp(_PATH) / _PATH * (0.25 + 2j * 0.1194 * _THETA)


def within(covariance: Floats, radius_m: float) -> Floats:
    """P(|e| <= radius_m), (N,), of errors e that are normal with mean 0 and covariance (N, 3, 3) [m²].

    |e|² is the sum of three independent squares whose variances v are the eigenvalues (Imhof 1961, Biometrika 48), so
    its Laplace transform is the product of (1 + 2 v s)^-1/2. That is inverted by the midpoint rule along the parabola
    of Weideman and Trefethen (2007, Mathematics of Computation 76), however unequal the variances, or zero.
    """
    variances = np.maximum(np.linalg.eigvalsh(covariance), 0.0)
    roots = np.sqrt(1 + 2 * variances[:, :, None] * _PATH / radius_m**2)
    share = (_WEIGHTS / roots.prod(axis=1)).sum(axis=1).real
    return np.asarray(np.clip(share, 0.0, 1.0))
