"""Where a tube ends that touches something there: its outline was cut, but between the two its side is seen to end.

That is where the rim, as far as it faces a camera, is an edge like those along the side, and both views show the same
rim. What hides the end, or lies before it, has its edge at another place in one of them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from stereo_pick.core.arrays import Bools, Floats
from stereo_pick.core.camera import Camera
from stereo_pick.core.edges.edge_map import CLEAR, EdgeMap
from stereo_pick.core.objects.edge_model import vertex
from stereo_pick.core.shapes.fitting import Pair
from stereo_pick.core.shapes.outline import Outline
from stereo_pick.core.shapes.sight import seen_px
from stereo_pick.core.shapes.solids import Solids

_POINTS = 16  # of a rim that are looked at
_ARC = np.linspace(-0.7, 0.7, _POINTS)  # of what is seen of it, both ways from what faces the camera
_REACH = 1.0  # radii, both ways from where the outlines let it end: about as far as a cut can be off
_STEP_PX = 0.5
_NEAR = 3  # steps, by which the rim may lie off in either view
_SHOWN = 0.9  # of a rim
_LEAST_LOST = 3  # points of an outline


@dataclass(frozen=True, eq=False)
class _Rims:
    """L rims of a tube, each a step longer than the one before, in one view. points_px, normals: (L, N, 2), the normals
    unit, away from the tube; slope: (L, N), how steep it is across them, as across the edges of its side, in sigmas."""

    points_px: Floats
    normals: Floats
    slope: Floats

    @property
    def are_shown(self) -> Bools:
        """Which (L,) of them are edges."""
        return np.asarray((self.slope > CLEAR).mean(axis=1) >= _SHOWN)

    def steepest_near(self, at: int) -> tuple[Floats, Floats]:
        """Points and normals (N, 2) of the one next to a rim that is steepest, between the steps."""
        mean = self.slope.mean(axis=1)
        first = max(at - _NEAR, 1)
        best = first + int(mean[first : at + _NEAR + 1].argmax())
        best = min(best, len(mean) - 2)
        part = float(vertex(*(-mean[i : i + 1] for i in (best - 1, best, best + 1)))[0])
        step_px = self.points_px[best + 1] - self.points_px[best]
        return self.points_px[best] + part * step_px, self.normals[best]


def with_touching_ends(outlines: Pair, tube: Solids, views: Sequence[EdgeMap], eyes_m: Floats) -> Pair:
    """The outlines, with points on a rim that both views show where they were cut off; as they are where none shows.

    tube: S = 1, as the rest of the outlines tells; eyes_m: (2, 3), rectified left frame.
    """
    left, right = outlines
    for end in (-1.0, 1.0):
        lost = [_lost(outline, tube, end, view.camera) for outline, view in zip((left, right), views)]
        if min(int(each.sum()) for each in lost) < _LEAST_LOST:
            continue
        rims = [_rims(tube, end, view, eye, outline) for view, eye, outline in zip(views, eyes_m, (left, right))]
        shown = rims[0].are_shown & rims[1].are_shown
        if shown.any():
            steep = np.minimum(*(each.slope.mean(axis=1) for each in rims))
            best = int(np.where(shown, steep, 0.0).argmax())
            left, right = (_mended(*each, best) for each in zip((left, right), lost, rims))
    return left, right


def _lost(outline: Outline, tube: Solids, end: float, camera: Camera) -> Bools:
    """Which points (N,) of an outline that tell nothing are nearer to this end than to the other."""
    ends_m = tube.centre_m[0] + np.outer([end, -end], tube.rotation[0, :, 2]) * tube.half_m[0, 1]
    this, other = seen_px(ends_m, camera)
    nearer = np.linalg.norm(outline.points_px - this, axis=1) < np.linalg.norm(outline.points_px - other, axis=1)
    return np.asarray((outline.weight == 0) & nearer)


def _rims(tube: Solids, end: float, view: EdgeMap, eye_m: Floats, outline: Outline) -> _Rims:
    """The rims at which the tube may end, shorter or longer."""
    radius_m, half_m = tube.half_m[0]
    step_m = _STEP_PX * float(tube.centre_m[0, 2]) / view.camera.P[0, 0]
    heights_m = end * (half_m + np.arange(-_REACH * radius_m, _REACH * radius_m, step_m))
    x, y, _ = (eye_m - tube.centre_m[0]) @ tube.rotation[0]
    angle = np.arctan2(y, x) + np.arccos(min(radius_m / np.hypot(x, y), 1.0)) * _ARC
    own = np.empty((len(heights_m), _POINTS, 3))
    own[..., 0], own[..., 1] = radius_m * np.cos(angle), radius_m * np.sin(angle)
    own[..., 2] = heights_m[:, None]
    points_px = seen_px(own @ tube.rotation[0].T + tube.centre_m[0], view.camera)
    normals = _outwards(points_px)
    slope = (view.slopes(points_px) * normals).sum(axis=-1) * _sign(outline, view) / view.noise
    return _Rims(points_px, normals, slope)


def _outwards(points_px: Floats) -> Floats:
    """Unit normals (L, N, 2) of lines of points (L, N, 2), towards those after them."""
    ahead, away = np.gradient(points_px, axis=1), np.gradient(points_px, axis=0)
    across = np.stack([ahead[..., 1], -ahead[..., 0]], axis=-1)
    across *= np.sign((across * away).sum(axis=-1, keepdims=True))
    return np.asarray(across / np.linalg.norm(across, axis=-1, keepdims=True))


def _sign(outline: Outline, view: EdgeMap) -> float:
    """1 if an outline's own edges are brighter outside, on the whole, and -1 if they are darker."""
    own = outline.weight > 0
    slopes = view.slopes(outline.points_px[own][None])[0]
    return float(np.sign((slopes * outline.normals[own]).sum()))


def _mended(outline: Outline, lost: Bools, rims: _Rims, best: int) -> Outline:
    """The outline with points of that rim instead of those that are lost."""
    rim_px, across = rims.steepest_near(best)
    at = np.linspace(0, _POINTS - 1, int(lost.sum())).round().astype(np.int64)
    points_px, normals, weight = outline.points_px.copy(), outline.normals.copy(), outline.weight.copy()
    points_px[lost], normals[lost], weight[lost] = rim_px[at], across[at], 1.0
    return Outline(points_px, normals, weight, outline.corner)
