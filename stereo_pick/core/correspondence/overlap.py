"""No two objects are at the same place, and none is seen through another."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import cv2

from stereo_pick.core.camera import Camera
from stereo_pick.core.correspondence.position import Row
from stereo_pick.core.rig import StereoRig
from stereo_pick.core.shapes import SolidFit


def one_in_each_place(rows: Sequence[Row]) -> tuple[list[Row], list[Row]]:
    """Those that stay, the surest of each place, and the others, to be refused: no solid has its centre in another."""
    return _compatible(rows, SolidFit.overlaps)


def none_behind_another(rows: Sequence[Row], rig: StereoRig) -> tuple[list[Row], list[Row]]:
    """Those that stay, and the less sure of each two of which one hides the other's centre from both cameras."""
    return _compatible(rows, lambda one, other: _hides(one, other, rig) or _hides(other, one, rig))


def clash(one: SolidFit, other: SolidFit, rig: StereoRig) -> bool:
    """Whether two solids are at the same place, or one is seen through the other."""
    return one.overlaps(other) or _hides(one, other, rig) or _hides(other, one, rig)


def _compatible(rows: Sequence[Row], clash: Callable[[SolidFit, SolidFit], bool]) -> tuple[list[Row], list[Row]]:
    stays: list[Row] = []
    goes: list[Row] = []
    for blobs, where in sorted(rows, key=lambda row: row[1].sigma_px):
        others = [other.fit for _, other in stays if other.fit is not None]
        if where.fit is None or not any(clash(where.fit, other) for other in others):
            stays.append((blobs, where))
        else:
            goes.append((blobs, replace(where, fit=None, reason="merged")))
    return stays, goes


def _hides(one: SolidFit, other: SolidFit, rig: StereoRig) -> bool:
    """Whether one solid lies before the centre of the other in both views."""
    nearer = one.centre_m[2] < other.centre_m[2]
    return bool(nearer) and all(_covers(one, other, camera) for camera in (rig.left, rig.right))


def _covers(one: SolidFit, other: SolidFit, camera: Camera) -> bool:
    x, y = other.centre_px(camera).tolist()
    return cv2.pointPolygonTest(one.silhouette_px(camera).astype("float32"), (x, y), False) > 0
