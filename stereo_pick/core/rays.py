"""Two rays of one point, and where they meet (thesis eq. 3.21)."""

from __future__ import annotations

import numpy as np

from stereo_pick.core.arrays import Floats
from stereo_pick.core.transform import Transform


def closest_points(left_rays: Floats, right_rays: Floats, right_T_left: Transform) -> tuple[Floats, Floats]:
    """Where each ray comes nearest to its partner: points (N, 3) [m] on the left and on the right ray, left frame.

    The closed form of eq. 3.21: `[Z_R, Z_L] = (A'A)^-1 A'T` with `A = [alpha, p_l]`, `alpha = -R p_r`, solved for
    both depths. Rays (N, 3) in each camera's own frame. Parallel rays meet nowhere: they come out behind the camera.
    """
    left_T_right = right_T_left.inverse()
    p, T = left_rays, left_T_right.translation
    alpha = -right_rays @ left_T_right.rotation.T
    pp, aa, ap = (p * p).sum(axis=1), (alpha * alpha).sum(axis=1), (alpha * p).sum(axis=1)
    aT, pT = alpha @ T, p @ T
    determinant = aa * pp - ap * ap
    parallel = determinant < 1e-12 * aa * pp
    determinant = np.where(parallel, 1.0, determinant)
    z_right = np.where(parallel, -1.0, (pp * aT - ap * pT) / determinant)
    z_left = np.where(parallel, -1.0, (aa * pT - ap * aT) / determinant)
    return p * z_left[:, None], T - alpha * z_right[:, None]
