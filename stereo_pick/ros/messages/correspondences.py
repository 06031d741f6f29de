"""Correspondences as a PointCloud2: one row a matched object, one a refusal; common_interfaces has no type for them.

Columns: left_u, left_v, right_u, right_v [rectified px, NaN where unseen]; sigma_left, sigma_right, length, width
[px]; direction [rad]; length_m, width_m, height_m, qx, qy, qz, qw: the solid that explains the object (NaN where none
does), in the rectified left frame; xx, xy, xz, yy, yz, zz: what adds to the covariance of the position [m²], in that
frame; reason: 0 for a match, else the position in `stereo_pick.core.refusal.REASONS`, from
1; kind: the position in `stereo_pick.core.places.extent.KINDS`, 0 where none explains it.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from sensor_msgs.msg import PointCloud2

from stereo_pick.core.arrays import Floats
from stereo_pick.core.correspondence import Correspondences
from stereo_pick.core.hand_eye.rotations import from_quaternion, to_quaternion
from stereo_pick.core.places.extent import KINDS, Extent
from stereo_pick.core.refusal import REASONS, Refusal
from stereo_pick.ros.messages.tables import TableError, table_message, table_of

_NUMBERS = ("left_u", "left_v", "right_u", "right_v", "sigma_left", "sigma_right", "length", "width", "direction")
_COVARIANCE = ("xx", "xy", "xz", "yy", "yz", "zz")
_UPPER = np.triu_indices(3)
_SOLID = ("length_m", "width_m", "height_m", "qx", "qy", "qz", "qw")
_ROW = np.dtype(
    [*((name, np.float64) for name in (*_NUMBERS, *_SOLID, *_COVARIANCE)), ("reason", np.uint8), ("kind", np.uint8)],
    align=True,
)
_REASONS = tuple(REASONS)


def correspondences_message(correspondences: Correspondences, stamp_ns: int, frame_id: str) -> PointCloud2:
    """The message of N matches and their refusals, with a stamp [ns]."""
    count = len(correspondences)
    rows = np.zeros(count + len(correspondences.refused), _ROW)
    for name in (*_NUMBERS, *_SOLID, *_COVARIANCE):
        rows[name] = np.nan
    rows["reason"] = [0] * count + [_REASONS.index(refusal.reason) + 1 for refusal in correspondences.refused]
    matched = rows[:count]
    for names, values in (
        (("left_u", "left_v"), correspondences.left_px),
        (("right_u", "right_v"), correspondences.right_px),
        (("sigma_left", "sigma_right"), correspondences.sigma_px),
        (("length", "width"), correspondences.size_px),
        (_COVARIANCE, correspondences.covariance[(slice(None), *_UPPER)]),
    ):
        for name, column in zip(names, values.T):
            matched[name] = column
    matched["direction"] = correspondences.direction_rad
    for row, extent in zip(matched, correspondences.extents):
        if extent is not None:
            row["kind"] = KINDS.index(extent.kind)
            for name, value in zip(_SOLID, (*extent.size_m, *to_quaternion(extent.rotation))):
                row[name] = value
    for row, refusal in zip(rows[count:], correspondences.refused):
        for side in ("left", "right"):
            point = getattr(refusal, f"{side}_px")
            if point is not None:
                row[f"{side}_u"], row[f"{side}_v"] = point
    return table_message(rows, stamp_ns, frame_id)


def correspondences_of(message: PointCloud2) -> Correspondences:
    """The correspondences of a message; raises TableError, or ArrayError on NaN in a match."""
    rows = table_of(message, _ROW)
    matched, refused = rows[rows["reason"] == 0], rows[rows["reason"] > 0]
    if (refused["reason"] > len(_REASONS)).any():
        raise TableError(f"unknown reason {refused['reason'].max()}: do both nodes have the same version?")
    return Correspondences(
        left_px=_columns(matched, "left_u", "left_v"),
        right_px=_columns(matched, "right_u", "right_v"),
        sigma_px=_columns(matched, "sigma_left", "sigma_right"),
        size_px=_columns(matched, "length", "width"),
        direction_rad=matched["direction"],
        extents=tuple(_extent(row) for row in matched),
        covariance=_symmetric(_columns(matched, *_COVARIANCE)),
        refused=tuple(
            Refusal(_REASONS[row["reason"] - 1], _point(row, "left"), _point(row, "right")) for row in refused
        ),
    )


def _columns(rows: NDArray[Any], *names: str) -> Floats:
    return np.stack([rows[name] for name in names], axis=1)


def _symmetric(upper: Floats) -> Floats:
    """Matrices (N, 3, 3) of which the upper triangles (N, 6) are these."""
    full = np.zeros((len(upper), 3, 3))
    full[(slice(None), *_UPPER)] = upper
    full[(slice(None), *_UPPER[::-1])] = upper
    return full


def _extent(row: Any) -> Extent | None:
    if row["kind"] == 0:
        return None
    if row["kind"] >= len(KINDS):
        raise TableError(f"unknown kind {row['kind']}: do both nodes have the same version?")
    rotation = from_quaternion((0.0, 0.0, 0.0), [row[name] for name in _SOLID[3:]]).rotation
    return Extent(KINDS[row["kind"]], rotation, np.array([row[name] for name in _SOLID[:3]]))


def _point(row: Any, side: str) -> Floats | None:
    point = np.array([row[f"{side}_u"], row[f"{side}_v"]])
    return None if np.isnan(point).any() else point
