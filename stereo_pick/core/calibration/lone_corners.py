"""Single corners that were found in a wrong place, through dirt, a reflection or a finger; the view stays."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from stereo_pick.core.arrays import Bools, Floats
from stereo_pick.core.calibration.views import FINEST_PX, MAD_TO_SIGMA

_FALSE_ALARMS = 0.05  # good corners lost in a whole recording, if their errors are normal
_TERMS = 6
_MIN_CORNERS = 2 * _TERMS
_MAX_SHARE = 0.2  # of a picture's corners; where more are wrong, the picture is
_MIN_CHECKED = 0.05  # of a corner's residual; with less the other corners say nothing of it


@dataclass(frozen=True)
class Corners:
    """One picture's corners: places (N, 2) on the board, in any unit, and residuals_px (N, 2), seen minus predicted."""

    places: Floats
    residuals_px: Floats


class _Departures(NamedTuple):
    """Of a picture's corners: distances (N,) [px] from where the others put them, the same made equally sure for all
    corners, and the standard deviation of a coordinate of the latter."""

    distance_px: Floats
    even_px: Floats
    sigma_px: float


def stand_out(pictures: Sequence[Corners]) -> list[Floats]:
    """How far [px] the single wrong corners of each picture are from where the others put them: (N,), 0 for good ones.

    What a model of the lens or of the board misses is smooth over the board: a quadratic function of the place there.
    A corner is wrong that departs from it farther than noise explains: that of its picture, or of most pictures where
    that is more, by the median of the absolute values. The limit follows from the number of corners.
    """
    count = sum(len(picture.places) for picture in pictures)
    large = [picture for picture in pictures if len(picture.places) >= _MIN_CORNERS]
    if not large:
        return [np.zeros(len(picture.places)) for picture in pictures]
    sigmas = math.sqrt(2 * math.log(count / _FALSE_ALARMS))
    usual_px = float(np.median([_departures(picture, np.ones(len(picture.places), np.bool_))[2] for picture in large]))
    return [_wrong_px(picture, sigmas, max(usual_px, FINEST_PX)) for picture in pictures]


def _wrong_px(picture: Corners, sigmas: float, usual_px: float) -> Floats:
    """Takes the worst corner out, again and again; all zeros where too many would go."""
    kept, wrong_px = np.ones(len(picture.places), np.bool_), np.zeros(len(picture.places))
    while kept.sum() >= max(_MIN_CORNERS, (1 - _MAX_SHARE) * len(kept)):
        distance_px, even_px, sigma_px = _departures(picture, kept)
        worst = int(even_px.argmax())
        if even_px[worst] <= sigmas * max(sigma_px, usual_px):
            return wrong_px
        corner = np.flatnonzero(kept)[worst]
        kept[corner], wrong_px[corner] = False, distance_px[worst]
    return np.zeros(len(kept))


def _departures(picture: Corners, kept: Bools) -> _Departures:
    """By the least-squares residuals of a quadratic function and their leverage."""
    q, _ = np.linalg.qr(_quadratic(picture.places)[kept])
    residuals_px = picture.residuals_px[kept]
    residuals_px = residuals_px - q @ (q.T @ residuals_px)
    checked = np.maximum(1 - (q**2).sum(axis=1), _MIN_CHECKED)[:, None]
    even_px = residuals_px / np.sqrt(checked)
    sigma_px = MAD_TO_SIGMA * float(np.median(np.abs(even_px)))
    return _Departures(np.linalg.norm(residuals_px / checked, axis=1), np.linalg.norm(even_px, axis=1), sigma_px)


def _quadratic(places: Floats) -> Floats:
    """The terms (N, 6) of a quadratic function of the places (N, 2)."""
    centred = places - places.mean(axis=0)
    x, y = (centred / max(float(np.abs(centred).max()), 1e-12)).T
    return np.stack([np.ones_like(x), x, y, x * x, x * y, y * y], axis=1)
