"""Outlines and rectified images drawn directly, for tests of one step of the pipeline alone."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence

import cv2
import numpy as np
from rigs import SIZE_PX, camera

from stereo_pick.core.arrays import Floats, Image
from stereo_pick.core.frames import RectifiedPair
from stereo_pick.core.objects import Blob, Blobs
from stereo_pick.core.rig import StereoRig
from stereo_pick.core.transform import Transform

BASELINE_M = 0.1
PARALLEL = StereoRig.from_extrinsics(
    camera("left"), camera("right"), Transform(np.eye(3), np.array([-BASELINE_M, 0.0, 0.0]))
)
"""A rig whose rectified view is its raw view, without distortion."""

Disc = tuple[float, float, float]


def disc(x_px: float, y_px: float, radius_px: float = 20.0, fault: str = "", points: int = 64) -> Blob:
    """A round outline of about this radius."""
    angle = np.linspace(0, 2 * np.pi, points, endpoint=False)
    contour = np.stack([x_px + radius_px * np.cos(angle), y_px + radius_px * np.sin(angle)], axis=1)
    return Blob(contour, contrast=100.0, fault=fault)


def seen(left: Iterable[Blob], right: Iterable[Blob]) -> Blobs:
    return Blobs(tuple(left), tuple(right), "bright")


def blank_pair(rig: StereoRig = PARALLEL, level: int = 50) -> RectifiedPair:
    """A pair of even grey, for methods that look at outlines only."""
    return RectifiedPair(*(np.full(SIZE_PX[::-1], level, np.uint8) for _ in range(2)), rig)


def grey_image(light: Floats, blur_px: float = 0.7, noise_dn: float = 0.0, seed: int = 0) -> Image:
    """Grey levels (H, W) as a camera would give them."""
    blurred = cv2.GaussianBlur(light, (0, 0), blur_px) if blur_px else light
    noise = np.random.default_rng(seed).normal(0, noise_dn, light.shape)
    return np.clip(np.round(blurred + noise), 0, 255).astype(np.uint8)


def discs(places: Sequence[Disc], surface: float = 200.0, background: float | Floats = 50.0) -> Floats:
    """Light (H, W) of even discs (x, y, radius) [px]; each pixel gets the part of it that they cover."""
    fine = 8
    v, u = np.mgrid[: SIZE_PX[1], : SIZE_PX[0]].astype(np.float64)
    light = np.zeros(u.shape) + background
    step = (np.arange(fine) + 0.5) / fine - 0.5
    for x, y, radius in places:
        box = np.s_[int(y - radius) - 2 : int(y + radius) + 4, int(x - radius) - 2 : int(x + radius) + 4]
        du, dv = u[box][..., None, None] + step - x, v[box][..., None, None] + step[:, None] - y
        covered = (du**2 + dv**2 < radius**2).mean(axis=(2, 3))
        light[box] += covered * (surface - light[box])
    return light


def tiles(low: float, high: float, size_px: int = 40) -> Floats:
    """Square tiles of many grey levels."""
    rows, columns = (-(-length // size_px) for length in SIZE_PX[::-1])
    grey = np.random.default_rng(1).uniform(low, high, (rows, columns))
    return np.kron(grey, np.ones((size_px, size_px)))[: SIZE_PX[1], : SIZE_PX[0]]


def pattern(seed: int = 1, contrast: float = 40.0) -> Callable[[Floats, Floats], Floats]:
    """A smooth texture over the plane [px], known at every point: waves of 5 to 15 px."""
    rng = np.random.default_rng(seed)
    angle, length, phase = rng.uniform(0, np.pi, 12), rng.uniform(5, 15, 12), rng.uniform(0, 2 * np.pi, 12)
    fu, fv = 2 * np.pi * np.cos(angle) / length, 2 * np.pi * np.sin(angle) / length

    def grey(u: Floats, v: Floats) -> Floats:
        waves = sum(np.cos(a * u + b * v + c) for a, b, c in zip(fu, fv, phase))
        return np.asarray(120 + contrast * waves / np.sqrt(6), np.float64)

    return grey
