"""A work surface learned from pairs that show it empty: planks, prints and the edge of the table are known then.

It is learned in the rectified views, which are what segmentation sees, and belongs to one calibration.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from stereo_pick.core.arrays import Floats, Image, frozen
from stereo_pick.core.calibration.fingerprint import calibration_hash
from stereo_pick.core.camera import Camera
from stereo_pick.core.errors import CalibrationError, ImageError
from stereo_pick.core.frames import RectifiedPair
from stereo_pick.core.objects.background import Window, grid_stride_px, refined, spread
from stereo_pick.core.objects.exposure import check_shows_something
from stereo_pick.core.objects.moved_surface import continued, has_moved, motion_of
from stereo_pick.core.objects.view import View
from stereo_pick.core.rig import StereoRig

PAIRS_TO_LEARN = 20
"""As many as it takes for the noise of a pixel to be known to 16 %."""

MIN_PAIRS = 3
NOISE_STEPS = 16  # a noise of one grey level, as it is stored
_TRIALS = 250
_CHECKED = 200
_MIN_DIFFERENCE = 4.0  # grey levels from which two samples tell of the gain


@dataclass(frozen=True, eq=False)
class LearnedView:
    """What the empty surface shows in one rectified view: mean (H, W) uint8 [grey levels]; noise (H, W) uint8, its one
    sigma [1/16 grey level]."""

    mean: Image
    noise: Image

    def __post_init__(self) -> None:
        for name in ("mean", "noise"):
            picture = getattr(self, name)
            if picture.dtype != np.uint8 or picture.ndim != 2 or picture.shape != self.mean.shape:
                raise ImageError(f"{name} is {picture.dtype} of shape {picture.shape}, must be uint8 {self.mean.shape}")
            frozen(picture)


@dataclass(frozen=True, eq=False)
class LearnedBackground:
    """The empty surface in both views, the hash of the calibration that rectified them, and how many pairs it is of."""

    left: LearnedView
    right: LearnedView
    calibration_hash: str
    pairs: int

    def check(self, rig: StereoRig) -> None:
        """Raise CalibrationError where it was learned with another calibration, or at another image size."""
        for side, camera in (("left", rig.left), ("right", rig.right)):
            height, width = getattr(self, side).mean.shape
            if (width, height) != camera.frame_size:
                raise CalibrationError(
                    f"the background was learned from {side} images of {width} x {height}, but the calibration is for "
                    f"{camera.width_px} x {camera.height_px}: learn it again"
                )
        if self.calibration_hash != calibration_hash(rig):
            raise CalibrationError(
                f"the background was learned with another calibration ({self.calibration_hash}) than the one in use "
                f"({calibration_hash(rig)}): learn it again"
            )

    def adjusted(self, views: tuple[View, View], rig: StereoRig) -> list[AdjustedBackground]:
        """What both views of this rig show of it; raises CalibrationError as `check`."""
        self.check(rig)
        sides = zip((self.left, self.right), views, (rig.left, rig.right))
        return [adjusted(*each) for each in sides]


@dataclass
class BackgroundLearner:
    """Collects rectified pairs of the empty surface, all of one rig."""

    pairs: int = 0
    _rig: StereoRig | None = None
    _sums: dict[str, Floats] = field(default_factory=dict)
    _squares: dict[str, Floats] = field(default_factory=dict)

    def add(self, pair: RectifiedPair) -> None:
        """Take one pair in; raises CalibrationError where the calibration has changed in between."""
        if self._rig is not None and calibration_hash(self._rig) != calibration_hash(pair.rig):
            raise CalibrationError("the calibration changed while the background was being learned: learn it again")
        self._rig = pair.rig
        for side in ("left", "right"):
            grey = getattr(pair, side).astype(np.float64)
            self._sums[side] = self._sums.get(side, 0.0) + grey
            self._squares[side] = self._squares.get(side, 0.0) + grey * grey
        self.pairs += 1

    def finished(self) -> LearnedBackground:
        """What was learned; raises ImageError from fewer than MIN_PAIRS pairs, or from views that show nothing."""
        mean = self.mean_pair()
        check_shows_something("left", mean.left, mean.rig.left)
        check_shows_something("right", mean.right, mean.rig.right)
        return LearnedBackground(self._view("left"), self._view("right"), calibration_hash(mean.rig), self.pairs)

    def mean_pair(self) -> RectifiedPair:
        """What the pairs taken in show on average; raises ImageError where there are too few, as of `finished`."""
        if self._rig is None or self.pairs < MIN_PAIRS:
            raise ImageError(f"{self.pairs} pairs are too few to learn a background from: give at least {MIN_PAIRS}")
        return RectifiedPair(self._view("left").mean, self._view("right").mean, self._rig)

    def _view(self, side: str) -> LearnedView:
        mean = self._sums[side] / self.pairs
        variance = np.maximum(self._squares[side] - self.pairs * mean * mean, 0.0) / (self.pairs - 1)
        noise = np.clip(np.round(np.sqrt(variance) * NOISE_STEPS), 0, 255)
        return LearnedView(np.round(mean).astype(np.uint8), noise.astype(np.uint8))


@dataclass(frozen=True, eq=False)
class AdjustedBackground:
    """A learned surface in the light of one view: level (h, w); sigma, the spread around it [grey levels]; looseness
    (h, w), how many times noisier than the median each pixel is, 1 or more; moved_px: how far it was moved since it was
    learned, infinite where it no longer looks like that."""

    level: NDArray[np.float32]
    looseness: NDArray[np.float32]
    sigma: float
    moved_px: float = 0.0

    def at(self, window: Window, above: float = 0.0) -> NDArray[np.float32]:
        """Grey level of the empty surface in a window, raised by `above`, and by more where it is noisy."""
        level = self.level[window]
        return level + np.float32(above) * self.looseness[window] if above else level


def adjusted(learned: LearnedView, view: View, camera: Camera) -> AdjustedBackground:
    """The learned surface as this view shows it: in its light, and where it was moved to since by a push.

    What lies on it are outliers, as long as it covers less than about two fifths of the view; much less where a lamp
    was moved.
    """
    mean, looseness = _prepared(learned, camera, view.reduction)
    still = _in_light(mean, looseness, view)
    seen = still.level, view.smooth, view.inside, still.sigma
    if not has_moved(*seen):
        return still
    motion = motion_of(*seen)
    if motion is None:
        return replace(still, moved_px=np.inf)
    moved = motion.of(continued(mean, view.inside)), motion.of(looseness)
    return replace(_in_light(*moved, view), moved_px=motion.px * view.reduction)


def _in_light(mean: NDArray[np.float32], looseness: NDArray[np.float32], view: View) -> AdjustedBackground:
    """A surface (h, w) with the offset and the gain, one that changes evenly across it, that explain most of a view."""
    stride_px = grid_stride_px(mean.shape)
    grid = np.s_[::stride_px, ::stride_px]
    inside = view.inside[grid]
    grey, known = (picture[grid][inside].astype(np.float64) for picture in (view.smooth, mean))
    pictures = _terms(mean)
    terms = np.stack([each[grid][inside] for each in pictures], axis=1).astype(np.float64)
    light = refined(np.append(_light(known, grey), [0.0, 0.0]), terms, grey)
    level = np.sum([part * each for part, each in zip(light.astype(np.float32), pictures)], axis=0)
    return AdjustedBackground(level, looseness, spread(grey - terms @ light))


def _terms(mean: NDArray[np.float32]) -> list[NDArray[np.float32]]:
    """What the light on a surface (h, w) multiplies: an offset, a gain, and by how much that grows right and down."""
    height, width = mean.shape
    right, down = np.linspace(-1, 1, width, dtype=np.float32), np.linspace(-1, 1, height, dtype=np.float32)
    return [np.ones_like(mean), mean, mean * right, mean * down[:, None]]


def _light(known: Floats, grey: Floats) -> Floats:
    """Offset and gain (2,) that leave the least median residual, out of those that two samples each ask for."""
    draw = np.random.default_rng(0)  # seeded: the same image must give the same objects
    one, other = draw.integers(len(known), size=(2, _TRIALS))
    differ = np.abs(known[one] - known[other]) > _MIN_DIFFERENCE
    one, other = one[differ], other[differ]
    gain = np.append(1.0, (grey[one] - grey[other]) / (known[one] - known[other]))
    offset = np.append(np.median(grey - known), grey[one] - gain[1:] * known[one])
    check = draw.integers(len(known), size=_CHECKED)
    left = np.abs(grey[check] - offset[:, None] - gain[:, None] * known[check])
    best = np.median(left, axis=1).argmin()
    return np.array([offset[best], gain[best]])


@lru_cache(maxsize=8)
def _prepared(learned: LearnedView, camera: Camera, reduction: int) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Mean and looseness (h, w), reduced and smoothed as a view is."""
    mean = View.of(learned.mean, camera, reduction)
    noise = View.of(learned.noise, camera, reduction).smooth
    middle = float(np.median(noise[mean.inside])) if mean.inside.any() else 0.0
    return mean.smooth, np.maximum(noise / np.float32(max(middle, 1.0)), np.float32(1.0))
