"""Every topic of the package: name (relative, remappable), type and quality of service.

Images use the sensor-data profile (best effort): a late image is worth nothing. Results are reliable. Both can be
overridden by parameters `qos_overrides.<topic>.*`, see docs/nodes.md.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import PoseArray
from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import CameraInfo, Image, PointCloud2
from visualization_msgs.msg import MarkerArray

from stereo_pick.core.pairing import Side


@dataclass(frozen=True)
class Topic:
    """A topic as it is published and subscribed to everywhere."""

    name: str
    type: Any
    qos: QoSProfile


def _profile(reliability: ReliabilityPolicy, depth: int) -> QoSProfile:
    return QoSProfile(
        history=HistoryPolicy.KEEP_LAST, depth=depth, reliability=reliability, durability=DurabilityPolicy.VOLATILE
    )


SENSOR_DATA = _profile(ReliabilityPolicy.BEST_EFFORT, 5)
RESULTS = _profile(ReliabilityPolicy.RELIABLE, 10)

SIDES: tuple[Side, Side] = ("left", "right")
IMAGE_RAW = {side: Topic(f"{side}/image_raw", Image, SENSOR_DATA) for side in SIDES}
CAMERA_INFO = {side: Topic(f"{side}/camera_info", CameraInfo, SENSOR_DATA) for side in SIDES}
IMAGE_RECT = {side: Topic(f"{side}/image_rect", Image, SENSOR_DATA) for side in SIDES}
CAMERA_INFO_RECT = {side: Topic(f"{side}/camera_info_rect", CameraInfo, SENSOR_DATA) for side in SIDES}
"""K and D of the raw camera, R and P of the rectified image: camera_info as image_pipeline understands it."""

CORRESPONDENCES = Topic("correspondences", PointCloud2, RESULTS)
OBJECT_POSES = Topic("object_poses", PoseArray, RESULTS)
OBJECTS = Topic("objects", PointCloud2, RESULTS)
OBJECT_MARKERS = Topic("object_markers", MarkerArray, RESULTS)
ANNOTATED = Topic("image_annotated", Image, SENSOR_DATA)
CALIBRATION_ANNOTATED = Topic("calibration/image_annotated", Image, SENSOR_DATA)
DIAGNOSTICS = Topic("/diagnostics", DiagnosticArray, RESULTS)
CLOCK = Topic("/clock", Clock, SENSOR_DATA)

TOPICS = (
    *(topics[side] for topics in (IMAGE_RAW, CAMERA_INFO, IMAGE_RECT, CAMERA_INFO_RECT) for side in SIDES),
    *(CORRESPONDENCES, OBJECT_POSES, OBJECTS, OBJECT_MARKERS, ANNOTATED, CALIBRATION_ANNOTATED, DIAGNOSTICS, CLOCK),
)
"""All of them."""
