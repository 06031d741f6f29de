"""A subscriber of the object poses, as a picker would be one, and of the nodes' errors: for showing both."""

from __future__ import annotations

import os
from collections.abc import Callable
from typing import Any

import rclpy
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import PoseArray
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor

from stereo_pick.cli.chain import DOWNSTREAM
from stereo_pick.ros.messages.diagnostics import ERROR, PAIRS, kind
from stereo_pick.ros.messages.stamps import stamp_ns
from stereo_pick.ros.process import prepare_process, start_ros
from stereo_pick.ros.topics import (
    CAMERA_INFO,
    CAMERA_INFO_RECT,
    CORRESPONDENCES,
    DIAGNOSTICS,
    IMAGE_RAW,
    IMAGE_RECT,
    OBJECT_POSES,
    SIDES,
)

_AWAITED = [
    *(topics[side].name for topics in (IMAGE_RAW, CAMERA_INFO, IMAGE_RECT, CAMERA_INFO_RECT) for side in SIDES),
    CORRESPONDENCES.name,
]
_CAPTURE = "stereo_pick: capture"
_CHAIN = {_CAPTURE, *(f"stereo_pick: {name}" for name in DOWNSTREAM)}


class Monitor:
    """Receives PoseArrays and passes each on as stamp [ns], frame and positions [m]; errors of nodes once a kind.

    It listens to the chain without a namespace: others in the domain are none of its business. Raises ParameterError
    where ROS does not start.

    count: PoseArrays so far; located: the objects in them; captured: the pairs that capture says it published, None
    where it was not heard; errors: what the nodes have told.
    """

    def __init__(
        self,
        received: Callable[[int, str, list[tuple[float, float, float]]], None],
        failed: Callable[[str], None],
    ) -> None:
        prepare_process()
        self._context = Context()
        start_ros(self._context, [])
        self._node = rclpy.create_node(f"stereo_pick_monitor_{os.getpid()}", context=self._context)
        self._executor = SingleThreadedExecutor(context=self._context)
        self._executor.add_node(self._node)
        self._received = received
        self._failed = failed
        self.count = 0
        self.located = 0
        self.captured: int | None = None
        self.errors: list[str] = []
        self._node.create_subscription(PoseArray, OBJECT_POSES.name, self._on_poses, OBJECT_POSES.qos)
        self._node.create_subscription(DiagnosticArray, DIAGNOSTICS.name, self._on_diagnostics, DIAGNOSTICS.qos)

    def spin(self, seconds: float) -> None:
        """Handle what arrives within this time, one message at the most."""
        self._executor.spin_once(timeout_sec=seconds)

    def downstream_is_up(self) -> bool:
        """Whether every topic of the chain has its subscriber, and the poses have their publisher."""
        return self._node.count_publishers(OBJECT_POSES.name) > 0 and all(
            self._node.count_subscribers(name) > 0 for name in _AWAITED
        )

    def taken_topic(self, own_poses: int) -> str | None:
        """A topic of this chain that others publish already; own_poses: how many of its nodes publish poses by now."""
        own = {OBJECT_POSES.name: own_poses, **dict.fromkeys((IMAGE_RAW[side].name for side in SIDES), 0)}
        taken = [name for name, count in own.items() if self._node.count_publishers(name) > count]
        return self._node.resolve_topic_name(taken[0]) if taken else None

    @property
    def is_behind(self) -> bool:
        """Whether poses of captured pairs are still to come, as far as no node has told of an error."""
        return not self.errors and self.count < (self.captured or 0)

    def close(self) -> None:
        """Leave the ROS graph."""
        self._executor.remove_node(self._node)
        self._node.destroy_node()
        self._context.try_shutdown()

    def _on_poses(self, message: Any) -> None:
        self.count += 1
        self.located += len(message.poses)
        positions = [(pose.position.x, pose.position.y, pose.position.z) for pose in message.poses]
        self._received(stamp_ns(message.header.stamp), message.header.frame_id, positions)

    def _on_diagnostics(self, message: Any) -> None:
        for status in message.status:
            if status.name not in _CHAIN:
                continue
            if status.name == _CAPTURE:
                pairs = [int(each.value) for each in status.values if each.key == PAIRS]
                self.captured = max([self.captured or 0, *pairs])
            if status.level == ERROR and kind(status.message) not in map(kind, self.errors):
                self.errors.append(status.message)
                self._failed(status.message)
