"""The windows of method `ssd` around every pixel: a disparity map, in which each pixel is found or refused."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stereo_pick.core.arrays import Floats, Image, Ints
from stereo_pick.core.noise import noise_dn
from stereo_pick.core.windows.matching import Evidence, WindowMatching
from stereo_pick.core.windows.refinement import refine
from stereo_pick.core.windows.sweep import sweep
from stereo_pick.core.windows.texture import predicted_sigma_px
from stereo_pick.core.windows.window import Grey

_FAR_PX = 1e6


@dataclass(frozen=True, eq=False)
class DisparityMap:
    """disparity_px: (H, W), `u_left - u_right` of each left pixel, NaN where it was refused; sigma_px: (H, W), one
    sigma of it; reason: (H, W), why it was refused, a reason of `refusal.REASONS`, or empty.
    """

    disparity_px: Floats
    sigma_px: Floats
    reason: NDArray[np.str_]


def disparity_map(
    left: Image, right: Image, limits_px: tuple[int, int], matching: WindowMatching | None = None
) -> DisparityMap:
    """Match every pixel of a rectified grey pair (H, W) at disparities from the least to the greatest of `limits_px`.

    Each pixel is tried with the narrowest window that its texture allows, and with wider ones until one is believed.
    """
    matching = matching or WindowMatching()
    views = left.astype(np.float32), right.astype(np.float32)
    noise = noise_dn(views[0])
    disparity_px, sigma_px = np.full(left.shape, np.nan), np.full(left.shape, np.inf)
    reason = np.full(left.shape, "no_texture")
    sizes = matching.sizes_px()
    for window_px in sizes:
        predicted_px = predicted_sigma_px(views[0], noise, window_px, matching.cost)
        at = np.nonzero((reason != "") & (predicted_px <= matching.enough_px(last=window_px == sizes[-1])))
        disparity_px[at], sigma_px[at], reason[at] = _match(views, at, limits_px, window_px, matching)
    disparity_px[reason != ""] = np.nan
    return DisparityMap(disparity_px, sigma_px, reason)


def _match(
    views: tuple[Grey, Grey], at: tuple[Ints, ...], limits_px: tuple[int, int], window_px: int, matching: WindowMatching
) -> tuple[Floats, Floats, NDArray[np.str_]]:
    """Disparities, sigmas and reasons (N,) of the pixels `at` rows and columns (N,), by windows of one size."""
    one, other = views
    whole = sweep(one, other, limits_px, window_px, matching.cost)
    back = sweep(other[:, ::-1], one[:, ::-1], limits_px, window_px, matching.cost)
    v, u = at
    start_px = whole.disparity_px[at]
    before = Evidence.before_refinement(
        whole.uniqueness[at], _return_px(u, v, start_px, back.disparity_px[:, ::-1]), matching.max_sigma_px
    )
    reason = matching.judge(before)
    disparity_px, sigma_px = start_px.astype(np.float64), before.sigma_px.copy()
    some = np.flatnonzero(reason == "")
    points = np.stack([u, v], axis=1)[some].astype(np.float64)
    columns_px = points[:, 0] - start_px[some]
    fits = refine(views, points, columns_px, window_px, matching.cost, points + whole.shift_px[at][some])
    disparity_px[some], sigma_px[some] = points[:, 0] - fits.column_px, fits.sigma_px
    within = (disparity_px >= limits_px[0] - 0.5) & (disparity_px <= limits_px[1] + 0.5)
    evidence = Evidence(fits.sigma_px, fits.similarity, within[some], before.uniqueness[some], before.return_px[some])
    reason[some] = matching.judge(evidence)
    return disparity_px, sigma_px, reason


def _return_px(u: Ints, v: Ints, disparity_px: Ints, back_px: Ints) -> Floats:
    """By how much each match (N,), followed back by the other view's disparities (H, W), comes out beside its start."""
    width = back_px.shape[1]
    there = u - disparity_px
    beside = np.abs(disparity_px - back_px[v, np.clip(there, 0, width - 1)])
    return np.where((there >= 0) & (there < width), beside, _FAR_PX)
