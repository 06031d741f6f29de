"""Whether a position is known well enough to reach for the object."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from stereo_pick.core.doubts.more_of_it import as_unsure_as_whole
from stereo_pick.core.matches.left_over import Unread
from stereo_pick.core.places.position import BlobPair, Located, Row, depth_m
from stereo_pick.core.rig import StereoRig
from stereo_pick.core.tables.lying_flat import WarpedViews


def by_certainty(
    rows: Sequence[Row], refused: Sequence[Unread], rig: StereoRig, most: float, warped: WarpedViews | None
) -> tuple[list[Row], list[Unread]]:
    """Those known well enough, and the others; most: one sigma of an object's depth, as a part of its width.

    refused: what may be more of the objects, unless it lies on the table; so may be those that are not known well
    enough themselves.
    """
    sure, unsure = _by_sigma(rows, rig, most)
    still, less = _by_sigma(as_unsure_as_whole(sure, unsure, [*refused, *_uncertain(unsure)], rig, warped), rig, most)
    return still, _uncertain(unsure + less)


def _by_sigma(rows: Sequence[Row], rig: StereoRig, most: float) -> tuple[list[Row], list[Row]]:
    sure = [row for row in rows if sigma_of_width(*row, rig) <= most]
    return sure, [row for row in rows if row not in sure]


def _uncertain(rows: Sequence[Row]) -> list[Unread]:
    return [Unread("uncertain", *blobs) for blobs, _ in rows]


def sigma_of_width(blobs: BlobPair, where: Located, rig: StereoRig) -> float:
    """One sigma of an object's depth, as a part of its middle size, or of the width of its outline.

    With Z = f B / d, an error of both image points by sigma moves the depth by √2 sigma Z² / (f B); what moves them
    together adds to that.
    """
    away_m = depth_m(where, rig)
    width_m = float(np.median(where.fit.size_m)) if where.fit else blobs[0].rectangle[1] * away_m / rig.focal_px
    apart_m = float(np.sqrt(2)) * where.sigma_px * away_m**2 / (rig.focal_px * rig.baseline_m)
    return float(np.hypot(apart_m, np.sqrt(where.covariance[2, 2]))) / width_m
