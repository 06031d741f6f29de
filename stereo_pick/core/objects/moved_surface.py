"""How a learned surface lies in a view where a camera, or the table, was pushed since: its own edges show it."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from stereo_pick.core.arrays import Bools, Floats

_BLURS_PX = (12.0, 6.0, 3.0, 1.5, 0.0)  # from coarse to fine: each finds what is left of a motion up to about as much
_ROUNDS = 3
_STEEP = 4.0  # sigmas of the view a pixel: where the surface has edges
_LEAST = 200  # pixels with edges, by which a motion is known
_OFF = 2.0  # sigmas by which most of these are off, at least, where something has moved
_BETTER = 0.45  # part of that which may be left, or no more than _OFF, where it did no more than move
_TURNS_PX = 300.0  # from the middle, where a turn moves about as much as a shift
_LOOSE = 1e-3
_BEYOND_PX = 8.0
_TINY = 1e-6

Picture = NDArray[np.float32]


@dataclass(frozen=True, eq=False)
class Motion:
    """warp: (2, 3), where in the picture that was learned each pixel (x, y, 1) of the view is; px: how far that is, as
    a median over its edges."""

    warp: Floats
    px: float

    def of(self, picture: Picture) -> Picture:
        """What was learned (h, w), where it is now."""
        return _warped(picture, self.warp)


def has_moved(level: Picture, seen: Picture, inside: Bools, sigma: float) -> bool:
    """Whether the edges of a surface (h, w) [grey levels] are elsewhere in a view of it (h, w); sigma: of the view
    around the surface, where that has no edges."""
    steep = _steep(level, inside, sigma)
    return bool(steep.sum() >= _LEAST) and _off(level, seen, steep) >= _OFF * sigma


def motion_of(level: Picture, seen: Picture, inside: Bools, sigma: float) -> Motion | None:
    """The motion after which a surface that has moved explains a view of it; None where none does."""
    warp = np.eye(2, 3)
    for blur_px in _BLURS_PX:
        coarse, seen_so = _blurred(level, blur_px), _blurred(seen, blur_px)
        for _ in range(_ROUNDS):
            warp = _nearer(coarse, seen_so, inside, sigma, warp)
    moved = _warped(level, warp)
    steep = _steep(moved, inside, sigma)
    before = _off(level, seen, _steep(level, inside, sigma))
    if steep.sum() < _LEAST or _off(moved, seen, steep) > max(_BETTER * before, _OFF * sigma):
        return None
    places = _places(steep)
    return Motion(warp, float(np.median(np.linalg.norm(places @ warp.T - places[:, :2], axis=1))))


def continued(picture: Picture, inside: Bools) -> Picture:
    """What was learned (h, w), gone on beyond what the camera saw of it then, from where a motion may take some."""
    shown = inside.astype(np.float32)
    around = _blurred(picture * shown, _BEYOND_PX) / np.maximum(_blurred(shown, _BEYOND_PX), np.float32(_TINY))
    return np.asarray(np.where(inside, picture, around), np.float32)


def _nearer(level: Picture, seen: Picture, inside: Bools, sigma: float, warp: Floats) -> Floats:
    """The warp (2, 3) after a robust step of Gauss and Newton (Lucas and Kanade 1981): parts hide some of the edges."""
    moved = _warped(level, warp)
    steep = _steep(moved, inside, sigma)
    if steep.sum() < _LEAST:
        return warp
    down, right = (each[steep].astype(np.float64) for each in _slopes(moved))
    places = _places(steep)
    middle = np.array([moved.shape[1] / 2, moved.shape[0] / 2])
    about = np.c_[(places[:, :2] - middle) / _TURNS_PX, np.ones(len(places))]
    columns = np.concatenate([about * right[:, None], about * down[:, None]], axis=1)
    off = (seen[steep] - moved[steep]).astype(np.float64)
    weight = 1 / (1 + (off / max(2 * float(np.median(np.abs(off))), sigma)) ** 2)
    normal = (columns * weight[:, None]).T @ columns
    step = np.linalg.solve(normal + _LOOSE * np.trace(normal) * np.eye(6) / 6, (columns * weight[:, None]).T @ off)
    by = step.reshape(2, 3)
    by[:, :2] /= _TURNS_PX
    by[:, 2] -= by[:, :2] @ middle
    whole = np.vstack([np.eye(2, 3) + by, [0, 0, 1]])
    return np.asarray(np.vstack([warp, [0, 0, 1]])[:2] @ whole)


def _steep(level: Picture, inside: Bools, sigma: float) -> Bools:
    """Where (h, w) a surface has edges of its own."""
    down, right = _slopes(level)
    return np.asarray(inside & (down * down + right * right > (_STEEP * sigma) ** 2))


def _slopes(level: Picture) -> tuple[Picture, Picture]:
    """How much brighter (h, w) it gets downwards, and to the right [grey levels a pixel]."""
    return np.asarray(np.gradient(level, axis=0), np.float32), np.asarray(np.gradient(level, axis=1), np.float32)


def _off(level: Picture, seen: Picture, steep: Bools) -> float:
    """By how much [grey levels] the view differs there, as a median."""
    return float(np.median(np.abs(seen[steep] - level[steep])))


def _places(where: Bools) -> Floats:
    """(N, 3), x, y and 1 of these pixels."""
    rows, columns = np.nonzero(where)
    return np.stack([columns, rows, np.ones(len(rows))], axis=1).astype(np.float64)


def _warped(picture: Picture, warp: Floats) -> Picture:
    flags = cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP
    size = picture.shape[1], picture.shape[0]
    return np.asarray(cv2.warpAffine(picture, warp, size, None, flags, cv2.BORDER_REPLICATE), np.float32)


def _blurred(picture: Picture, blur_px: float) -> Picture:
    return np.asarray(cv2.GaussianBlur(picture, (0, 0), blur_px) if blur_px else picture, np.float32)
