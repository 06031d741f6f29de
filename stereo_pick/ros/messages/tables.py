"""sensor_msgs/PointCloud2 as a table with named columns: the ecosystem's structured array."""

from __future__ import annotations

import sys
from array import array
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray
from sensor_msgs.msg import PointCloud2, PointField

from stereo_pick.core.errors import StereoPickError
from stereo_pick.ros.messages.stamps import header

_TYPES = {np.dtype(np.float64): PointField.FLOAT64, np.dtype(np.uint8): PointField.UINT8}


class TableError(StereoPickError):
    """A PointCloud2 that lacks columns, or is shorter than its header says."""


def table_message(rows: NDArray[Any], stamp_ns: int, frame_id: str) -> PointCloud2:
    """A message of a structured array (N,) whose fields are float64 or uint8."""
    names = rows.dtype.names or ()
    offsets: Mapping[str, Any] = rows.dtype.fields or {}
    return PointCloud2(
        header=header(stamp_ns, frame_id),
        height=1,
        width=len(rows),
        fields=[
            PointField(name=name, offset=offsets[name][1], datatype=_TYPES[offsets[name][0]], count=1) for name in names
        ],
        is_bigendian=sys.byteorder == "big",
        point_step=rows.dtype.itemsize,
        row_step=rows.dtype.itemsize * len(rows),
        data=array("B", rows.tobytes()),
        is_dense=not any(np.isnan(rows[name]).any() for name in names),
    )


def table_of(message: PointCloud2, dtype: np.dtype[Any]) -> NDArray[Any]:
    """The rows (N,) of a message made by `table_message`; raises TableError where it is of another make."""
    have = [(field.name, field.offset, field.datatype) for field in message.fields]
    fields: Mapping[str, Any] = dtype.fields or {}
    want = [(name, fields[name][1], _TYPES[fields[name][0]]) for name in dtype.names or ()]
    if have != want or message.point_step != dtype.itemsize:
        raise TableError(
            f"columns are {[name for name, *_ in have]}, must be {list(dtype.names or ())}: "
            "do both nodes have the same version?"
        )
    size = message.width * message.height
    if len(message.data) != size * dtype.itemsize:
        raise TableError(
            f"data holds {len(message.data)} bytes, but {size} rows of {dtype.itemsize} bytes are announced"
        )
    return np.frombuffer(message.data, dtype)
