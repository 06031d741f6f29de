"""Shadows: exact polygons on the table, one for each point of a lamp and each part; rays between parts."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from rendering.intervals import dot
from rendering.lamps import Lamp
from rendering.solids import Solid
from stereo_pick.core.arrays import Floats

_FINEST_M = 0.0004
_MOST_CELLS = 1600
_FARTHEST_M = 1.2  # from the table's origin
_SHIFT = 4  # binary places of a polygon's corners
_SKY_STEP = 8  # cells of the fine map to one of the map of the sky


@dataclass(frozen=True, eq=False)
class ShadowMap:
    """How much of each lamp and of the sky the points of the table see, on a grid.

    low_m: (2,), the point of cell (0, 0); lamps: for each a (H, W) map; sky: (h, w), coarser.
    """

    low_m: Floats
    cell_m: float
    lamps: tuple[NDArray[np.float32], ...]
    sky: NDArray[np.float32]

    @staticmethod
    def of(solids: Sequence[Solid], lamps: Sequence[Lamp]) -> ShadowMap:
        """The maps of these parts under these lamps."""
        outlines = [[_shadows_m(solid, lamp) for solid in solids] for lamp in lamps]
        reach = np.concatenate([solid.corners_m()[:, :2] for solid in solids])
        reach = np.concatenate([reach - 0.1, reach + 0.1, *(o.reshape(-1, 2) for lamp in outlines for o in lamp)])
        reach = np.clip(reach, -_FARTHEST_M, _FARTHEST_M)
        low, high = reach.min(axis=0) - 0.005, reach.max(axis=0) + 0.005
        cell = max(_FINEST_M, float((high - low).max()) / _MOST_CELLS)
        columns, rows = np.ceil((high - low) / cell).astype(int) + 1
        maps = tuple(_visible((rows, columns), [(o - low) / cell for o in lamp]) for lamp in outlines)
        y, x = np.mgrid[: rows + _SKY_STEP : _SKY_STEP, : columns + _SKY_STEP : _SKY_STEP] * cell
        points = np.stack([x + low[0], y + low[1], np.zeros(x.shape)], axis=-1).reshape(-1, 3)
        return ShadowMap(low, cell, maps, open_sky(points, solids).reshape(x.shape).astype(np.float32))

    def at(self, points: Floats) -> tuple[Floats, list[Floats]]:
        """How much of the sky (N,), and of each lamp (N,), points (N, 3) of the table see."""
        cells = ((points[:, :2] - self.low_m) / self.cell_m).astype(np.float32)
        lit = [_sampled(each, cells) for each in self.lamps]
        return _sampled(self.sky, cells / _SKY_STEP), lit


def visible_from(lamp: Lamp, points: Floats, receiver: Solid, others: Sequence[Solid]) -> Floats:
    """How much of a lamp (N,) points (N, 3) of one part see past others."""
    casters = [other for other in others if _may_shade(lamp, receiver, other)]
    lit = np.ones(len(points))
    if not casters:
        return lit
    samples = lamp.points_m()[::2] if lamp.radius_m else lamp.points_m()
    for sample in samples:
        way = sample - points
        dark = np.zeros(len(points), bool)
        for caster in casters:
            dark |= caster.blocks(points, way)
        lit -= dark / len(samples)
    return lit


def open_sky(points: Floats, solids: Sequence[Solid]) -> Floats:
    """How much of an even sky (N,) points (N, 3) of the table see past parts, each taken for a pile of balls."""
    hidden = np.zeros(len(points))
    for solid in solids:
        x, y, z = solid.extent_m
        radius = (x * y * z) ** (1 / 3) / 2
        count = max(1, round(z / (2 * radius)))
        for level in range(count):
            centre = solid.centre_m + (0, 0, z * ((level + 0.5) / count - 0.5))
            way = centre - points
            distance2 = np.maximum(dot(way, way), radius**2)
            hidden += way[:, 2] / np.sqrt(distance2) * radius**2 / distance2
    return np.clip(1 - hidden, 0.15, 1)


def _shadows_m(solid: Solid, lamp: Lamp) -> Floats:
    """Where the lamp's points project the part's points to on the table: (samples, N, 2)."""
    hull = solid.hull_m()
    samples = lamp.points_m()[:, None]
    share = hull[:, 2] / (samples[..., 2] - hull[:, 2])
    return np.asarray(hull[:, :2] + (hull[:, :2] - samples[..., :2]) * share[..., None])


def _visible(shape: tuple[int, int], shadows_cells: Sequence[Floats]) -> NDArray[np.float32]:
    count = len(shadows_cells[0])
    hidden = np.zeros(shape, np.float32)
    for sample in range(count):
        mask = np.zeros(shape, np.uint8)
        for shadow in shadows_cells:
            corners = np.clip(shadow[sample] * 2**_SHIFT, -(2**26), 2**26).astype(np.int32)
            cv2.fillConvexPoly(mask, cv2.convexHull(corners.reshape(-1, 1, 2)), 1, cv2.LINE_8, _SHIFT)
        hidden += mask
    return 1 - hidden / count


def _sampled(grid: NDArray[np.float32], cells: NDArray[np.float32]) -> Floats:
    """Bilinear; beyond the grid its border goes on."""
    last = np.array(grid.shape[::-1], np.float32) - 1
    where = np.clip(cells, 0, last)
    count = 4096  # remap takes no image wider than 32767
    padded = np.zeros((-len(where) % count, 2), np.float32)
    table = np.concatenate([where, padded]).reshape(-1, count, 2)
    values = cv2.remap(grid, table, None, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
    return values.reshape(-1)[: len(where)].astype(np.float64)


def _may_shade(lamp: Lamp, receiver: Solid, caster: Solid) -> bool:
    """Whether the caster's ball comes near the way from the receiver's ball to the lamp."""
    to_lamp = lamp.centre_m - receiver.centre_m
    to_caster = caster.centre_m - receiver.centre_m
    share = float(np.clip(to_caster @ to_lamp / (to_lamp @ to_lamp), 0, 1))
    apart = float(np.linalg.norm(to_caster - share * to_lamp))
    return apart < receiver.radius_m + caster.radius_m + lamp.radius_m * share
