"""How much of a solid's predicted silhouette the images show as edges, of whichever sign."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from stereo_pick.core.arrays import Bools, Floats, Image, Ints
from stereo_pick.core.camera import Camera
from stereo_pick.core.edges.arcs import EXACT
from stereo_pick.core.noise import noise_dn
from stereo_pick.core.objects.edge_model import BLURS_PX, OFFSETS_PX, Edges, find_edges, nearest_blur_px
from stereo_pick.core.objects.edge_places import places_px
from stereo_pick.core.objects.exposure import CLIPPED
from stereo_pick.core.objects.outline import upper_median
from stereo_pick.core.sampling import places_along, remapped

USUAL_BLUR_PX = 0.85  # of a lens, with the rectification
_SURELY_OTHER = 1.2  # factor: the blurs that sharp views show differ by as much
_BLUR_PX = 0.8
_BLUR = cv2.getGaussianKernel(7, _BLUR_PX).ravel()
_SMOOTH = np.convolve(_BLUR, [0.25, 0.5, 0.25])
_SLOPE = np.convolve(_BLUR, [-0.5, 0.0, 0.5])
NOISE_OF_PIXELS = 1 / float(np.linalg.norm(_SLOPE) * np.linalg.norm(_SMOOTH))  # by that of their gradient
CLEAR = 5.0  # sigmas of the gradient from which it is an edge
_STEP_PX = 0.5
_SAMPLED = 4  # every so many pixels for the noise
_NOISY = 4.0  # grey levels a pixel, from which weak edges drown that a blur saves; with less it costs others
_NO_GRAIN = 0.4  # of that differs from pixel to pixel, also after rectification; of the grain of a table less does
# One sigma of the place of an edge beside what is clipped: so far outside of it the half-way level to a table half as
# bright as white is reached, where half as much light again as white stands for came from the part.
_CLIPPED_PX = 0.65 * USUAL_BLUR_PX
_BESIDE = np.abs(OFFSETS_PX) <= 2.0  # the blur reaches no farther: what is white beyond, as a high light, moves nothing
_NEIGHBOURS = -1, 0, 1  # on a line, that are looked at together in noise
_LEAST_NOISE = 0.1  # grey levels a pixel: rounding alone


@dataclass(frozen=True, eq=False)
class EdgeMap:
    """A rectified view (H, W), one sigma of its gradient [grey levels/px] where there are no edges, and the blur of
    its lens [px, one sigma]. is_exact: whether edges are placed as exactly as can be, which is for known ones alone.
    is_noisy: whether neighbours on a line have to be looked at together, since noise hides the edge of each.
    fading_limbs: whether limbs as bright as what is behind them count as edges.

    The gradient is made where it is asked for: that takes a fraction of the time that the whole view takes.
    """

    image: Image
    noise: float
    camera: Camera
    blur_px: float
    is_exact: bool = False
    is_noisy: bool = False
    fading_limbs: bool = False

    @property
    def light(self) -> float:
        """How much light moves its edges, as a part of what is usual."""
        return EXACT if self.is_exact else 1.0

    def edges(self, profiles: Floats, part: Ints | None = None) -> Edges:
        """The edges in profiles, as of `find_edges`."""
        edges = find_edges(profiles, self.modelled_blur_px, part)
        if not self.is_exact:
            return edges
        place_px, spread_px = places_px(profiles, self.modelled_blur_px)
        spread_px = np.hypot(spread_px, _CLIPPED_PX * (profiles[:, _BESIDE] >= CLIPPED).any(axis=1))
        return replace(edges, place_px=place_px, spread_px=spread_px)

    @property
    def modelled_blur_px(self) -> float:
        """The blur to look for edges with: the usual one, as far as what was measured is no different."""
        usual = abs(np.log(max(self.blur_px, BLURS_PX[0]) / USUAL_BLUR_PX)) < np.log(_SURELY_OTHER)
        return USUAL_BLUR_PX if usual else nearest_blur_px(self.blur_px)

    @staticmethod
    def of(image: Image, camera: Camera, blur_px: float = USUAL_BLUR_PX) -> EdgeMap:
        """Look at a view (H, W), through a further blur if it is full of noise."""
        noise = _noise(image)
        if noise * NOISE_OF_PIXELS < _NOISY or noise_dn(image.astype(np.float32)) < _NO_GRAIN * _NOISY:
            return EdgeMap(image, noise, camera, blur_px)
        blurred = np.asarray(cv2.sepFilter2D(image, -1, _BLUR, _BLUR), np.uint8)
        return EdgeMap(blurred, _noise(blurred), camera, float(np.hypot(blur_px, _BLUR_PX)), is_noisy=True)

    def together(self, profiles: Floats, points: int) -> Floats:
        """Profiles (N, M) across closed lines of so many points each, as they are, or each as the mean with its
        neighbours."""
        if not self.is_noisy:
            return profiles
        lines = profiles.reshape(-1, points, profiles.shape[1])
        mean: Floats = np.mean([np.roll(lines, by, axis=1) for by in _NEIGHBOURS], axis=0)
        return mean.reshape(profiles.shape)

    @property
    def noise_together(self) -> float:
        """The noise of what is looked at together, as that of the gradient."""
        return self.noise / len(_NEIGHBOURS) ** 0.5 if self.is_noisy else self.noise

    def shows(self, points_px: Floats, normals: Floats, reach_px: float, asked: Bools | None = None) -> Bools:
        """Whether there is an edge across these normals (..., N, 2), so near to each point (..., N, 2) of closed lines.

        asked: (..., N), of which points that is asked; of all, unless given. False for the others.
        """
        lines = points_px.shape[:-1]
        points_px, normals = points_px.reshape(-1, 2), normals.reshape(-1, 2)
        asked = np.ones(len(points_px), bool) if asked is None else asked.ravel()
        shown = asked.copy()
        beside = np.flatnonzero(np.convolve(asked, np.ones(3), "same"))  # an edge goes on beside the point
        if len(beside):
            low, slopes = self._slopes_around(points_px[beside], reach_px)
            reach = np.arange(-reach_px, reach_px + _STEP_PX / 2, _STEP_PX)
            across = np.zeros((len(points_px), len(reach)), np.float32)
            across[beside] = _across(slopes, points_px[beside] - low, normals[beside], reach)
            along = cv2.blur(across, (1, 3), borderType=cv2.BORDER_REPLICATE)[asked]
            shown[asked] = np.asarray(np.abs(along).max(axis=1), np.float64) > CLEAR * self.noise
        return shown.reshape(lines)

    def slopes(self, points_px: Floats) -> Floats:
        """How steep grey levels are along x and y (N, M, 2) [grey levels/px] at points (N, M, 2) near each other."""
        low, slopes = self._slopes_around(points_px.reshape(-1, 2), 0.0)
        along_axes = [remapped(slope, points_px - low, cv2.BORDER_CONSTANT) for slope in slopes]
        return np.stack(along_axes, axis=-1).astype(np.float64)

    def _slopes_around(self, points_px: Floats, reach_px: float) -> tuple[Ints, list[NDArray[Any]]]:
        """The first pixel (2,) of the part of the view around points (N, 2), and its slopes along x and y (h, w)."""
        height, width = self.image.shape
        margin_px = reach_px + 1 + len(_SMOOTH) // 2
        low = np.clip(np.floor(points_px.min(axis=0) - margin_px).astype(np.int64), 0, (width - 1, height - 1))
        high = np.maximum(np.ceil(points_px.max(axis=0) + margin_px).astype(np.int64), low) + 1
        around = self.image[low[1] : high[1], low[0] : high[0]]
        return low, [cv2.sepFilter2D(around, cv2.CV_32F, *way) for way in ((_SLOPE, _SMOOTH), (_SMOOTH, _SLOPE))]


def _noise(image: Image) -> float:
    along_rows = cv2.sepFilter2D(image, cv2.CV_32F, _SLOPE, _SMOOTH)[::_SAMPLED, ::_SAMPLED]
    return max(1.4826 * upper_median(np.abs(along_rows).ravel()), _LEAST_NOISE)


def _across(
    slopes: Sequence[NDArray[Any]], points_px: Floats, normals: Floats, reach_px: Floats
) -> NDArray[np.float32]:
    """How steep (N, M) grey levels of known slopes along x and y (h, w) are across normals (N, 2), so far (M,) along
    them."""
    points, across, reach = (each.astype(np.float32) for each in (points_px, normals, reach_px))
    places = places_along(points, across, reach)
    x, y = (remapped(slope, places, cv2.BORDER_CONSTANT) for slope in slopes)
    return np.asarray(x * across[:, :1] + y * across[:, 1:], np.float32)
