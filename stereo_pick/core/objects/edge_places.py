"""Where in a profile a surface ends, as exactly as can be said: what is inside may shade, and what is outside.

The table darkens towards the foot of a part, and lightens where a lit side shines onto it. To look for edges with so
free a model would find them in any pattern; where it is known that there is one, it says where, and how surely.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from stereo_pick.core.arrays import Floats
from stereo_pick.core.objects.edge_model import OFFSETS_PX, SHADING_POWER, blurred

_SAMPLES = slice(1, -1)  # of OFFSETS_PX: the outermost show other things most often
_AT_PX = OFFSETS_PX[_SAMPLES]
_PLACES_PX = np.arange(-1.2, 1.21, 0.1)
_INDEPENDENT = len(_AT_PX) / 2  # samples: blur makes neighbours so near alike
_PRICE = _INDEPENDENT ** (1 / _INDEPENDENT)  # of one more unknown (the Bayesian information criterion)
_ROUNDING2 = 1 / 12  # [grey levels²] of 8 bits
_MISFIT = 0.01  # of the profile's range: no lens blurs just as a Gaussian does


def places_px(profiles: Floats, blur_px: float) -> tuple[Floats, Floats]:
    """Where (N,) along OFFSETS_PX the surface ends in profiles (N, len(OFFSETS_PX)), and one sigma (N,) of that.

    Steps with shading behind, before and on both sides are fitted at each of a grid of places; the mean place is taken,
    weighed by the Bayesian information criterion.
    """
    profiles = profiles[:, _SAMPLES]
    change = profiles - profiles.mean(axis=1, keepdims=True)
    step, behind, before, also = ((change @ basis) ** 2 for basis in _bases(blur_px))
    expected = len(_AT_PX) * (_ROUNDING2 + (_MISFIT * np.ptp(profiles, axis=1)) ** 2)
    left = ((change**2).sum(axis=1) + expected)[:, None] - step
    ways = np.stack([left - behind, left - before, (left - behind - also) * _PRICE], axis=1)
    weight = ((ways / ways.min(axis=(1, 2), keepdims=True)) ** (-_INDEPENDENT / 2)).sum(axis=1)
    weight /= weight.sum(axis=1, keepdims=True)
    place = weight @ _PLACES_PX
    return place, np.sqrt(np.maximum(weight @ _PLACES_PX**2 - place**2, 0.0))


@lru_cache(maxsize=8)
def _bases(blur_px: float) -> list[Floats]:
    """What a profile may show, less its mean, for each of P places, (M, P) and of unit length: a step; beside that,
    shading behind it, or before it; beside both, shading before it."""
    columns = []
    for place_px in _PLACES_PX:
        inside = _AT_PX - place_px
        step = blurred(0.0, inside, blur_px)
        behind, before = (blurred(SHADING_POWER, side, blur_px) for side in (inside, -inside))
        both, other = (np.stack(each, axis=1) for each in ((step, behind, before), (step, before)))
        (one, two, three), (_, four) = (np.linalg.qr(each - each.mean(axis=0))[0].T for each in (both, other))
        columns.append((one, two, four, three))
    return [np.stack(each, axis=1) for each in zip(*columns)]
