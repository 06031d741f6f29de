"""Object poses as PoseArray, as markers for RViz and Foxglove, and as a table with all that is known of them."""

from __future__ import annotations

import numpy as np
from geometry_msgs.msg import Point, Pose, PoseArray, Quaternion, Vector3
from sensor_msgs.msg import PointCloud2
from std_msgs.msg import ColorRGBA
from visualization_msgs.msg import Marker, MarkerArray

from stereo_pick.core.places.extent import KINDS
from stereo_pick.core.poses import ObjectPoses
from stereo_pick.ros.messages.stamps import header
from stereo_pick.ros.messages.tables import table_message

_COVARIANCE = [f"cov_{a}{b}" for a in "xyz" for b in "xyz"]
_COLUMNS = (
    "x",
    "y",
    "z",
    "yaw",
    "length",
    "width",
    "height",
    "ray_gap",
    "left_u",
    "left_v",
    "right_u",
    "right_v",
    *_COVARIANCE,
    "confidence",
)
OBJECT_ROW = np.dtype([*((name, np.float64) for name in _COLUMNS), ("kind", np.uint8)], align=True)
"""Columns of `objects`: metres and radians in the frame of the header, raw pixels, covariance in m²; confidence:
that of `ObjectPoses`; kind: its place in `stereo_pick.core.places.extent.KINDS`, 0 for an unknown one, whose
height is 0."""


def pose_array_message(poses: ObjectPoses, frame_id: str) -> PoseArray:
    """The poses that a picker subscribes to."""
    return PoseArray(header=header(poses.stamp_ns, frame_id), poses=_poses(poses))


def objects_message(poses: ObjectPoses, frame_id: str) -> PointCloud2:
    """The same objects with size, ray gap, raw pixels, covariance and confidence; row i belongs to pose i."""
    table = np.column_stack(
        [
            poses.xyz, poses.heading_rad, poses.size_m, poses.ray_gap,
            poses.left_px, poses.right_px, poses.covariance.reshape(len(poses), 9), poses.confidence,
        ]
    )  # fmt: skip
    rows = np.zeros(len(poses), OBJECT_ROW)
    for name, column in zip(_COLUMNS, table.T):
        rows[name] = column
    rows["kind"] = [KINDS.index(kind) for kind in poses.kinds]
    return table_message(rows, poses.stamp_ns, frame_id)


def markers_message(poses: ObjectPoses, frame_id: str) -> MarkerArray:
    """A cube in the size of each object, its number and its position in millimetres; earlier ones are deleted."""
    head = header(poses.stamp_ns, frame_id)
    markers = [Marker(header=head, action=Marker.DELETEALL)]
    for index, pose in enumerate(_poses(poses)):
        length, width, height = poses.size_m[index]
        markers.append(
            Marker(
                header=head,
                ns="objects",
                id=index,
                type=Marker.CUBE,
                pose=pose,
                scale=Vector3(x=float(length), y=float(width), z=float(height or width)),
                color=ColorRGBA(r=0.1, g=0.7, b=0.3, a=0.5),
            )
        )
        markers.append(
            Marker(
                header=head,
                ns="labels",
                id=index,
                type=Marker.TEXT_VIEW_FACING,
                pose=pose,
                scale=Vector3(z=0.015),
                color=ColorRGBA(r=1.0, g=1.0, b=1.0, a=1.0),
                text=_label(index, poses),
            )
        )
    return MarkerArray(markers=markers)


def _poses(poses: ObjectPoses) -> list[Pose]:
    return [
        Pose(position=Point(x=x, y=y, z=z), orientation=Quaternion(x=qx, y=qy, z=qz, w=qw))
        for (x, y, z), (qx, qy, qz, qw) in zip(poses.xyz.tolist(), poses.quaternions().tolist())
    ]


def _label(index: int, poses: ObjectPoses) -> str:
    x, y, z = poses.xyz[index] * 1000
    sigma = np.sqrt(poses.covariance[index, 2, 2]) * 1000
    return f"{index + 1}: {x:.1f} {y:.1f} {z:.1f} mm (z ± {sigma:.1f}, confidence {poses.confidence[index]:.3f})"
