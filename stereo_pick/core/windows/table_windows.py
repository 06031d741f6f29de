"""Windows of the left view found along their rows in the right one.

Pixels are of views reduced to one width, at which windows are small and quickly found.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np

from stereo_pick.core.arrays import Bools, Floats, Image, Ints
from stereo_pick.core.camera import Camera
from stereo_pick.core.objects import Blob
from stereo_pick.core.objects.edge_model import vertex
from stereo_pick.core.rectified_view import valid_region
from stereo_pick.core.windows.window import Grey

_WIDTH_PX = 320  # of the reduced views
_EVEN_PX = 6.0  # sigma of what counts as even light
_BORDER_PX = 5  # of the view, along where the camera sees nothing
_ALIKE = 0.5  # correlation of the two views of a window
_LEAD = 0.1  # ... by which the best place must beat all others
_PEAK_PX = 4  # half the width of a peak of correlation


@dataclass(frozen=True, eq=False)
class Windows:
    """centre_px: (N, 2) in the reduced left view; disparity_px: (N,)."""

    centre_px: Floats
    disparity_px: Floats

    @property
    def rows(self) -> Floats:
        """What (N, 3) a plane (`window_planes.py`) is multiplied by."""
        return np.asarray(np.c_[self.centre_px, np.ones(len(self.centre_px))], np.float64)

    def those(self, chosen: Bools) -> Windows:
        """Some (N,) of them."""
        return Windows(self.centre_px[chosen], self.disparity_px[chosen])


def reduction(image: Image) -> float:
    """By what a view is multiplied to have the width of reduced ones."""
    return min(1.0, _WIDTH_PX / float(image.shape[1]))


def at_full_size(points_px: Floats, scale: float) -> Floats:
    """Places (N, 2) of a reduced view in the whole one."""
    return (points_px + 0.5) / scale - 0.5


def reduced(image: Image, scale: float) -> Grey:
    """A view at that scale."""
    size = round(image.shape[1] * scale), round(image.shape[0] * scale)
    return np.asarray(cv2.resize(image.astype(np.float32), size, interpolation=cv2.INTER_AREA), np.float32)


def uneven(image: Image, camera: Camera, scale: float) -> Grey:
    """What a reduced view shows besides even light; 0 where the camera sees nothing."""
    view = reduced(image, scale)
    seen = valid(camera, view).astype(np.float32)
    even = cv2.GaussianBlur(view * seen, (0, 0), _EVEN_PX) / np.maximum(
        cv2.GaussianBlur(seen, (0, 0), _EVEN_PX), np.float32(1e-3)
    )
    return np.asarray(np.where(seen > 0, view - even, 0), np.float32)


def valid(camera: Camera, view: Grey) -> Bools:
    """Which pixels (h, w) of a reduced view the camera sees."""
    border = np.ones((_BORDER_PX, _BORDER_PX), np.uint8)
    seen = cv2.erode(valid_region(camera).astype(np.uint8), border)
    return np.asarray(cv2.resize(seen, view.shape[::-1], interpolation=cv2.INTER_AREA) > 0)


def clear_of_objects(view: Grey, objects: Sequence[Blob], scale: float, wide_px: int, high_px: int) -> Bools:
    """Which pixels (h, w) of a reduced view are at the middle of windows without objects."""
    covered = np.zeros(view.shape, np.uint8)
    for blob in objects:
        contour = np.round((blob.contour_px + 0.5) * scale - 0.5).astype(np.int32)
        cv2.drawContours(covered, [contour], -1, 1, cv2.FILLED)
    return np.asarray(cv2.dilate(covered, np.ones((high_px, wide_px), np.uint8)) == 0)


def on_grid(usable: Bools, wide_px: int, high_px: int, stride_px: int) -> Ints:
    """Centres (N, 2), column and row, a stride apart, of windows within the view at these pixels (h, w)."""
    beside, above = wide_px // 2, high_px // 2
    rows, columns = np.nonzero(usable[above:-above:stride_px, beside:-beside:stride_px])
    return np.stack([columns, rows], axis=1) * stride_px + (beside, above)


def pixels_around(places: Ints, side_px: int) -> tuple[Ints, Ints]:
    """The rows and the columns (N, side_px²) of the pixels of square windows around places (N, 2), column and row."""
    rows, columns = np.indices((side_px, side_px)).reshape(2, -1) - side_px // 2
    x, y = places.T
    return y[:, None] + rows, x[:, None] + columns


def matches(
    left: Grey, right: Grey, places: Ints, size_px: tuple[int, int], disparities_px: tuple[float, float]
) -> Windows:
    """The windows, wide and high, around these places (N, 2) that fit one place of the right view only.

    disparities_px: the least and the greatest, of the reduced view.
    """
    (beside, above), (low, high) = (each // 2 for each in size_px), disparities_px
    found = []
    for x, y in places.tolist():
        first, last = max(int(x - high) - beside, 0), min(int(np.ceil(x - low)) + beside + 1, left.shape[1])
        if last - first < size_px[0] + 2 * _PEAK_PX:
            continue
        rows = slice(y - above, y + above + 1)
        window = left[rows, x - beside : x + beside + 1]
        at = _only_peak(cv2.matchTemplate(right[rows, first:last], window, cv2.TM_CCOEFF_NORMED)[0])
        if at is not None:
            found.append((x, y, x - (first + beside + at)))
    table = np.array(found, np.float64).reshape(-1, 3)
    return Windows(table[:, :2], table[:, 2])


def _only_peak(likeness: Grey) -> float | None:
    """Where a row of correlations peaks, between pixels; None where it is low, at an end, or has another peak."""
    best = int(likeness.argmax())
    others = likeness[np.abs(np.arange(len(likeness)) - best) > _PEAK_PX]
    second = float(others.max()) if len(others) else -1.0
    if not 0 < best < len(likeness) - 1 or likeness[best] < max(_ALIKE, second + _LEAD):
        return None
    return best + float(vertex(*-likeness[best - 1 : best + 2, None].astype(np.float64))[0])
