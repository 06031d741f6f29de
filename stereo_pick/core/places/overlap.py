"""No two objects are at the same place, and none is seen through another."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import cv2
import numpy as np

from stereo_pick.core.arrays import Bools, Floats
from stereo_pick.core.camera import Camera
from stereo_pick.core.places.position import Located, Row
from stereo_pick.core.rig import StereoRig
from stereo_pick.core.shapes import SolidFit
from stereo_pick.core.shapes.common_normal import ANGLE
from stereo_pick.core.shapes.kinds import CYLINDER

_WELL_WITHIN = 0.7  # of the half sizes: no further than a cylinder's side at 45 degrees
_AS_ONE = 0.1  # of a cylinder's thickness, by which its two pieces may be off each other
_INNER = _WELL_WITHIN * np.stack(np.meshgrid(*[(-1.0, 0.0, 1.0)] * 3), axis=-1).reshape(-1, 3)


def one_in_each_place(rows: Sequence[Row]) -> tuple[list[Row], list[Row]]:
    """Those that stay, the surest of each place, and the others, to be refused: no solid has its centre in another."""
    return _compatible(rows, lambda where, other: where.fit is not None and where.fit.overlaps(other))


def none_behind_another(rows: Sequence[Row], rig: StereoRig) -> tuple[list[Row], list[Row]]:
    """Those that stay, and the less sure of each two of which one hides the other's centre from both cameras. What has
    no solid is a piece of the one within which both views show its centre."""
    return _compatible(rows, lambda where, other: is_where(other, where, rig))


def clash(one: SolidFit, other: SolidFit, rig: StereoRig) -> bool:
    """Whether two solids are at the same place, or one is seen through the other."""
    return one.overlaps(other) or _hides(one, other, rig) or _hides(other, one, rig)


def reach_into_each_other(one: SolidFit, other: SolidFit) -> bool:
    """Whether a point of one of two solids, well within its sides, lies well within the other's."""
    return _reaches_into(one, other) or _reaches_into(other, one)


def are_one(one: SolidFit, other: SolidFit) -> bool:
    """Whether two solids are the same, about: all that is well within the sides of either lies within the other's."""
    return bool(_inner_within(one, other, 1.0).all() and _inner_within(other, one, 1.0).all())


def _reaches_into(one: SolidFit, other: SolidFit) -> bool:
    return bool(_inner_within(one, other, _WELL_WITHIN).any())


def _inner_within(one: SolidFit, other: SolidFit, share: float) -> Bools:
    """Which points (N,) well within the sides of one lie within that share of the other's half sizes."""
    points_m = one.centre_m + _INNER * one.size_m / 2 @ one.rotation.T
    own = (points_m - other.centre_m) @ other.rotation
    return np.asarray((np.abs(own) < share * other.size_m / 2).all(axis=1))


def goes_on_as(one: SolidFit, other: SolidFit) -> bool:
    """Whether a cylinder begins on the axis of an equally thick one, where that ends: they are hardly two, but one that
    was found too short, and its rest."""
    if one.kind != CYLINDER.name or other.kind != CYLINDER.name:
        return False
    thick_m, axis, apart_m = float(other.size_m[0]), other.rotation[:, 2], one.centre_m - other.centre_m
    along_m = abs(float(axis @ apart_m))
    beside_m = float(np.linalg.norm(np.cross(axis, apart_m)))
    gap_m = along_m - float(one.size_m[2] + other.size_m[2]) / 2
    is_turned_alike = float(np.linalg.norm(np.cross(axis, one.rotation[:, 2]))) < ANGLE
    off_m = max(beside_m, abs(float(one.size_m[0]) - thick_m), abs(gap_m))
    return is_turned_alike and off_m < _AS_ONE * thick_m


def is_where(fit: SolidFit, other: Located, rig: StereoRig) -> bool:
    """Whether a solid is in the way of another object, or the two are one: of what has no solid, where both views show
    its centre within the first."""
    if other.fit is not None:
        return clash(fit, other.fit, rig)
    return covers(fit, other.left_px, rig.left) and covers(fit, other.right_px, rig.right)


def covers(fit: SolidFit, place_px: Floats, camera: Camera) -> bool:
    """Whether a place (2,) in a rectified view is within a solid's silhouette."""
    x, y = place_px.tolist()
    return cv2.pointPolygonTest(fit.silhouette_px(camera).astype("float32"), (x, y), False) > 0


def _compatible(rows: Sequence[Row], clash: Callable[[Located, SolidFit], bool]) -> tuple[list[Row], list[Row]]:
    stays: list[Row] = []
    goes: list[Row] = []
    for blobs, where in sorted(rows, key=lambda row: row[1].sigma_px):
        others = [other.fit for _, other in stays if other.fit is not None]
        if not any(clash(where, other) for other in others):
            stays.append((blobs, where))
        else:
            goes.append((blobs, replace(where, fit=None, reason="merged")))
    return stays, goes


def _hides(one: SolidFit, other: SolidFit, rig: StereoRig) -> bool:
    """Whether one solid lies before the centre of the other in both views."""
    nearer = one.centre_m[2] < other.centre_m[2]
    return bool(nearer) and all(covers(one, other.centre_px(camera), camera) for camera in (rig.left, rig.right))
