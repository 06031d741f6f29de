"""Where a round part ends that is as bright there as what is behind it: no step shows that, but its shading begins.

Going around a part, that is so wherever it passes from brighter to darker than the table; and metal, the light on which
falls off steeply towards its limb, may be so half around.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from stereo_pick.core.arrays import Bools, Floats
from stereo_pick.core.objects.edge_model import BLURS_PX, OFFSETS_PX, SHADING_POWER, blurred, vertex

SIGMA_PX = 0.5  # of the place: how steeply the light falls off is not known
_STEP_PX = 0.2
_PLACES_PX = np.arange(-1.2, 1.21, _STEP_PX)
_ROUNDING = len(OFFSETS_PX) / 12  # squared grey levels, of a profile
# How many times the squares must be less that remain if the shading begins there than if light changes smoothly, as a
# parabola, which has as many parameters: 50 to 1, if every second sample tells something of its own.
_CLEARLY = 3.0


def fading_limbs(profiles: Floats, blur_px: float) -> tuple[Floats, Bools]:
    """Where (N,) along OFFSETS_PX, outside to inside, shading begins in profiles (N, len(OFFSETS_PX)), and whether (N,)
    that explains them clearly better than light that changes smoothly."""
    change = profiles - profiles.mean(axis=1, keepdims=True)
    total = (change * change).sum(axis=1)
    squares = total[:, None] - (change @ _shadings(blur_px)) ** 2
    least = squares.argmin(axis=1)
    best, row = np.clip(least, 1, len(_PLACES_PX) - 2), np.arange(len(least))
    before, at, after = (squares[row, best + by] for by in (-1, 0, 1))
    smooth = total - ((change @ _SMOOTH) ** 2).sum(axis=1)
    found = (best == least) & (smooth > _CLEARLY * (at + _ROUNDING))
    return _PLACES_PX[best] + vertex(before, at, after) * _STEP_PX, found


def _smooth() -> Floats:
    """What a parabola has less its mean: (len(OFFSETS_PX), 2), orthonormal."""
    powers = np.stack([np.ones(len(OFFSETS_PX)), OFFSETS_PX, OFFSETS_PX**2], axis=1)
    return np.asarray(np.linalg.qr(powers)[0][:, 1:])


_SMOOTH = _smooth()


@lru_cache(maxsize=len(BLURS_PX))
def _shadings(blur_px: float) -> Floats:
    """The shading (len(OFFSETS_PX), E) less its mean, unit, that begins at each of E places."""
    shading = np.stack([blurred(SHADING_POWER, OFFSETS_PX - place, blur_px) for place in _PLACES_PX], axis=1)
    shading -= shading.mean(axis=0)
    return np.asarray(shading / np.linalg.norm(shading, axis=0))
