"""A solid brought to lie on the edges next to its predicted silhouette (as in Harris and Stennett 1990)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np

from stereo_pick.core.arrays import Floats, Image
from stereo_pick.core.objects.edge_model import OFFSETS_PX, Edges, find_edges
from stereo_pick.core.rig import StereoRig
from stereo_pick.core.shapes.outline import POINTS, Outline
from stereo_pick.core.shapes.predicted import along_polygon, silhouettes
from stereo_pick.core.shapes.refinement import Fitted, fitted, refine
from stereo_pick.core.shapes.sight import Sight
from stereo_pick.core.shapes.solids import Solids
from stereo_pick.core.shapes.table import Table

_ROUNDS = 4
_SHIFTS_PX = (0.0, -1.2, 1.2)
_MIDDLE_PX = float(OFFSETS_PX.mean())
_BLUR_PX = 0.85
_MIN_STEP = 4.0  # noise sigmas
_MIN_SHARPNESS = 0.25
_ON_EDGE_PX = 0.6


@dataclass(frozen=True, eq=False)
class Locked:
    """fit: the solid (S = 1) and its residuals on the edges; shown: (2,), the share of its silhouette in each view
    that lies on an edge."""

    fit: Fitted
    shown: Floats


def lock(
    solid: Solids, images: Sequence[Image], noises: Sequence[float], rig: StereoRig, table: Table | None = None
) -> Locked:
    """Refine one solid on the edges of the two rectified views that are near its silhouette, of either sign.

    images: (H, W) each; noises: one sigma of their pixels [grey levels].
    """
    eyes_m = np.array([[0.0, 0.0, 0.0], [rig.baseline_m, 0.0, 0.0]])
    cameras = (rig.left, rig.right)
    for round_ in range(_ROUNDS + 1):
        polygons = silhouettes(solid, eyes_m)[0]
        outlines, offsets = [], []
        for image, noise, camera, polygon in zip(images, noises, cameras, polygons):
            points, normals = (part[0] for part in along_polygon(polygon[None], POINTS))
            pixels = points * camera.P[0, 0] + camera.P[:2, 2]
            offset, weight = _edges_near(image, pixels, normals, noise, _SHIFTS_PX if round_ == 0 else (0.0,))
            outlines.append(Outline(pixels - offset[:, None] * normals, normals, weight, np.zeros(len(weight))))
            offsets.append(np.where(weight > 0, np.abs(offset), np.inf))
        sight = Sight.of([(outlines[0], outlines[1])], rig, table)
        now = fitted(sight, solid)
        if round_ == _ROUNDS or min(outline.weight.sum() for outline in outlines) < 8:
            break
        solid = refine(sight, now, rounds=3).solids
    return Locked(now, np.array([float((side < _ON_EDGE_PX).mean()) for side in offsets]))


def _edges_near(
    image: Image, points_px: Floats, normals: Floats, noise: float, shifts_px: Sequence[float]
) -> tuple[Floats, Floats]:
    """Offset (N,) [px, inwards] of the clearest edge near each point, and the trust in it (N,)."""
    best = np.zeros((3, len(points_px)))
    for shift in shifts_px:
        inwards = OFFSETS_PX - _MIDDLE_PX + shift
        at = (points_px[:, None] - inwards[:, None] * normals[:, None]).astype(np.float32)
        profiles = cv2.remap(image, at[..., 0], at[..., 1], cv2.INTER_LINEAR).astype(np.float64)
        edges = find_edges(profiles, _BLUR_PX)
        offset = edges.place_px - _MIDDLE_PX + shift
        best = np.where(
            np.abs(edges.step) * (1 + 0 * offset) > best[2], [offset, _trust(edges, noise), np.abs(edges.step)], best
        )
    return best[0], best[1]


def _trust(edges: Edges, noise: float) -> Floats:
    sharp = np.abs(edges.sharpness)
    clear = (np.abs(edges.step) > _MIN_STEP * noise) & (sharp > _MIN_SHARPNESS)
    return np.asarray(np.where(clear, np.minimum(1.5 * sharp, 1.0), 0.0))
