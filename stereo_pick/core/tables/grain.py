"""The table from its own grain: wood, cloth, concrete or dirt show all over the view how far away it is.

Windows of the left view are looked for along their rows in the right one; where most windows of the view agree on one
plane, that is the table.
"""

from __future__ import annotations

from stereo_pick.core.arrays import Bools, Floats, Ints
from stereo_pick.core.frames import RectifiedPair
from stereo_pick.core.noise import noise_dn
from stereo_pick.core.objects import Blobs
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
)
from stereo_pick.core.windows.texture import predicted_sigma_px
from stereo_pick.core.windows.window import Grey
from stereo_pick.core.windows.window_planes import agree_on, planes_through, refitted

_WIDE_PX, _HIGH_PX, _STRIDE_PX = 33, 11, 16  # low windows: a table that is seen at an angle shears high ones
_SIZE_PX = _WIDE_PX, _HIGH_PX
_AS_SQUARE_PX = 19
_PLACED_PX = 0.3  # sigma that a window's own grain promises
_TRIPLES = 300
_MOST = 0.8  # of the windows found, that must agree
_COVERED = 0.25  # of all windows of the view, that must
_ASKED_FIRST, _WORTH_IT = 24, 0.5  # windows, and how many of them must be found, before all are looked for
_LENS_PX = 0.03  # what is left of distortion is no noise
_CLEAR_PX = 2  # of the reduced view, around objects


def grained_table(pair: RectifiedPair, blobs: Blobs, disparities_px: tuple[float, float]) -> Table | None:
    """The plane (rectified left frame) that what lies clear of the objects shows; None where it shows no single one.

    disparities_px: the least and the greatest of the view.
    """
    scale = reduction(pair.left)
    left = reduced(pair.left, scale)
    objects = [*blobs.left, *(blobs.others.left if blobs.others else ())]
    clear = clear_of_objects(left, objects, scale, _WIDE_PX + 2 * _CLEAR_PX, _HIGH_PX + 2 * _CLEAR_PX)
    places = _grained(left, clear)
    least = _COVERED * (left.shape[0] // _STRIDE_PX) * (left.shape[1] // _STRIDE_PX)
    if len(places) < least:
        return None
    right = reduced(pair.right, scale)
    reach = scale * disparities_px[0], scale * disparities_px[1]
    few = places[:: max(1, len(places) // _ASKED_FIRST)]
    if len(matches(left, right, few, _SIZE_PX, reach).disparity_px) < _WORTH_IT * len(few):
        return None
    windows = matches(left, right, places, _SIZE_PX, reach)
    if len(windows.disparity_px) < least:
        return None
    common = _common_plane(windows)
    if common is None:
        return None
    plane, agree = common
    if agree.sum() < max(_MOST * len(agree), least):
        return None
    left, right = uneven(pair.left, pair.rig.left, scale), uneven(pair.right, pair.rig.right, scale)
    better = aligned(left, right, plane, windows.those(agree), (_WIDE_PX, _HIGH_PX, _STRIDE_PX))
    return better.table(windows.rows[agree].mean(axis=0), pair.rig, scale, _LENS_PX) if better else None


def _grained(left: Grey, clear: Bools) -> Ints:
    """Centres (N, 2) of windows, column and row, whose grain says where they belong."""
    usable = clear & (predicted_sigma_px(left, noise_dn(left), _AS_SQUARE_PX, "zncc") < _PLACED_PX)
    return on_grid(usable, _WIDE_PX, _HIGH_PX, _STRIDE_PX)


def _common_plane(windows: Windows) -> tuple[Floats, Bools] | None:
    """The plane (3,) that most windows agree on, and which (N,) these are; None where all are in one line."""
    planes = planes_through(windows, _TRIPLES, _WIDE_PX)
    if not len(planes):
        return None
    return refitted(planes[agree_on(planes, windows).sum(axis=1).argmax()], windows)
