"""An object's outline in one view, made ready for fitting: few points, evenly spaced, with their normals."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from stereo_pick.core.arrays import Bools, Floats, Ints, floats
from stereo_pick.core.errors import ArrayError

POINTS = 40
_FINE = 4  # samples of the contour for each point of the outline
_SMOOTHING = np.array([-3.0, 12.0, 17.0, 12.0, -3.0]) / 35.0
_SLOPE = np.arange(-4.0, 5.0) / 60.0
_BEHIND, _AHEAD = np.append(np.arange(-2.0, 3.0), np.zeros(8)), np.append(np.zeros(8), np.arange(-2.0, 3.0))
_CORNER_COSINE = np.cos(np.deg2rad(36))  # a round outline turns by 18 degrees between the two places


Complex = NDArray[np.complex128]
Number = TypeVar("Number", np.float64, np.complex128)


@dataclass(frozen=True, eq=False)
class Outline:
    """N points around an object, at equal distances along its contour.

    points_px: (N, 2) in a rectified view; normals: (N, 2), unit, outward; weight: (N,), 1 where the point shows
    the object's edge, 0 where something else ends it there; corner: (N,), 1 where the outline turns sharply: what
    a corner tells is roughly right, but blur and smoothing round it. Outlines of the same points and weights are
    equal: the same object may be cut out in several ways, and is searched for once.
    """

    points_px: Floats
    normals: Floats
    weight: Floats
    corner: Floats

    def __post_init__(self) -> None:
        count = len(self.weight)
        for name, shape in (
            ("points_px", (count, 2)),
            ("normals", (count, 2)),
            ("weight", (count,)),
            ("corner", (count,)),
        ):
            object.__setattr__(self, name, floats(name, getattr(self, name), *shape))

    @cached_property
    def _told(self) -> bytes:
        return self.points_px.tobytes() + self.weight.tobytes()

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Outline) and self._told == other._told

    def __hash__(self) -> int:
        return hash(self._told)

    @staticmethod
    def from_contour(contour_px: Floats, trusted: Bools | None = None, points: int = POINTS) -> Outline:
        """Resample a closed contour (N, 2) [px]; trusted (N,) says which of its points are the object's own edge.

        A moving parabola (Savitzky and Golay 1964) averages the noise: a moving mean would draw every curve inwards.
        Its slope gives the normals. Raises ArrayError for a contour of no length.
        """
        contour = contour_px if _signed_area(contour_px) > 0 else contour_px[::-1]
        if trusted is None:
            own = np.ones(len(contour))
        else:
            own = np.asarray(trusted if contour is contour_px else trusted[::-1], np.float64)
        closed = np.concatenate([contour, contour[:1]])
        along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(closed, axis=0), axis=1))])
        if not along[-1] > 0:
            raise ArrayError("contour_px has no length: all its points are the same")
        at = np.arange(points * _FINE) * (along[-1] / (points * _FINE))
        fine = np.interp(at, along, closed[:, 0] + 1j * closed[:, 1])
        place, slope = _around(fine, _SMOOTHING), _around(fine, _SLOPE)
        normals = _as_points(-1j * slope / (np.abs(slope) + 1e-12))
        shown = np.interp(at, along, np.append(own, own[0]))
        weight = _around(shown, np.ones(len(_SMOOTHING))) > len(_SMOOTHING) - 0.5
        corner = _corners(fine)
        return Outline(_as_points(place), normals, weight.astype(np.float64), corner.astype(np.float64))


def _corners(fine: Complex) -> Bools:
    """Which points of the outline lie where it turns sharply."""
    turn = _around(fine, _AHEAD) * _around(fine, _BEHIND).conj()
    return np.asarray(turn.real < _CORNER_COSINE * np.abs(turn))


def _around(values: NDArray[Number], kernel: Floats) -> NDArray[Number]:
    """Correlate closed fine samples with a kernel, at every point of the outline."""
    return np.asarray(values[_windows(len(values), len(kernel))] @ kernel)


@lru_cache(maxsize=16)
def _windows(count: int, width: int) -> Ints:
    """The indices (N, width) of the closed fine samples around each point of the outline."""
    return np.asarray((np.arange(0, count, _FINE)[:, None] + np.arange(width) - width // 2) % count)


def _as_points(values: Complex) -> Floats:
    return np.stack([values.real, values.imag], axis=1)


def _signed_area(contour: Floats) -> float:
    x, y = contour.T
    return 0.5 * float(x @ np.roll(y, -1) - y @ np.roll(x, -1))
