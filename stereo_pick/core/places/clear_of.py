"""The outlines of an object without what is another's: that of solids that are known to be there."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from stereo_pick.core.arrays import Bools
from stereo_pick.core.edges.hypotheses import Images
from stereo_pick.core.objects import Blob
from stereo_pick.core.objects.blob import CUT
from stereo_pick.core.places.position import BlobPair
from stereo_pick.core.shapes import SolidFit
from stereo_pick.core.shapes.sight import normalized

_LEAST = 9  # points of an outline


def clear_of(blobs: BlobPair, images: Images, fit: SolidFit | None = None) -> BlobPair:
    """The same, cut off where solids that are known to be there begin; where hardly anything is left, the same.

    fit: what the outlines are of, if that is known: only what is nearer hides it. Where it is not, an object before a
    known one loses some of its own outline, too.
    """
    occluders = images.occluders
    if occluders is None:
        return blobs
    depth_m = np.inf if fit is None else float(fit.centre_m[2])
    cameras = images.rig.left, images.rig.right
    covered = [
        occluders.cover(normalized(blob.contour_px, camera), i, depth_m)
        for i, (blob, camera) in enumerate(zip(blobs, cameras))
    ]
    left, right = (_cut_off(blob, each) for blob, each in zip(blobs, covered))
    return left, right


def _cut_off(blob: Blob, covered: Bools) -> Blob:
    """A blob without these points (N,) of its contour, across a cut."""
    kept = np.flatnonzero(~covered)
    if len(kept) == len(covered) or len(kept) < _LEAST or not len(blob.sharpness):
        return blob
    contour, sharpness = [], []
    for i, after in zip(kept, np.roll(kept, -1)):
        contour.append(blob.contour_px[i : i + 1])
        sharpness.append(blob.sharpness[i : i + 1])
        if after != (i + 1) % len(covered):
            gap = blob.contour_px[after] - blob.contour_px[i]
            steps = max(int(np.linalg.norm(gap)), 2)
            contour.append(blob.contour_px[i] + np.arange(1, steps)[:, None] / steps * gap)
            sharpness.append(np.full(steps - 1, CUT))
    return replace(blob, contour_px=np.concatenate(contour), sharpness=np.concatenate(sharpness))
