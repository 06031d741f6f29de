"""What may be the table, from what falls on it: the edges of shadows, however soft, and stains lie on it.

Most windows of a view that show anything show objects, and these are above the table: the plane looked for is one that
many windows agree on and hardly any lies below. What mirrors in a table lies below it, and the tops of objects are a
plane as well: something must stand on a plane before it is believed.
"""

from __future__ import annotations

from collections.abc import Iterator

import cv2
import numpy as np

from stereo_pick.core.arrays import Bools, Floats
from stereo_pick.core.frames import RectifiedPair
from stereo_pick.core.noise import noise_dn
from stereo_pick.core.objects import Blobs
from stereo_pick.core.rig import StereoRig
from stereo_pick.core.shapes.sight import normalized
from stereo_pick.core.shapes.table import Table
from stereo_pick.core.windows.plane_alignment import aligned
from stereo_pick.core.windows.table_windows import (
    Windows,
    clear_of_objects,
    matches,
    on_grid,
    reduced,
    reduction,
    uneven,
    valid,
)
from stereo_pick.core.windows.texture import predicted_sigma_px
from stereo_pick.core.windows.window import Grey
from stereo_pick.core.windows.window_planes import agree_on, as_table, lie_below, planes_through, refitted

_WIDE_PX, _HIGH_PX, _STRIDE_PX = GRID = 17, 9, 5  # windows, in pixels of the reduced view, as all pixels here
_AS_SQUARE_PX = 13
_PLACED_PX = 0.15  # sigma that the edges in a window promise
_TRIPLES = 2000
_APART_PX = 20
_LEAST = 12  # windows
_TRIED = 2
_STEEP = np.sin(np.deg2rad(25))  # of the least angle at which a table is looked at
_MIRRORED_PX = 0.3  # what light and mirrors do to marks is no noise


def shaded_tables(pair: RectifiedPair, disparities_px: tuple[float, float], objects: Blobs | None) -> list[Table]:
    """The planes (rectified left frame) that the table may be, the likeliest first.

    objects: beside which shadows are looked for; None where all that shows edges is taken. disparities_px: the least
    and the greatest of the view.
    """
    scale = reduction(pair.left)
    left, right = uneven(pair.left, pair.rig.left, scale), uneven(pair.right, pair.rig.right, scale)
    windows = _seen(pair, (left, right), objects, scale, (scale * disparities_px[0], scale * disparities_px[1]))
    found = []
    for plane, agree in _planes(windows, pair.rig, scale):
        better = aligned(left, right, plane, windows.those(agree), GRID)
        if better is not None:
            found.append(better.table(windows.rows.mean(axis=0), pair.rig, scale, _MIRRORED_PX))
    return [each for each in found if each is not None]


def _seen(
    pair: RectifiedPair, views: tuple[Grey, Grey], objects: Blobs | None, scale: float, reach_px: tuple[float, float]
) -> Windows:
    """The windows that show edges, found in the other view; clear of the objects in both."""
    left, right = views
    usable = shows_edges(pair, left, scale)
    if objects is not None:
        usable &= clear_of_objects(left, objects.left, scale, _WIDE_PX, _HIGH_PX)
    windows = matches(left, right, on_grid(usable, *GRID), (_WIDE_PX, _HIGH_PX), reach_px)
    if objects is None:
        return windows
    clear = clear_of_objects(right, objects.right, scale, _WIDE_PX, _HIGH_PX)
    columns = np.round(windows.centre_px[:, 0] - windows.disparity_px).astype(int)
    return windows.those(clear[windows.centre_px[:, 1].astype(int), np.clip(columns, 0, clear.shape[1] - 1)])


def shows_edges(pair: RectifiedPair, left: Grey, scale: float) -> Bools:
    """Which pixels (h, w) of the left view, `uneven` and of that scale, are at the middle of windows that show edges,
    all of which the camera sees."""
    around = np.ones((_HIGH_PX + 2, _WIDE_PX + 2), np.uint8)
    seen = cv2.erode(valid(pair.rig.left, left).astype(np.uint8), around) > 0
    noise = noise_dn(reduced(pair.left, scale))
    return np.asarray(seen & (predicted_sigma_px(left, noise, _AS_SQUARE_PX, "zncc") < _PLACED_PX))


def _planes(windows: Windows, rig: StereoRig, scale: float) -> Iterator[tuple[Floats, Bools]]:
    """The planes (3,) that windows agree on, and which (N,) these are; by sample consensus (Fischler and Bolles 1981),
    what lies below a plane counted against it."""
    planes = _guesses(windows, rig, scale)
    agree, below = agree_on(planes, windows), lie_below(planes, windows).sum(axis=1)
    taken = np.zeros(len(windows.disparity_px), np.bool_)
    for _ in range(_TRIED if len(planes) else 0):
        votes = (agree & ~taken).sum(axis=1) - below
        plane, on_it = refitted(planes[votes.argmax()], windows)
        if (on_it & ~taken).sum() < _LEAST:
            return
        taken |= on_it
        yield plane, on_it


def _guesses(windows: Windows, rig: StereoRig, scale: float) -> Floats:
    """The planes (P, 3) through three windows each that may be seen from above."""
    if len(windows.disparity_px) < _LEAST:
        return np.zeros((0, 3))
    planes = planes_through(windows, _TRIPLES, _APART_PX)
    middle_px = windows.centre_px.mean(axis=0)
    ray = np.append(normalized(middle_px / scale, rig.left), 1.0)
    tables = [as_table(plane, rig, scale, middle_px, 1.0) for plane in planes]
    least = _STEEP * np.linalg.norm(ray)
    return planes[[table is not None and -table.normal @ ray > least for table in tables]]
