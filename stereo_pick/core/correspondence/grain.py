"""The table from its own grain: wood, cloth, concrete or dirt show all over the view how far away it is.

Windows of the left view are looked for along their rows in the right one. On a plane the disparity is a linear function
of the pixel; where most windows of the view agree on one, that is the table.
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np

from stereo_pick.core.arrays import Bools, Floats, Image, Ints
from stereo_pick.core.correspondence.texture import noise_dn, predicted_sigma_px
from stereo_pick.core.correspondence.window import Grey
from stereo_pick.core.frames import RectifiedPair
from stereo_pick.core.objects import Blobs
from stereo_pick.core.objects.edge_model import vertex
from stereo_pick.core.rig import StereoRig
from stereo_pick.core.shapes.sight import normalized
from stereo_pick.core.shapes.table import EDGE_ON, Table

_WIDTH_PX = 320  # of the reduced views
_WIDE_PX, _HIGH_PX, _STRIDE_PX = 33, 11, 16  # low windows: a table that is seen at an angle shears high ones
_AS_SQUARE_PX = 19
_PLACED_PX = 0.3  # sigma that a window's own grain promises
_ALIKE = 0.5  # correlation of the two views of a window
_LEAD = 0.1  # ... by which the best place must beat all others
_PEAK_PX = 4  # half the width of a peak of correlation
_TRIPLES = 300
_TOLERANCE_PX = 0.5  # of the reduced view, from the plane
_MOST = 0.8  # of the windows found, that must agree
_COVERED = 0.25  # of all windows of the view, that must
_ASKED_FIRST, _WORTH_IT = 24, 0.5  # windows, and how many of them must be found, before all are looked for
_SIGMA = 0.3  # of the plane, as a part of how far windows lie off it ...
_LOCKED_PX = 0.05  # ... and by which all of them may be drawn towards whole pixels of the reduced view
_CLEAR_PX = 2  # of the reduced view, around objects


@dataclass(frozen=True, eq=False)
class _Windows:
    """centre_px: (N, 2) in the reduced left view; disparity_px: (N,)."""

    centre_px: Floats
    disparity_px: Floats


def grained_table(pair: RectifiedPair, blobs: Blobs, disparities_px: tuple[float, float]) -> Table | None:
    """The plane (rectified left frame) that what lies clear of the objects shows; None where it shows no single one.

    disparities_px: the least and the greatest of the view.
    """
    scale = min(1.0, _WIDTH_PX / pair.left.shape[1])
    left = _reduced(pair.left, scale)
    places = _grained(left, _clear(blobs, left, scale))
    least = _COVERED * (left.shape[0] // _STRIDE_PX) * (left.shape[1] // _STRIDE_PX)
    if len(places) < least:
        return None
    right = _reduced(pair.right, scale)
    reach = scale * disparities_px[0], scale * disparities_px[1]
    few = places[:: max(1, len(places) // _ASKED_FIRST)]
    if len(_matches(left, right, few, *reach).disparity_px) < _WORTH_IT * len(few):
        return None
    windows = _matches(left, right, places, *reach)
    if len(windows.disparity_px) < least:
        return None
    plane, agree = _common_plane(windows)
    if agree.sum() < max(_MOST * len(agree), least):
        return None
    off_px = np.c_[windows.centre_px, np.ones(len(agree))] @ plane - windows.disparity_px
    sigma_px = float(np.hypot(_SIGMA * off_px[agree].std(), _LOCKED_PX)) / scale
    return _as_table(plane, pair.rig, scale, windows.centre_px[agree].mean(axis=0), sigma_px)


def _reduced(image: Image, scale: float) -> Grey:
    size = round(image.shape[1] * scale), round(image.shape[0] * scale)
    return np.asarray(cv2.resize(image.astype(np.float32), size, interpolation=cv2.INTER_AREA), np.float32)


def _clear(blobs: Blobs, left: Grey, scale: float) -> Bools:
    """Which pixels (h, w) of the reduced left view are at the middle of windows without objects."""
    objects = np.zeros(left.shape, np.uint8)
    for blob in (*blobs.left, *(blobs.others.left if blobs.others else ())):
        contour = np.round((blob.contour_px + 0.5) * scale - 0.5).astype(np.int32)
        cv2.drawContours(objects, [contour], -1, 1, cv2.FILLED)
    around = np.ones((_HIGH_PX + 2 * _CLEAR_PX, _WIDE_PX + 2 * _CLEAR_PX), np.uint8)
    return np.asarray(cv2.dilate(objects, around) == 0)


def _grained(left: Grey, clear: Bools) -> Ints:
    """Centres (N, 2) of windows, column and row, whose grain says where they belong."""
    usable = clear & (predicted_sigma_px(left, noise_dn(left), _AS_SQUARE_PX, "zncc") < _PLACED_PX)
    beside, above = _WIDE_PX // 2, _HIGH_PX // 2
    rows, columns = np.nonzero(usable[above:-above:_STRIDE_PX, beside:-beside:_STRIDE_PX])
    return np.stack([columns, rows], axis=1) * _STRIDE_PX + (beside, above)


def _matches(left: Grey, right: Grey, places: Ints, low: float, high: float) -> _Windows:
    """The windows around these places (N, 2) that fit one place of the right view only."""
    beside, above = _WIDE_PX // 2, _HIGH_PX // 2
    found = []
    for x, y in places.tolist():
        first, last = max(int(x - high) - beside, 0), min(int(np.ceil(x - low)) + beside + 1, left.shape[1])
        if last - first < _WIDE_PX + 2 * _PEAK_PX:
            continue
        rows = slice(y - above, y + above + 1)
        window = left[rows, x - beside : x + beside + 1]
        at = _only_peak(cv2.matchTemplate(right[rows, first:last], window, cv2.TM_CCOEFF_NORMED)[0])
        if at is not None:
            found.append((x, y, x - (first + beside + at)))
    table = np.array(found, np.float64).reshape(-1, 3)
    return _Windows(table[:, :2], table[:, 2])


def _only_peak(likeness: Grey) -> float | None:
    """Where a row of correlations peaks, between pixels; None where it is low, at an end, or has another peak."""
    best = int(likeness.argmax())
    others = likeness[np.abs(np.arange(len(likeness)) - best) > _PEAK_PX]
    second = float(others.max()) if len(others) else -1.0
    if not 0 < best < len(likeness) - 1 or likeness[best] < max(_ALIKE, second + _LEAD):
        return None
    return best + float(vertex(*-likeness[best - 1 : best + 2, None].astype(np.float64))[0])


def _common_plane(windows: _Windows) -> tuple[Floats, Bools]:
    """The plane (3,), disparity by column, row and 1, that most windows agree on, and which (N,) these are."""
    rows = np.c_[windows.centre_px, np.ones(len(windows.centre_px))]
    chosen = np.random.default_rng(0).integers(len(rows), size=(_TRIPLES, 3))
    corners = rows[chosen]
    spread = np.abs(np.linalg.det(corners)) > _WIDE_PX**2
    if not spread.any():
        return np.zeros(3), np.zeros(len(rows), np.bool_)
    planes = np.linalg.solve(corners[spread], windows.disparity_px[chosen[spread]][..., None])[..., 0]
    votes = (np.abs(planes @ rows.T - windows.disparity_px) < _TOLERANCE_PX).sum(axis=1)
    plane = planes[votes.argmax()]
    for _ in range(2):
        agree = np.abs(rows @ plane - windows.disparity_px) < _TOLERANCE_PX
        plane = np.linalg.lstsq(rows[agree], windows.disparity_px[agree], rcond=None)[0]
    return plane, agree


def _as_table(plane: Floats, rig: StereoRig, scale: float, middle_px: Floats, sigma_px: float) -> Table | None:
    """The plane of the reduced views as one in space: disparity is focal length x baseline / depth, and a constant."""
    column, row, one = plane
    half = (column + row) / 2  # pixel centres are whole numbers in both
    constant_px = half + (one - half) / scale
    left, right = rig.left.P, rig.right.P
    apart_px = left[0, 2] - right[0, 2]
    at_centre = column * left[0, 2] + row * left[1, 2] + constant_px - apart_px
    across = np.array([column * left[0, 0], row * left[1, 1], at_centre])
    length = float(np.linalg.norm(across))
    normal = -across / length
    if normal[2] > -EDGE_ON:
        return None
    offset_m = rig.focal_px * rig.baseline_m / length
    depth_m = -offset_m / float(normal @ np.append(normalized(middle_px / scale, rig.left), 1.0))
    return Table(normal, offset_m, sigma_px * depth_m * offset_m / (rig.focal_px * rig.baseline_m))
