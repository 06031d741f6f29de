"""Parts and their images in a table that is a mirror: polished metal, glass, lacquer.

Both together look like one solid of twice the height, which a seam divides where the part stands; a ball, or a lying
cylinder, has another one below it, which it touches.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from stereo_pick.core.arrays import Floats
from stereo_pick.core.edges.growing import stretched_by, ways_along
from stereo_pick.core.edges.hypotheses import Images
from stereo_pick.core.edges.shortening import shown_ends
from stereo_pick.core.shapes.common_normal import ANGLE
from stereo_pick.core.shapes.kinds import SPHERE
from stereo_pick.core.shapes.sight import seen_px
from stereo_pick.core.shapes.solid_fit import SolidFit

_SEAM = 0.75  # of it that shows, in both views: by chance one in ten points lies on an edge
_CUTS = np.array([0.3, 0.5, 0.7])  # of the height: what has a pattern shows edges anywhere
_HALF = 1
_CLEAR_PX = 8.0  # of the edge at its end: as far as blur and the search for edges reach, both ways
_BEFORE = 0.5  # of their distance, along the line of sight: cameras look down at the table by 30 degrees or more
_ALIKE = 0.1  # of its size, by which an image may differ from what is mirrored, and be off


def mirrored_m(images: Images, fits: Sequence[SolidFit], up: Floats | None) -> Floats:
    """How far (N, 3) [m] the centre of each solid would be off, were half of it, or all, the image of a part; up: unit
    normal (3,) of the table, if that is known."""
    return np.array([_as_double(images, fit, up) + _as_image(fit, fits, up) for fit in fits]).reshape(-1, 3)


def _as_double(images: Images, fit: SolidFit, up: Floats | None) -> Floats:
    """From the middle of a solid to that of the half that a seam divides from the other, if one does."""
    if fit.kind == SPHERE.name:
        return np.zeros(3)
    solid = fit.solid
    for axis, sign in ways_along(solid, None):
        towards = sign * solid.rotation[0, :, axis]
        if up is not None and float(towards @ up) > -np.cos(ANGLE):
            continue
        length_m = 2 * float(solid.half_m[0, solid.kind.axes[axis]])
        if not _tells_apart(images, fit, towards * length_m / 2):
            continue
        shorter = stretched_by(solid, [(axis, sign)], -length_m * _CUTS)
        views = enumerate(images.maps)
        shown = np.min([shown_ends(shorter, solid, images.eyes_m, view, i) for i, view in views], axis=0)
        if shown[_HALF] > _SEAM and np.delete(shown, _HALF).max() < _SEAM:
            return np.asarray(towards * length_m / 4)
    return np.zeros(3)


def _tells_apart(images: Images, fit: SolidFit, half_m: Floats) -> bool:
    """Whether both views show the middle of a solid clear of its end, half of it (3,) [m] away."""
    ends_m = np.array([fit.centre_m, fit.centre_m + half_m])
    sides = (images.rig.left, images.rig.right)
    return all(float(np.linalg.norm(np.diff(seen_px(ends_m, camera), axis=0))) > _CLEAR_PX for camera in sides)


def _as_image(fit: SolidFit, fits: Sequence[SolidFit], up: Floats | None) -> Floats:
    """From the middle of a solid to that of another, alike, which lies on it as no part does, but on its image."""
    for other in fits:
        if other is fit or other.kind != fit.kind:
            continue
        above_m = other.centre_m - fit.centre_m
        apart_m, size_m = float(np.linalg.norm(above_m)), float(fit.size_m.mean())
        ahead = above_m / max(apart_m, 1e-9)
        touch_m = fit.reach_m(ahead) + other.reach_m(-ahead)
        is_above = float(ahead @ up) > np.cos(ANGLE) if up is not None else -float(ahead[2]) > _BEFORE
        is_alike = np.abs(np.sort(fit.size_m) - np.sort(other.size_m)).max() < _ALIKE * size_m
        if is_above and is_alike and abs(apart_m - touch_m) < _ALIKE * size_m:
            return np.asarray(above_m)
    return np.zeros(3)
